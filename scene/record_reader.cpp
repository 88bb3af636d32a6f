#include "scene/atomic_file.hpp"
#include "scene/record.hpp"
#include "scene/record_file.hpp"
#include "scene/record_text.hpp"
#include "scene/spelling.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sprung {
namespace {

using Json = nlohmann::ordered_json;

/// Times read from a scene file and times that a solver stepped to differ by less than this part of
/// the largest time.
constexpr double time_tolerance = 1e-9;

std::string names_in(const auto& map) {
  std::vector<std::string> names;
  for (const auto& [name, data] : map) names.push_back(name);
  return names.empty() ? "none" : list_words(names, false, "and");
}

[[noreturn]] void refuse(const std::filesystem::path& folder, const std::string& what) {
  throw std::runtime_error((folder / "record.h5").string() + ": " + what);
}

Json parse_manifest(const std::filesystem::path& folder, const std::string& text) {
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    throw std::runtime_error((folder / "manifest.json").string() + ": is damaged (" + error.what() +
                             ")");
  }
}

}  // namespace

std::vector<double> SeriesData::column(const std::string& name) const {
  const auto at = std::find_if(columns.begin(), columns.end(),
                               [&](const Column& column) { return column.name == name; });
  if (at == columns.end()) {
    std::vector<std::string> names;
    for (const auto& column : columns) names.push_back(column.name);
    throw std::runtime_error("no column " + name + "; there are " +
                             list_words(names, false, "and"));
  }
  const auto first = static_cast<std::size_t>(at - columns.begin());
  std::vector<double> result;
  result.reserve(rows());
  for (std::size_t i = first; i < values.size(); i += columns.size()) result.push_back(values[i]);
  return result;
}

RecordReader::RecordReader(std::filesystem::path folder) : folder_(std::move(folder)) {
  manifest_ = read_text_file(folder_ / "manifest.json");
  parse_manifest(folder_, manifest_);
  auto content = read_record_file(folder_, false);
  series_ = std::move(content.series);
  tables_ = std::move(content.tables);
}

bool RecordReader::has_series(const std::string& name) const {
  return series_.contains(name);
}

const SeriesData& RecordReader::series(const std::string& name) const {
  const auto at = series_.find(name);
  if (at == series_.end())
    refuse(folder_, "no series " + name + "; there are " + names_in(series_));
  return at->second;
}

std::vector<double> RecordReader::table_times(const std::string& name) const {
  const auto at = tables_.find(name);
  if (at == tables_.end()) refuse(folder_, "no table " + name + "; there are " + names_in(tables_));
  std::vector<double> times;
  for (const auto& [time, data] : at->second) times.push_back(time);
  return times;
}

const SeriesData& RecordReader::table(const std::string& name, double time) const {
  const auto times = table_times(name);
  const auto nearest = std::min_element(times.begin(), times.end(), [&](double a, double b) {
    return std::abs(a - time) < std::abs(b - time);
  });
  if (!(std::abs(*nearest - time) <= time_tolerance * std::abs(times.back()))) {
    std::vector<std::string> texts;
    for (const double at : times) texts.push_back(shortest(at));
    refuse(folder_, "no table " + name + " at " + shortest(time) + " s; there are those at " +
                        list_words(texts, false, "and") + " s");
  }
  return tables_.at(name).at(*nearest);
}

double RecordReader::manifest_number(const std::string& name) const {
  const Json json = parse_manifest(folder_, manifest_);
  for (const Json& place : {json.value("numbers", Json::object()), json})
    if (place.contains(name) && place[name].is_number()) return place[name].get<double>();
  throw std::runtime_error((folder_ / "manifest.json").string() + ": no number " + name);
}

std::string RecordReader::manifest_text(const std::string& name) const {
  const Json json = parse_manifest(folder_, manifest_);
  for (const Json& place : {json.value("notes", Json::object()), json})
    if (place.contains(name) && place[name].is_string()) return place[name].get<std::string>();
  throw std::runtime_error((folder_ / "manifest.json").string() + ": no text " + name);
}

std::vector<std::pair<std::string, double>> RecordReader::cost() const {
  const Json json = parse_manifest(folder_, manifest_);
  std::vector<std::pair<std::string, double>> cost;
  try {
    for (const auto& entry : json.at("cost"))
      cost.emplace_back(entry.at("phase").get<std::string>(), entry.at("seconds").get<double>());
  } catch (const Json::exception& error) {
    throw std::runtime_error((folder_ / "manifest.json").string() + ": is damaged (" +
                             error.what() + ")");
  }
  return cost;
}

}  // namespace sprung
