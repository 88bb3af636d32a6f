#pragma once
/// manifest.json: what was run, by which program, where, at what cost.

#include "scene/record.hpp"

#include <string>
#include <utility>
#include <vector>

namespace sprung {

struct Resumption {
  double time = 0.0;  ///< simulated s at which the run went on
  std::string at_utc;
  std::string commit;
  std::string clean;
};

/// A manifest with what the writer adds to it.
struct FullManifest {
  Manifest run;
  std::string start_time_utc;
  std::string outcome = "running";
  std::vector<std::pair<std::string, double>> cost;  ///< of this process
  std::vector<Resumption> resumptions;
  // Spent by the processes whose run this one continues.
  double earlier_wall_seconds = 0.0;
  double earlier_processor_seconds = 0.0;
  std::vector<std::pair<std::string, double>> earlier_cost;
};

/// "2025-01-31T12:00:00Z"
std::string utc_now();

/// The largest resident set of this program so far; 0 where the system does not tell. Not
/// getrusage's figure: that keeps what the process was before it became this program, its
/// launcher's memory.
double peak_memory_bytes();

std::string manifest_json(const FullManifest& manifest);

/// Takes over start, costs and resumptions from `json`, the manifest of a run stopped earlier, and
/// adds the resumption at `time`. Throws std::runtime_error if the text is damaged or describes
/// another solver or scene; `file` names it in messages.
void continue_manifest(FullManifest& manifest, const std::string& json, const std::string& file,
                       double time);

/// Every phase once, the earlier ones first, with the sum of its seconds.
std::vector<std::pair<std::string, double>> total_cost(const FullManifest& manifest);

}  // namespace sprung
