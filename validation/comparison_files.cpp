#include "validation/comparison_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "validation/measures.hpp"

namespace sprung {

namespace {

using Json = nlohmann::ordered_json;

Json optional_number(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json to_json(const Measurement& m) {
  Json out;
  out["measure"] = m.measure;
  out["subject"] = m.subject;
  out["time"] = optional_number(m.time);
  out["value"] = optional_number(m.value);
  out["unit"] = measure(m.measure).unit;
  out["candidate"] = optional_number(m.candidate);
  out["reference"] = optional_number(m.reference);
  out["sides_unit"] = m.sides_unit;
  out["reference_error"] = optional_number(m.reference_error);
  out["limit"] = optional_number(m.limit);
  out["because"] = m.because;
  out["verdict"] = to_string(m.verdict);
  out["remark"] = m.remark;
  return out;
}

/// Writes `text` to a neighbour of `file` and renames it: whoever looks sees the old or the new
/// file.
void write_whole(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path beside = file.string() + ".new";
  {
    std::ofstream out(beside);
    out << text;
    out.flush();
    if (!out) throw std::runtime_error(beside.string() + ": cannot be written");
  }
  std::filesystem::rename(beside, file);
}

std::string relative_to(const std::filesystem::path& path, const std::filesystem::path& folder) {
  return std::filesystem::proximate(std::filesystem::weakly_canonical(path),
                                    std::filesystem::weakly_canonical(folder))
      .generic_string();
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string csv_number(const std::optional<double>& value) {
  return value ? fmt::format("{:.9g}", *value) : "";
}

std::string csv_of(const ComparisonResult& result) {
  std::string out =
      "run,measure,subject,time [s],value,unit,candidate,reference,unit of sides,reference error,"
      "limit,verdict,remark\n";
  for (const RunComparison& run : result.runs) {
    for (const Measurement& m : run.measurements) {
      out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", quoted(run.run), m.measure,
                         quoted(m.subject), csv_number(m.time), csv_number(m.value),
                         measure(m.measure).unit, csv_number(m.candidate), csv_number(m.reference),
                         m.sides_unit, csv_number(m.reference_error), csv_number(m.limit),
                         to_string(m.verdict), quoted(m.remark));
    }
  }
  return out;
}

Json error_bar_json(const ErrorBar& error_bar) {
  Json all = Json::array();
  for (const ReferenceError& entry : error_bar.entries()) {
    all.push_back({{"quantity", entry.quantity},
                   {"time", entry.time},
                   {"error", entry.error},
                   {"extrapolated", optional_number(entry.extrapolated)},
                   {"observed_order", optional_number(entry.observed_order)}});
  }
  return all;
}

/// A ratio as a percentage, anything else with its unit.
std::string display(const std::optional<double>& value, const std::string& unit) {
  if (!value) return "-";
  if (unit == "1") return fmt::format("{:.3g} %", 100.0 * *value);
  return fmt::format("{:.4g} {}", *value, unit);
}

/// Counts are not percentages.
std::string display(const std::optional<double>& value, const Measurement& m) {
  if (value && m.measure == "lost_particles") return fmt::format("{:.0f}", *value);
  return display(value, measure(m.measure).unit);
}

}  // namespace

bool ComparisonResult::accepted() const {
  const bool all_there =
      std::none_of(planned_but_absent.begin(), planned_but_absent.end(),
                   [&](const std::string& name) { return !acceptance.run(name)->limits.empty(); });
  const auto any_judged = [](const RunComparison& run) {
    return std::any_of(run.measurements.begin(), run.measurements.end(),
                       [](const Measurement& m) { return m.limit.has_value(); });
  };
  // Nothing judged is nothing shown.
  return all_there && std::any_of(runs.begin(), runs.end(), any_judged) &&
         std::all_of(runs.begin(), runs.end(), [](const RunComparison& r) { return r.accepted(); });
}

void write_comparison(const ComparisonResult& result, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  Json out;
  out["title"] = result.acceptance.title;
  out["level"] = result.level;
  out["accepted"] = result.accepted();
  out["judged_at"] = result.acceptance.judged_at;
  out["force_window"] = result.acceptance.force_window;
  out["doubts"] = result.doubts;
  out["absent"] = result.planned_but_absent;
  out["reference"] = {{"folder", relative_to(result.reference_folder, folder)},
                      {"error_bar", error_bar_json(result.error_bar)}};
  out["reference"]["stated_error"] = Json::array();
  for (const auto& [name, stated] : result.acceptance.reference_error) {
    out["reference"]["stated_error"].push_back(
        {{"measure", name}, {"error", stated.value}, {"because", stated.because}});
  }
  out["measures"] = Json::array();
  for (const Measure& entry : measures()) {
    out["measures"].push_back({{"name", entry.name},
                               {"unit", entry.unit},
                               {"against_reference", entry.against_reference},
                               {"definition", entry.definition}});
  }
  out["runs"] = Json::array();
  for (const RunComparison& run : result.runs) {
    Json entry{{"run", run.run},
               {"folder", relative_to(run.folder, folder)},
               {"outcome", run.outcome},
               {"reached", run.reached},
               {"accepted", run.accepted()},
               {"measurements", Json::array()}};
    for (const Measurement& m : run.measurements) entry["measurements"].push_back(to_json(m));
    out["runs"].push_back(std::move(entry));
  }
  write_whole(folder / "measurements.csv", csv_of(result));
  write_whole(folder / "comparison.json", out.dump(1) + "\n");
}

std::string verdict_table(const ComparisonResult& result) {
  std::string out = result.acceptance.title + " (" + result.level + ")\n\n";
  const char* row = "{:<13} {:<26} {:>7} {:>12} {:>12} {:>9}  {}\n";
  out += fmt::format(fmt::runtime(row), "run", "measure", "at", "value", "+- reference", "limit",
                     "verdict");
  for (const RunComparison& run : result.runs) {
    bool any = false;
    for (const Measurement& m : run.measurements) {
      if (!m.limit) continue;
      any = true;
      const std::string verdict =
          m.remark.empty() ? to_string(m.verdict) : to_string(m.verdict) + (": " + m.remark);
      out += fmt::format(fmt::runtime(row), run.run, m.measure,
                         m.time ? fmt::format("{:g} s", *m.time) : "", display(m.value, m),
                         display(m.reference_error, m), display(m.limit, m), verdict);
    }
    if (!any) {
      out += fmt::format("{:<13} no limits: reported only\n", run.run);
    }
    if (run.outcome != "finished") {
      out += fmt::format("{:<13} came to t = {:.4g} s; outcome: {}\n", run.run, run.reached,
                         run.outcome);
    }
  }
  for (const std::string& name : result.planned_but_absent) {
    out += fmt::format("{:<13} not run\n", name);
  }
  out += "\n";
  for (const std::string& doubt : result.doubts) out += "note: " + doubt + "\n";
  out += result.accepted() ? "within the acceptance\n" : "not within the acceptance\n";
  return out;
}

}  // namespace sprung
