#include "scene/manifest.hpp"

#include "scene/build.hpp"
#include "scene/document_tree.hpp"
#include "scene/progress.hpp"

#include <hdf5.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <stdexcept>

namespace sprung {
namespace {

using Json = nlohmann::ordered_json;

std::string processor_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) {
      const auto colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  return "unknown";
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(release);
}

std::string json_version() {
  return std::to_string(NLOHMANN_JSON_VERSION_MAJOR) + "." +
         std::to_string(NLOHMANN_JSON_VERSION_MINOR) + "." +
         std::to_string(NLOHMANN_JSON_VERSION_PATCH);
}

}  // namespace

double peak_memory_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return 1024.0 * std::stod(line.substr(6));  // in KiB
  return 0.0;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::vector<std::pair<std::string, double>> total_cost(const FullManifest& manifest) {
  auto total = manifest.earlier_cost;
  for (const auto& [phase, seconds] : manifest.cost) {
    const auto at = std::find_if(total.begin(), total.end(),
                                 [&](const auto& entry) { return entry.first == phase; });
    if (at == total.end())
      total.emplace_back(phase, seconds);
    else
      at->second += seconds;
  }
  return total;
}

std::string manifest_json(const FullManifest& manifest) {
  const Manifest& run = manifest.run;
  auto libraries = run.libraries;
  libraries.emplace("HDF5", hdf5_version());
  libraries.emplace("toml++", document_tree::toml_library_version());
  libraries.emplace("nlohmann_json", json_version());
  Json json;
  json["format"] = "sprung manifest 1";
  json["solver"] = run.solver;
  json["scene_title"] = run.scene_title;
  json["scene_file"] = run.scene_file;
  json["outcome"] = manifest.outcome;
  json["start_time_utc"] = manifest.start_time_utc;
  json["written_utc"] = utc_now();
  json["version"] = build::project_version;
  json["commit"] = build::commit;
  json["clean"] = build::clean;
  json["compiler"] = build::compiler;
  json["compiler_flags"] = build::compiler_flags;
  json["build_type"] = build::build_type;
  json["processor"] = processor_model();
  json["cores"] = sysconf(_SC_NPROCESSORS_ONLN);
  json["threads"] = run.threads;
  json["wall_seconds"] = manifest.earlier_wall_seconds + wall_seconds() - run.wall_start;
  json["processor_seconds"] =
      manifest.earlier_processor_seconds + processor_seconds() - run.processor_start;
  json["peak_memory_bytes"] = peak_memory_bytes();
  json["libraries"] = libraries;
  json["cost"] = Json::array();
  for (const auto& [phase, seconds] : total_cost(manifest))
    json["cost"].push_back({{"phase", phase}, {"seconds", seconds}});
  json["numbers"] = run.numbers;
  json["notes"] = run.notes;
  json["resumed"] = Json::array();
  for (const auto& resumption : manifest.resumptions)
    json["resumed"].push_back({{"time", resumption.time},
                               {"at_utc", resumption.at_utc},
                               {"commit", resumption.commit},
                               {"clean", resumption.clean}});
  json["scene_toml"] = run.scene_toml;
  // Text that is not UTF-8 (a file name, say) is shown with replacement characters, not refused.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void continue_manifest(FullManifest& manifest, const std::string& text, const std::string& file,
                       double time) {
  try {
    const Json json = Json::parse(text);
    const auto require_same = [&](const char* what, const std::string& mine, const char* remedy) {
      if (json.at(what).get<std::string>() != mine)
        throw std::runtime_error(file + ": the record was made with another " + what + "; " +
                                 remedy);
    };
    require_same("solver", manifest.run.solver, "resume it with that solver");
    require_same("scene_toml", manifest.run.scene_toml,
                 "resume it with the same scene and overrides, or start a new record");
    manifest.start_time_utc = json.at("start_time_utc");
    manifest.earlier_wall_seconds = json.at("wall_seconds");
    manifest.earlier_processor_seconds = json.at("processor_seconds");
    for (const auto& entry : json.at("cost"))
      manifest.earlier_cost.emplace_back(entry.at("phase"), entry.at("seconds"));
    for (const auto& entry : json.at("resumed"))
      manifest.resumptions.push_back(
          {entry.at("time"), entry.at("at_utc"), entry.at("commit"), entry.at("clean")});
  } catch (const Json::exception& error) {
    throw std::runtime_error(file + ": is damaged (" + error.what() + ")");
  }
  manifest.resumptions.push_back({time, utc_now(), build::commit, build::clean});
}

}  // namespace sprung
