/// sprung-compare: one reference record against particle records.
///  1. read the acceptance of the case (or, with --plan, print which runs it wants, and stop)
///  2. read the reference's record and its error bar
///  3. compare each particle record, named by its folder, and judge it
///  4. write comparison.json and measurements.csv, print the table of verdicts
/// Exit code 0: within the acceptance; 1: not; 2: error.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "validation/comparison_files.hpp"

namespace {

using namespace sprung;

/// One line per run, fields parted by tabs: kind, name, time limit in s or "none", arguments.
void print_plan(const Acceptance& acceptance) {
  const auto print = [](const char* kind, const PlannedRun& run) {
    fmt::print("{}\t{}\t{}", kind, run.name,
               run.time_limit ? fmt::format("{:.0f}", *run.time_limit) : "none");
    for (const std::string& text : run.overrides) fmt::print("\t{}", text);
    for (const std::string& text : run.options) fmt::print("\t{}", text);
    fmt::print("\n");
  };
  print("reference", acceptance.reference);
  for (const PlannedRun& run : acceptance.runs) print("run", run);
}

/// What the manifest says that lowers the worth of a comparison.
void add_doubts(const std::string& name, const RecordReader& record,
                std::vector<std::string>& doubts) {
  const std::string clean = record.manifest_text("clean");
  if (clean == "no") {
    doubts.push_back(name + " was made by a program with changes that were not committed");
  } else if (clean != "yes") {
    doubts.push_back(name + " does not say from which commit its program was built");
  }
}

ComparisonResult compare_all(const std::filesystem::path& reference_folder,
                             const std::vector<std::filesystem::path>& candidates,
                             const Acceptance& acceptance, const std::string& level) {
  ComparisonResult result;
  result.level = level;
  result.acceptance = acceptance;
  result.reference_folder = reference_folder;
  const Answer reference = Answer::read(reference_folder);
  add_doubts("the reference", reference.record, result.doubts);
  const auto error_bar = reference_folder / "error_bar.json";
  if (std::filesystem::exists(error_bar)) result.error_bar = ErrorBar(error_bar);
  if (result.error_bar.empty()) {
    result.doubts.emplace_back(
        acceptance.reference_error.empty()
            ? "the reference's own error was not measured in this comparison"
            : "the reference's own error is the one that the acceptance states, not measured here");
  }
  for (const auto& folder : candidates) {
    const std::string name = std::filesystem::weakly_canonical(folder).filename().string();
    const Answer candidate = Answer::read(folder);
    add_doubts(name, candidate.record, result.doubts);
    result.runs.push_back(compare(reference, candidate, result.error_bar, acceptance, name));
  }
  for (const PlannedRun& planned : acceptance.runs) {
    const bool there = std::any_of(result.runs.begin(), result.runs.end(),
                                   [&](const RunComparison& r) { return r.run == planned.name; });
    if (!there) result.planned_but_absent.push_back(planned.name);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Compares particle records with a reference record and judges them.\n"
      "Each particle record's folder bears the name of the run in the acceptance file.\n\n"
      "  sprung-compare results/reference results/runs/recommended \\\n"
      "    --acceptance validation/beam_in_channel/acceptance.toml --out results\n"
      "  sprung-compare --plan validation/beam_in_channel/acceptance.toml --level quick");
  std::filesystem::path reference, acceptance_file, plan_file, out;
  std::vector<std::filesystem::path> candidates;
  std::string level = "full";
  app.add_option("reference", reference, "folder of the reference's record");
  app.add_option("runs", candidates, "folders of particle records");
  app.add_option("--acceptance", acceptance_file, "acceptance.toml of the case");
  app.add_option("--out", out, "folder for comparison.json and measurements.csv");
  app.add_option("--level", level, "full or quick")->capture_default_str();
  app.add_option("--plan", plan_file, "print the runs that this acceptance file wants, and stop");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    if (!plan_file.empty()) {
      print_plan(read_acceptance(plan_file, level));
      return 0;
    }
    if (reference.empty() || acceptance_file.empty() || out.empty()) {
      throw std::runtime_error("give a reference record, --acceptance and --out; see --help");
    }
    const ComparisonResult result =
        compare_all(reference, candidates, read_acceptance(acceptance_file, level), level);
    write_comparison(result, out);
    fmt::print("{}", verdict_table(result));
    return result.accepted() ? 0 : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "sprung-compare: {}\n", error.what());
    return 2;
  }
}
