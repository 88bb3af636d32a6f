#pragma once
/// A scene set up for the particle method: the state, the effects that the scene names, and the
/// ACTIONs of the time step, each with its equation number.

#include "scene/record.hpp"
#include "sph/boundary/open_sides.hpp"
#include "sph/effects/roles.hpp"
#include "sph/filling.hpp"
#include "sph/numerics.hpp"
#include "sph/pressure/solver.hpp"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace sprung::sph {

enum class Action {
  body_forces,
  predictor,
  pressure_assembly,
  pressure_solve,
  corrector,
  motion,
  support,
  guard,
  output
};
inline constexpr std::size_t action_count = 9;
const char* to_string(Action action);

/// The effects of a scene, by the role they play; built by the registry.
template <int dim>
struct Effects {
  std::vector<std::unique_ptr<Acceleration<dim>>> body_forces;  ///< ACTION 4
  std::vector<std::unique_ptr<Acceleration<dim>>> diffusion;    ///< ACTION 5
  std::vector<std::unique_ptr<Motion<dim>>> motion;             ///< ACTION 8
  std::vector<Constraint<dim>*> constraints;                    ///< ACTION 7
  std::vector<std::unique_ptr<TimeDependence<dim>>> prescriptions;
  std::vector<TimeDependence<dim>*> time_dependence;             ///< of any effect
  std::vector<std::unique_ptr<TimeStepLimit<dim>>> pure_limits;  ///< effects that do nothing else
  std::vector<const TimeStepLimit<dim>*> limits;
};

struct TimeStepChoice {
  double value = 0.0;
  std::string_view limit;  ///< what set it, in words
};

template <int dim>
class Simulation {
 public:
  Simulation(Numerics numerics, Particles<dim> particles, Images<dim> images);

  /// Set-up: boundaries and effects are added before the first call of start().
  void add_inflow(InflowSide<dim> side) { inflow_.push_back(std::move(side)); }
  void add_pressure_side(PressureColumns<dim> side) { pressure_sides_.push_back(std::move(side)); }
  Effects<dim>& effects() { return effects_; }
  /// Builds the first support lists (ACTION 3). `velocity_scale` (m/s) is the fastest flow
  /// expected, for the CFL limit and the rate of the density feedback. `fixed_time_step`: 0 lets
  /// the limits decide.
  void start(double velocity_scale, double fixed_time_step);

  /// Spreads the fluid evenly before the start: on a lattice cut by curved walls the gaps differ.
  /// Walls, columns and solids stay. Called after start(), which it calls for.
  void relax(int sweeps);

  /// Volume of each solid particle (m2 or m3) where bodies have lattices of their own; a particle's
  /// otherwise. Called before start().
  void set_solid_volumes(std::vector<double> volumes) { solid_volume_ = std::move(volumes); }

  /// A body in vacuum: its sides are free surfaces at zero pressure, and the density feedback aims
  /// at each particle's own kernel sum at rest. Called before start(); for tests of the material,
  /// not of a flow.
  void stand_in_vacuum() { vacuum_ = true; }

  /// The largest step that every limit allows, and which limit that is.
  TimeStepChoice time_step_limit() const;
  /// The step that the run takes: the limits', or the one that the scene fixes.
  TimeStepChoice chosen_time_step() const;
  /// Every later step is this part of what the limits or the scene say: a run that its guard has
  /// sent back goes on so.
  void shorten_steps(double factor) { step_factor_ = factor; }
  double step_factor() const { return step_factor_; }
  /// Sets the next step; shortened so that `stop_at` (the next time at which someone looks) is met.
  void choose_time_step();
  void stop_at(double time) { stop_at_ = time; }

  /// What depends on time alone, at the clock's time: walls, uniform forces, columns.
  void prescribe();
  void add_body_forces();             // ACTION 4
  void predict_velocity();            // ACTION 5
  void solve_pressure();              // ACTION 6
  void correct_velocity();            // ACTION 7
  void move_particles();              // ACTION 8
  void update_support_and_mirrors();  // ACTION 9

  const State<dim>& state() const { return state_; }
  State<dim>& state() { return state_; }
  const Numerics& numerics() const { return numerics_; }
  const SolveReport& pressure_report() const { return pressure_report_; }
  const ParticleBooks& books() const { return books_; }
  double inflow_flux() const;
  const std::vector<PressureColumns<dim>>& pressure_sides() const { return pressure_sides_; }
  /// Root mean square of the divergence (Eq. 3's sum) that the corrector left, 1/s; what
  /// volume_along_step and the feedbacks asked for is part of it.
  double remaining_divergence();
  const std::array<double, action_count>& seconds() const { return seconds_; }
  void add_seconds(Action action, double seconds) { seconds_[std::size_t(action)] += seconds; }
  double velocity_scale() const { return velocity_scale_; }

  void save(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  void divergence(const std::vector<Vector<dim>>& velocity, std::vector<double>& result,
                  std::span<const char> where = {});
  void divergence_to_remove();
  void build_support();
  void search();
  void correct_gradients();
  void map_cells();
  std::size_t first_fed_back() const;
  void add_density_feedback();
  void add_void_feedback();
  double mean_prescribed_pressure() const;
  void find_pressure(std::span<const double> source, std::span<double> pseudo_pressure,
                     double tolerance);
  void project_what_is_left(double tolerance);
  void find_surroundings_of_bodies();
  void accelerate_by_pressure(std::span<const char> where = {});

  Numerics numerics_;
  State<dim> state_;
  Effects<dim> effects_;
  std::vector<InflowSide<dim>> inflow_;
  std::vector<PressureColumns<dim>> pressure_sides_;
  std::unique_ptr<PressureSolver> solver_;
  PressureMatrix matrix_;
  SolveReport pressure_report_;
  ParticleBooks books_;
  double velocity_scale_ = 0.0;
  double fixed_time_step_ = 0.0;
  double step_factor_ = 1.0;
  double stop_at_ = std::numeric_limits<double>::infinity();
  PressurePlanes<dim> pressure_planes_;
  bool vacuum_ = false;
  double full_weight_ = 0.0;                ///< sum of a_ij on the whole lattice, for free surfaces
  std::vector<double> rest_partition_;      ///< of each particle in vacuum
  Vector<dim> cell_origin_, inverse_cell_;  ///< of the coarse cells of the pressure equation
  CellMap cells_;
  FillingGrid<dim> filling_;
  std::vector<double> solid_volume_;
  std::array<double, action_count> seconds_{};

  std::vector<Vector<dim>> acceleration_;
  std::vector<Vector<dim>> displacement_;
  std::vector<double> source_, left_, pressure_change_;
  std::vector<char> beside_, reached_;  ///< see find_surroundings_of_bodies
  std::vector<Vector<dim>> extended_before_;
  std::vector<double> point_volume_, lacking_;
};

}  // namespace sprung::sph
