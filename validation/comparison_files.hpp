#pragma once
/// What a comparison leaves behind: comparison.json and measurements.csv for reports, and the table
/// of verdicts for people.

#include <filesystem>
#include <string>
#include <vector>

#include "validation/comparison.hpp"

namespace sprung {

/// Everything that one call of the comparison found.
struct ComparisonResult {
  std::string level;  ///< "full" or "quick"
  Acceptance acceptance;
  std::filesystem::path reference_folder;
  ErrorBar error_bar;
  std::vector<RunComparison> runs;
  std::vector<std::string> planned_but_absent;  ///< runs of the acceptance that were not compared
  std::vector<std::string> doubts;              ///< what a reader of the verdicts should know first
  /// Whether there are limits, every one was measured and passed, and no run that has some is
  /// absent.
  bool accepted() const;
};

/// Writes comparison.json and measurements.csv into `folder` (made if need be), each beside its
/// place and then renamed. Folders of records are written relative to `folder`. Throws
/// std::runtime_error if a file cannot be written.
void write_comparison(const ComparisonResult& result, const std::filesystem::path& folder);

/// The table of verdicts: one line per limit, then the doubts, then the conclusion.
std::string verdict_table(const ComparisonResult& result);

}  // namespace sprung
