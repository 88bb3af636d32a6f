#include "scene/atomic_file.hpp"
#include "scene/manifest.hpp"
#include "scene/record.hpp"
#include "scene/record_file.hpp"
#include "scene/record_text.hpp"
#include "scene/snapshot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

namespace sprung {

namespace fs = std::filesystem;

struct RecordWriter::State {
  fs::path folder;
  FullManifest manifest;
  RecordContent content;
  std::set<std::string> changed_series;                     ///< since the last flush
  std::set<std::pair<std::string, double>> changed_tables;  ///< since the last flush
  bool finished = false;

  void make_folders() const;
  void remove_old() const;
  void remove_unfinished() const;
  void remove_beyond(double time);
  void add_snapshot(double time, const SnapshotData& data);
  void reach(double time) { content.reached = std::max(content.reached, time); }
  void flush();
};

namespace {

bool same_columns(const std::vector<Column>& a, const std::vector<Column>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Column& x, const Column& y) {
    return x.name == y.name && x.unit == y.unit;
  });
}

fs::path series_file(const fs::path& folder, const std::string& name) {
  return folder / "probes" / (name + ".csv");
}

fs::path table_file(const fs::path& folder, const std::string& name, double time) {
  return folder / "probes" / (name + "_t" + shortest(time) + ".csv");
}

constexpr std::array main_files{"record.h5", "record.xdmf", "manifest.json", "checkpoint.h5"};

/// Files that a record may have left in one of its folders: `extension`, or its unfinished ".part".
std::vector<fs::path> own_files(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const auto name = entry.path().filename().string();
    if (name.ends_with(extension) || name.ends_with(extension + ".part"))
      files.push_back(entry.path());
  }
  return files;
}

}  // namespace

void RecordWriter::State::make_folders() const {
  for (const auto& path : {folder, folder / "fields", folder / "probes"}) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error || !fs::is_directory(path))
      throw std::runtime_error(path.string() + ": the record's folder cannot be made (" +
                               (error ? error.message() : "not a folder") +
                               "); name another with --out");
  }
}

void RecordWriter::State::remove_old() const {
  std::error_code error;
  for (const auto* name : main_files) fs::remove(folder / name, error);
  for (const auto& file : own_files(folder / "fields", ".vtkhdf")) fs::remove(file, error);
  for (const auto& file : own_files(folder / "probes", ".csv")) fs::remove(file, error);
  remove_unfinished();
}

/// What a run killed while writing left beside the main files.
void RecordWriter::State::remove_unfinished() const {
  std::error_code error;
  for (const auto* name : main_files) fs::remove(folder / (std::string(name) + ".part"), error);
}

void RecordWriter::State::remove_beyond(double time) {
  for (auto& [name, data] : content.series) {
    const std::size_t columns = data.columns.size();
    std::vector<double> kept;
    for (std::size_t row = 0; row < data.rows(); ++row)
      if (data.values[row * columns] <= time)
        kept.insert(kept.end(), data.values.begin() + static_cast<std::ptrdiff_t>(row * columns),
                    data.values.begin() + static_cast<std::ptrdiff_t>((row + 1) * columns));
    data.values = std::move(kept);
  }
  for (auto& [name, by_time] : content.tables)
    by_time.erase(by_time.upper_bound(time), by_time.end());
  std::erase_if(content.tables, [](const auto& entry) { return entry.second.empty(); });
  std::erase_if(content.snapshots, [&](const Snapshot& snapshot) { return snapshot.time > time; });
  content.reached = time;
}

void RecordWriter::State::add_snapshot(double time, const SnapshotData& data) {
  if (!std::isfinite(time)) throw std::runtime_error("snapshot: the time is " + shortest(time));
  auto& snapshots = content.snapshots;
  const auto same = std::find_if(snapshots.begin(), snapshots.end(),
                                 [&](const Snapshot& snapshot) { return snapshot.time == time; });
  if (same != snapshots.end()) {
    *same = write_snapshot(folder, same->index, time, data);
    return;
  }
  if (!snapshots.empty() && time < snapshots.back().time)
    throw std::logic_error("snapshot at " + shortest(time) + " s: before the last one");
  const int index = snapshots.empty() ? 0 : snapshots.back().index + 1;
  snapshots.push_back(write_snapshot(folder, index, time, data));
  reach(time);
}

