#pragma once
/// record.h5: series, tables, and links to the snapshots. Private to the library.
///
///   /series/<name>          rows x columns; attributes columns, units
///   /tables/<name>/<NNNNNN> rows x columns; attributes columns, units, time (s)
///   /fields/<NNNNNN>        link to fields/<NNNNNN>.h5: /positions, /cells, /fields/<name>, attribute time

#include "scene/record.hpp"
#include "scene/snapshot.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace sprung {

struct RecordContent {
  std::map<std::string, SeriesData> series;
  std::map<std::string, std::map<double, SeriesData>> tables;
  std::vector<Snapshot> snapshots;
};

void write_record_file(const std::filesystem::path& folder, const RecordContent& content);

/// Throws std::runtime_error naming the file that is missing or damaged. Snapshots are looked at only
/// if `with_snapshots`.
RecordContent read_record_file(const std::filesystem::path& folder, bool with_snapshots);

}  // namespace sprung
