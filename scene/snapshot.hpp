#pragma once
/// Field snapshots: one HDF5 file each, and the XDMF file that lists them. Private to the library.

#include "scene/record.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace sprung {

/// What a snapshot file holds, without the values.
struct Snapshot {
  struct FieldShape {
    std::string name;
    int components = 1;
  };
  int index = 0;
  double time = 0.0;
  std::size_t points = 0;
  std::size_t cells = 0;
  int nodes_per_cell = 0;  ///< 0: a cloud of points
  std::vector<FieldShape> fields;
};

/// Positions, cells and fields as a solver hands them over.
struct SnapshotData {
  std::span<const double> positions;  ///< 3 per point
  int nodes_per_cell = 0;
  std::span<const std::int64_t> cells;
  const std::vector<Field>* fields = nullptr;
};

/// "fields/000012.vtkhdf"
std::string snapshot_file(int index);

/// Checks sizes and numbers, then writes the file into `folder`. Throws std::runtime_error for NaN
/// or infinity, std::logic_error for sizes that do not fit.
Snapshot write_snapshot(const std::filesystem::path& folder, int index, double time,
                        const SnapshotData& data);

/// Reads the shapes back. Throws std::runtime_error if the file is missing or damaged.
Snapshot read_snapshot(const std::filesystem::path& folder, int index);

/// The temporal collection of all snapshots, as XDMF text with paths relative to the record's
/// folder.
std::string xdmf_text(const std::vector<Snapshot>& snapshots);

}  // namespace sprung