void RecordWriter::State::flush() {
  write_record_file(folder, content);
  write_text_file(folder / "record.xdmf", xdmf_text(content.snapshots));
  for (const auto& name : changed_series)
    write_text_file(series_file(folder, name), csv_text(content.series.at(name)));
  for (const auto& [name, time] : changed_tables)
    write_text_file(table_file(folder, name, time), csv_text(content.tables.at(name).at(time)));
  changed_series.clear();
  changed_tables.clear();
  write_text_file(folder / "manifest.json", manifest_json(manifest));
}

RecordWriter::RecordWriter(fs::path folder, Manifest manifest, bool overwrite)
    : state_(std::make_unique<State>()) {
  state_->folder = std::move(folder);
  state_->manifest.run = std::move(manifest);
  state_->manifest.start_time_utc = utc_now();
  const auto& place = state_->folder;
  const bool occupied = fs::exists(place / "record.h5") || fs::exists(place / "manifest.json");
  if (occupied && !overwrite)
    throw std::runtime_error(
        place.string() + ": holds a record already; name another folder with --out, or remove it");
  state_->make_folders();
  if (overwrite) state_->remove_old();
  state_->flush();
}

RecordWriter RecordWriter::resume(fs::path folder, Manifest manifest, double time) {
  auto state = std::make_unique<State>();
  state->folder = std::move(folder);
  state->manifest.run = std::move(manifest);
  state->make_folders();
  const auto manifest_file = state->folder / "manifest.json";
  continue_manifest(state->manifest, read_text_file(manifest_file), manifest_file.string(), time);
  state->content = read_record_file(state->folder, true);
  if (time > state->content.reached)
    throw std::runtime_error((state->folder / "record.h5").string() + ": reaches " +
                             shortest(state->content.reached) +
                             " s and cannot go on from the checkpoint at " + shortest(time) +
                             " s: rows would be missing; start the run anew");
  state->remove_beyond(time);

  // First the record without the rows beyond, then the files that it no longer names: a stop
  // between the two leaves files too many, never a link to nothing.
  std::set<fs::path> wanted;
  for (const auto& [name, data] : state->content.series) {
    state->changed_series.insert(name);
    wanted.insert(series_file(state->folder, name));
  }
  for (const auto& [name, by_time] : state->content.tables)
    for (const auto& [at, data] : by_time) {
      state->changed_tables.emplace(name, at);
      wanted.insert(table_file(state->folder, name, at));
    }
  for (const auto& snapshot : state->content.snapshots)
    wanted.insert(state->folder / snapshot_file(snapshot.index));
  state->flush();
  state->remove_unfinished();
  std::error_code error;
  for (const auto& file : own_files(state->folder / "fields", ".vtkhdf"))
    if (!wanted.contains(file)) fs::remove(file, error);
  for (const auto& file : own_files(state->folder / "probes", ".csv"))
    if (!wanted.contains(file)) fs::remove(file, error);
  return RecordWriter(std::move(state));
}

RecordWriter::RecordWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
RecordWriter::RecordWriter(RecordWriter&&) noexcept = default;

RecordWriter::~RecordWriter() {
  if (!state_ || state_->finished) return;
  try {
    state_->manifest.outcome = "stopped: the run ended without closing its record";
    state_->flush();
  } catch (const std::exception&) {
    // The files of the last flush stand; their outcome is "running".
  }
}

void RecordWriter::declare_series(const std::string& name, std::vector<Column> columns) {
  require_name(name, "series");
  require_columns(columns, "series " + name);
  if (columns.front().name != "time" || columns.front().unit != "s")
    throw std::logic_error("series " + name + ": the first column must be time [s]");
  const auto at = state_->content.series.find(name);
  if (at != state_->content.series.end() && !same_columns(at->second.columns, columns))
    throw std::runtime_error("series " + name + ": the record has it with other columns");
  state_->changed_series.insert(name);
  if (at == state_->content.series.end())
    state_->content.series[name] = SeriesData{std::move(columns), {}};
}

