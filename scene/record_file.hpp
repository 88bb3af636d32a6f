#pragma once
/// record.h5 as record.hpp describes it. Private to the library.

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
  double reached = 0.0;  ///< s; the latest time that anything belongs to
};

void write_record_file(const std::filesystem::path& folder, const RecordContent& content);

/// Throws std::runtime_error naming the file that is missing or damaged. Snapshots are looked at
/// only if `with_snapshots`.
RecordContent read_record_file(const std::filesystem::path& folder, bool with_snapshots);

}  // namespace sprung
