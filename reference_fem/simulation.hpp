#pragma once
/// One run of the reference: from a scene to its record.

#include "reference_fem/measurements.hpp"
#include "reference_fem/settings.hpp"

#include <filesystem>
#include <memory>

namespace sprung::reference {

struct RunOptions {
  std::filesystem::path out;
  int threads = 1;
  bool resume = false;
  bool overwrite = false;
  double until = 0.0;               ///< s; pause at the first checkpoint from here on; 0: never
  std::string label = "reference";  ///< what the progress line says
};

enum class Outcome { finished, paused };

/// A run that stopped itself (an inverted cell, no convergence); its record is whole up to there.
class RunStopped : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that SIGTERM, SIGINT or SIGHUP stopped between two steps, where it left a checkpoint.
class RunInterrupted : public std::runtime_error {
 public:
  RunInterrupted(const std::string& what, int signal) : std::runtime_error(what), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

/// Mesh, space, equations and time integration of one scene, in the order in which each needs the
/// last.
class Simulation {
 public:
  Simulation(const Problem& problem, const Settings& settings);

  const Problem& problem() const { return problem_; }
  const Settings& settings() const { return settings_; }
  const MeshQuality& quality() const { return quality_; }
  FluidStructure& system() { return *system_; }
  TimeIntegration& integration() { return *integration_; }
  State& state() { return state_; }
  /// The last step taken.
  const StepReport& last_step() const { return last_step_; }

  /// One step towards `event`, which it does not pass. The kinks of the inflow are events, too.
  void advance(double event);
  /// Times that a step must end at, ascending: probes, kinks, checkpoints, the end.
  std::vector<double> events() const;
  bool is_checkpoint(double time) const;

  void save(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  void set_initial_velocity();
  bool is_kink(double time) const;
  void choose_next_step(double tried);

  Problem problem_;
  Settings settings_;
  dealii::Triangulation<2> mesh_;
  MeshQuality quality_;
  std::unique_ptr<Space> space_;
  std::unique_ptr<FluidStructure> system_;
  std::unique_ptr<MeshMotion> motion_;
  std::unique_ptr<TimeIntegration> integration_;
  State state_;
  double wanted_step_ = 0.0;
  StepReport last_step_;
  double body_size_ = 0.0;
};

/// Runs `document`'s scene. `document` has been read by read_problem and read_settings.
/// Throws std::runtime_error when the run cannot begin, RunStopped when it stopped itself,
/// RunInterrupted when a signal stopped it; takes over the three signals' handlers.
Outcome run(const Document& document, const Problem& problem, const Settings& settings,
            const RunOptions& options);

}  // namespace sprung::reference
