#include "scene/record_file.hpp"

#include "scene/hdf5_file.hpp"

#include <cstdio>

namespace sprung {
namespace {

constexpr double format_version = 1.0;

void write_columns(hdf5::Output& output, const std::string& path, const SeriesData& data) {
  output.write(path, data.values, {data.rows(), data.columns.size()});
  std::vector<std::string> names, units;
  for (const auto& column : data.columns) {
    names.push_back(column.name);
    units.push_back(column.unit);
  }
  output.attribute(path, "columns", names);
  output.attribute(path, "units", units);
}

SeriesData read_columns(const hdf5::Input& input, const std::string& path) {
  SeriesData data;
  const auto names = input.texts(path, "columns");
  const auto units = input.texts(path, "units");
  const auto shape = input.shape(path);
  if (names.empty() || units.size() != names.size() || shape.size() != 2 ||
      shape[1] != names.size())
    input.fail("the columns of " + path + " do not fit their names");
  for (std::size_t i = 0; i < names.size(); ++i) data.columns.push_back({names[i], units[i]});
  data.values = input.doubles(path);
  return data;
}

std::string six_digits(int number) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", number);
  return text;
}

}  // namespace

void write_record_file(const std::filesystem::path& folder, const RecordContent& content) {
  hdf5::Output output(folder / "record.h5");
  output.attribute("/", "format", std::string("sprung record"));
  output.attribute("/", "format_version", format_version);
  output.attribute("/", "reached", content.reached);
  output.group("/series");
  for (const auto& [name, data] : content.series) write_columns(output, "/series/" + name, data);
  output.group("/tables");
  for (const auto& [name, by_time] : content.tables) {
    int number = 0;
    for (const auto& [time, data] : by_time) {
      const std::string path = "/tables/" + name + "/" + six_digits(number++);
      write_columns(output, path, data);
      output.attribute(path, "time", time);
    }
  }
  output.group("/fields");
  for (const auto& snapshot : content.snapshots)
    output.link("/fields/" + six_digits(snapshot.index), snapshot_file(snapshot.index));
  output.commit();
}

RecordContent read_record_file(const std::filesystem::path& folder, bool with_snapshots) {
  const hdf5::Input input(folder / "record.h5");
  const double version = input.number("/", "format_version");
  if (version != format_version)
    input.fail("it has the format " + std::to_string(version) + ", this program reads " +
               std::to_string(format_version));
  RecordContent content;
  content.reached = input.number("/", "reached");
  for (const auto& name : input.names("/series"))
    content.series[name] = read_columns(input, "/series/" + name);
  for (const auto& name : input.names("/tables"))
    for (const auto& number : input.names("/tables/" + name)) {
      const std::string path = "/tables/" + name + "/" + number;
      content.tables[name][input.number(path, "time")] = read_columns(input, path);
    }
  if (with_snapshots)
    for (const auto& number : input.names("/fields"))
      content.snapshots.push_back(read_snapshot(folder, std::stoi(number)));
  return content;
}

}  // namespace sprung
