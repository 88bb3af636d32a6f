#pragma once
/// acceptance.toml of a case: which runs are made, and how far they may be from the reference.

#include "scene/document.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace sprung {

/// A number to hold a measurement against, with its reason or origin.
struct StatedValue {
  double value = 0.0;  ///< SI
  std::string because;
};

/// A run of a solver as the case wants it: the scene file with these overrides.
struct PlannedRun {
  std::string name;
  std::vector<std::string> overrides;         ///< "numerics.preset=paper"
  std::vector<std::string> options;           ///< "--converge"
  std::optional<double> time_limit;           ///< s of wall time
  std::map<std::string, StatedValue> limits;  ///< by name of measure
};

/// One level ("full", "quick") of an acceptance file:
///
///     [measure]                      # how, for all levels
///     judged_at = ["0.2 s", "1 s"]
///     force_window = "0.1 s"         # force: mean over this window, centred, cut at the run's end
///     lag_search = "60 ms"           # largest lag looked for
///     [full.reference]
///     converge = true                # the reference's own error bar is measured
///     scene.reference_fem.cell_size = "5 mm"     # overrides of the scene file
///     [full.run.recommended]
///     scene.numerics.preset = "recommended"
///     time_limit = "600 s"           # wall time, if any
///     limits.velocity_difference = { at_most = 0.03, because = "..." }
///     [full.reference_error]         # stated, where it is not measured
///     displacement_difference = { is = 0.02, because = "..." }
struct Acceptance {
  std::string title;
  std::vector<double> judged_at;  ///< s, ascending
  double force_window = 0.0;      ///< s
  double lag_search = 0.0;        ///< s
  PlannedRun reference;
  std::vector<PlannedRun> runs;
  std::map<std::string, StatedValue> reference_error;  ///< by name of measure

  /// The run of that name; nullptr if the case does not name it.
  const PlannedRun* run(const std::string& name) const;
};

/// Reads one level. Throws SceneError, with file, line, value and remedy, for anything it does not
/// know: a misspelt measure included.
Acceptance read_acceptance(const std::filesystem::path& file, const std::string& level);
Acceptance read_acceptance(const Document& document, const std::string& level);

}  // namespace sprung
