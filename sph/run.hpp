#pragma once
/// Runs a scene to its end: probes, ledgers, record, checkpoints, guard, progress.

#include "scene/document.hpp"
#include "sph/scene_setup.hpp"

#include <filesystem>

namespace sprung::sph {

struct RunOptions {
  std::filesystem::path out;
  bool resume = false;
  bool overwrite = false;
  double until = 0.0;  ///< s; pause after the step that reaches it, with a checkpoint; 0: never
};

/// How a run ended. A stop by the run's own guard is a result: the record is whole up to there.
enum class Outcome { finished, paused, stopped };

/// Throws SceneError or std::runtime_error when the run cannot begin.
template <int dim>
Outcome run(Document& document, const ModulusTable& table, const RunOptions& options);

}  // namespace sprung::sph
