#pragma once
/// The result of a run, the same for both solvers: a folder with
///   record.h5      series (probes, ledgers), tables (profiles, outlines), links to the snapshots
///   fields/*.vtkhdf  one file per field snapshot; VTK reads each as it is
///   record.xdmf    opens in ParaView
///   manifest.json  scene as resolved, commit, compiler, processor, versions, time and outcome
///   probes/*.csv   every series (tip.csv) and table (profile_t0.2.csv) as plain columns,
///                  header "name [unit]", 17 significant digits
///   checkpoint.h5  the last good state
/// Inside record.h5:
///   /series/<name>           rows x columns; attributes columns, units
///   /tables/<name>/<NNNNNN>  one per time: rows x columns; attributes columns, units, time [s]
///   /fields/<NNNNNN>         the snapshot fields/<NNNNNN>.vtkhdf with attribute time [s]:
///                            positions (points x 3), fields/<name>, and
///                            cells (cells x nodes; the cells of a cloud are its points)
/// Every file is written beside its place and then renamed: whoever looks sees the old one or the
/// new.

#include "scene/problem.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace sprung {

/// What produced a run. The rest of manifest.json (commit, clean flag, compiler, processor,
/// host-free machine description, library versions, start time) is filled in by the writer.
struct Manifest {
  std::string solver;  ///< "sph" or "reference_fem"
  std::string scene_title;
  std::string scene_file;  ///< file name only, no folder
  std::string scene_toml;  ///< Document::resolved_toml()
  int threads = 1;
  std::map<std::string, std::string> libraries;  ///< name -> version
  std::map<std::string, double> numbers;  ///< solver's own facts: unknowns, particles, time step...
  std::map<std::string, std::string> notes;
  // Readings of processor_seconds() and wall_seconds() at which the run began. 0: with the process,
  // so that set-up counts; a process that makes several runs gives its own.
  double processor_start = 0.0;
  double wall_start = 0.0;
};

struct Column {
  std::string name;  ///< snake_case
  std::string unit;  ///< SI, "1" if none
};

/// A named field over the points of a snapshot: `components` values per point, point by point.
struct Field {
  std::string name;
  int components = 1;
  std::span<const double> values;
};

/// Named arrays of doubles and integers in one HDF5 file, written whole and atomically; what is
/// read back is the same bit for bit. A "/" in a name makes a group.
using Array = std::variant<std::vector<double>, std::vector<std::int64_t>>;
using Archive = std::map<std::string, Array>;
void write_archive(const std::filesystem::path& file, const Archive& archive);
/// Throws std::runtime_error naming the file if it is missing or damaged.
Archive read_archive(const std::filesystem::path& file);

class RecordWriter {
 public:
  /// Creates `folder` (and refuses, with std::runtime_error, one that holds a record already unless
  /// `overwrite`).
  RecordWriter(std::filesystem::path folder, Manifest manifest, bool overwrite = false);
  /// Continues the record in `folder`, forgetting every row, table and snapshot after `time`.
  /// Throws std::runtime_error if the record is missing or damaged, or was made by another solver
  /// or from another scene. Time and cost of the earlier processes count on in manifest.json.
  static RecordWriter resume(std::filesystem::path folder, Manifest manifest, double time);
  ~RecordWriter();
  RecordWriter(RecordWriter&&) noexcept;

  /// A series grows by a row per call of append(); its first column must be {"time", "s"}.
  /// Declaring the same columns again (after resume) keeps the rows.
  void declare_series(const std::string& name, std::vector<Column> columns);
  void append(const std::string& name, std::span<const double> row);
  /// A table belongs to one time: a velocity profile, an outline. `rows` is row-major. NaN or
  /// infinity in a row, table or snapshot throws std::runtime_error: no run writes one as a result.
  /// A table or snapshot of the same time replaces the earlier one.
  void write_table(const std::string& name, double time, const std::vector<Column>& columns,
                   std::span<const double> rows);

  /// Snapshot of a cloud of points; `positions` are 3 per point. Fields of two components are
  /// stored with a third of 0, as ParaView wants its vectors.
  void write_points(double time, std::span<const double> positions,
                    const std::vector<Field>& fields);
  /// Snapshot of a mesh; `cells` are `nodes_per_cell` point numbers per cell (3: triangles, 4:
  /// quads in VTK's order).
  void write_mesh(double time, std::span<const double> positions, int nodes_per_cell,
                  std::span<const std::int64_t> cells, const std::vector<Field>& fields);

  /// Seconds spent by this process in each named phase of the step ("ACTION 6 pressure"), in order.
  void set_cost(const std::vector<std::pair<std::string, double>>& seconds_by_phase);
  void set_number(const std::string& name, double value);
  void set_note(const std::string& name, const std::string& value);

  /// Writes record.h5, record.xdmf, the CSV files and manifest.json as they stand now.
  void flush();
  /// The same, then `archive` as checkpoint.h5, with `time` added as its array "time": the record
  /// on disk always reaches at least as far as the checkpoint, and resume() drops what is beyond.
  void checkpoint(double time, const Archive& archive);
  /// Closes the record. `outcome`: "finished", or what stopped the run and why. A writer that is
  /// destroyed without it leaves a record whose outcome says so.
  void finish(const std::string& outcome);

  const std::filesystem::path& folder() const;

 private:
  struct State;
  explicit RecordWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

struct SeriesData {
  std::vector<Column> columns;
  std::vector<double> values;  ///< row-major
  std::size_t rows() const { return columns.empty() ? 0 : values.size() / columns.size(); }
  /// One column by name; throws std::runtime_error naming the columns there are.
  std::vector<double> column(const std::string& name) const;
};

/// A finished (or stopped) record. Throws std::runtime_error if a file is missing or damaged.
class RecordReader {
 public:
  explicit RecordReader(std::filesystem::path folder);
  const std::filesystem::path& folder() const { return folder_; }
  bool has_series(const std::string& name) const;
  const SeriesData& series(const std::string& name) const;
  /// Times at which the table `name` was written, ascending.
  std::vector<double> table_times(const std::string& name) const;
  /// The table `name` of `time`, which may differ from the recorded time by rounding.
  const SeriesData& table(const std::string& name, double time) const;
  /// manifest.json, as text.
  const std::string& manifest() const { return manifest_; }
  /// A number of the solver (Manifest::numbers) or of the writer ("wall_seconds",
  /// "processor_seconds", "threads", "cores", "peak_memory_bytes"). Throws std::runtime_error if
  /// there is none.
  double manifest_number(const std::string& name) const;
  /// A note of the solver (Manifest::notes) or a text of the writer ("solver", "scene_title",
  /// "scene_file", "scene_toml", "outcome", "commit", "clean": yes, no or unknown, "compiler",
  /// "compiler_flags", "build_type", "processor", "start_time_utc"). Throws std::runtime_error if
  /// there is none.
  std::string manifest_text(const std::string& name) const;
  std::vector<std::pair<std::string, double>> cost() const;

 private:
  std::filesystem::path folder_;
  std::string manifest_;
  std::map<std::string, SeriesData> series_;
  std::map<std::string, std::map<double, SeriesData>> tables_;
};

}  // namespace sprung