void RecordWriter::append(const std::string& name, std::span<const double> row) {
  const auto at = state_->content.series.find(name);
  if (at == state_->content.series.end())
    throw std::logic_error("series " + name + ": append() before declare_series()");
  SeriesData& data = at->second;
  if (row.size() != data.columns.size())
    throw std::logic_error("series " + name + ": " + std::to_string(row.size()) + " values for " +
                           std::to_string(data.columns.size()) + " columns");
  for (std::size_t i = 0; i < row.size(); ++i)
    if (!std::isfinite(row[i]))
      require_finite(row.subspan(i, 1), "series " + name + ": " + data.columns[i].name +
                                            (i > 0 ? " at " + shortest(row[0]) + " s" : ""));
  if (data.rows() > 0 && row[0] < data.values[data.values.size() - row.size()])
    throw std::logic_error("series " + name + ": the time " + shortest(row[0]) +
                           " s lies before the last row");
  data.values.insert(data.values.end(), row.begin(), row.end());
  state_->reach(row[0]);
  state_->changed_series.insert(name);
}

void RecordWriter::write_table(const std::string& name, double time,
                               const std::vector<Column>& columns, std::span<const double> rows) {
  require_name(name, "table");
  const std::string where = "table " + name + " at " + shortest(time) + " s";
  require_columns(columns, where);
  if (rows.size() % columns.size() != 0)
    throw std::logic_error(where + ": the values do not fill whole rows");
  require_finite(std::span(&time, 1), "table " + name + ": the time");
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (!std::isfinite(rows[i]))
      require_finite(rows.subspan(i, 1), where + ": " + columns[i % columns.size()].name);
  if (state_->content.series.contains(table_file("", name, time).stem().string()))
    throw std::logic_error(where + ": a series has the name of its file");
  state_->content.tables[name][time] = SeriesData{columns, {rows.begin(), rows.end()}};
  state_->reach(time);
  state_->changed_tables.emplace(name, time);
}

void RecordWriter::write_points(double time, std::span<const double> positions,
                                const std::vector<Field>& fields) {
  state_->add_snapshot(time, {positions, 0, {}, &fields});
}

void RecordWriter::write_mesh(double time, std::span<const double> positions, int nodes_per_cell,
                              std::span<const std::int64_t> cells,
                              const std::vector<Field>& fields) {
  if (nodes_per_cell != 3 && nodes_per_cell != 4)
    throw std::logic_error("a mesh's cells have 3 or 4 nodes");
  state_->add_snapshot(time, {positions, nodes_per_cell, cells, &fields});
}

void RecordWriter::set_cost(const std::vector<std::pair<std::string, double>>& seconds_by_phase) {
  for (const auto& [phase, seconds] : seconds_by_phase)
    require_finite(std::span(&seconds, 1), "the cost of " + phase);
  state_->manifest.cost = seconds_by_phase;
}

void RecordWriter::set_number(const std::string& name, double value) {
  require_finite(std::span(&value, 1), "the number " + name);
  state_->manifest.run.numbers[name] = value;
}

void RecordWriter::set_note(const std::string& name, const std::string& value) {
  state_->manifest.run.notes[name] = value;
}

void RecordWriter::flush() {
  state_->flush();
}

void RecordWriter::checkpoint(double time, const Archive& archive) {
  require_finite(std::span(&time, 1), "checkpoint: the time");
  state_->reach(time);
  flush();
  Archive with_time = archive;
  with_time["time"] = std::vector<double>{time};
  write_archive(state_->folder / "checkpoint.h5", with_time);
}

void RecordWriter::finish(const std::string& outcome) {
  state_->manifest.outcome = outcome;
  flush();
  state_->finished = true;
}

const fs::path& RecordWriter::folder() const {
  return state_->folder;
}

}  // namespace sprung
