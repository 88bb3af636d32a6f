#pragma once
/// Marches the coupled equations with diagonally implicit Runge-Kutta stages, each solved by
/// Newton's method with a matrix that is kept until it no longer pays, and with a line search.
///
/// The line search is the natural monotonicity test (Deuflhard 2004, Newton Methods for Nonlinear
/// Problems, section 3.3): a correction is taken back and halved if the next one, by the same
/// matrix, is larger, if a cell turned inside out, or if a value is not finite. Where nothing goes
/// wrong it costs nothing: the next correction is wanted anyway.

#include "reference_fem/fluid_structure.hpp"
#include "reference_fem/mesh_motion.hpp"
#include "reference_fem/secants.hpp"
#include "reference_fem/time_scheme.hpp"

#include <exception>
#include <map>
#include <string>

namespace sprung::reference {

struct NewtonSettings {
  double tolerance = 1e-6;  ///< last correction's error, relative to the largest speed
  double slow = 0.5;        ///< a contraction slower than this calls for a new matrix
  int max_iterations = 30;
  int max_halvings = 6;  ///< of one correction by the line search; 0: no line search
};

struct Effort {
  long steps = 0, stages = 0, iterations = 0, factorizations = 0;
  long halvings = 0;                      ///< of corrections, by the line search
  std::map<std::string, double> seconds;  ///< processor seconds by phase
};

/// Adds the processor time of its scope to a phase.
class Stopwatch {
 public:
  Stopwatch(Effort& effort, const char* phase);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& slot_;
  double begin_;
};

/// What a run must remember between steps; all of it goes into a checkpoint.
struct State {
  double time = 0.0;
  Fields now;
  bool slope_known = false;  ///< `now.acceleration` is valid as first slope of the next step
  /// The stage before the last, for extrapolation.
  bool has_before = false;
  double before_time = 0.0;
  std::vector<double> before_acceleration, before_pressure;
};

class TimeIntegration {
 public:
  TimeIntegration(FluidStructure& system, const MeshMotion& motion, NewtonSettings newton);
  /// From rest at t = 0.
  State initial_state() const;
  /// One step of `scheme`; a scheme with an explicit first stage needs state.slope_known.
  /// Throws InvertedCell or std::runtime_error (Newton) and leaves `state` as it was.
  void step(State& state, const TimeScheme& scheme, double dt);
  /// Forgets the matrix, so that a run continued from a checkpoint takes the very same path without
  /// its being stored.
  void forget_matrix() {
    forget_matrix_only();
    contraction_ = 1.0;
  }
  /// What a run stopped between its checkpoints needs to go on by the very same path: where the
  /// matrix was made, and what was learned since, as arrays "matrix/..." and "secants/...".
  void save(Archive& archive) const;
  /// Makes that matrix again; forgets the present one if the archive has none.
  void restore(const Archive& archive);
  /// Largest embedded error estimate of the last step in displacement (m); 0 if the scheme has
  /// none.
  double displacement_error() const { return displacement_error_; }
  const StageWeights& weights() const { return weights_; }
  /// The largest speed met so far (m/s), to which the Newton tolerance refers.
  double speed_scale() const { return speed_scale_; }
  void set_speed_scale(double speed) { speed_scale_ = speed; }
  const Effort& effort() const { return effort_; }
  Effort& effort() { return effort_; }

 private:
  void update_from_velocity(Fields& fields, const std::vector<double>& base_velocity,
                            const std::vector<double>& base_displacement) const;
  /// The last update of a stage: the bodies move by the final velocity, the fluid's mesh stays
  /// where the last iteration put it. Where it stands is free, as long as its velocity and place
  /// agree.
  void conclude(Fields& fields, const std::vector<double>& base_velocity,
                const std::vector<double>& base_displacement) const;
  void integrate(Fields& fields, const std::vector<double>& base_velocity,
                 const std::vector<double>& base_displacement) const;
  void solve_stage(Fields& fields, const std::vector<double>& base_velocity,
                   const std::vector<double>& base_displacement);
  struct LastStep;
  void forget_matrix_only() {
    matrix_c_ = 0.0;
    secants_.clear();
  }
  void linearize(const Fields& fields);
  /// Residual at `fields`, whose mesh is moved first, and the correction by the present matrix; its
  /// size (m/s). Infinite if it is not finite.
  double correction_at(Fields& fields, const std::vector<double>& base_velocity,
                       const std::vector<double>& base_displacement);
  void go_back(LastStep& last, const std::exception_ptr& fault, Fields& fields,
               const std::vector<double>& base_velocity,
               const std::vector<double>& base_displacement);

  FluidStructure& system_;
  const MeshMotion& motion_;
  NewtonSettings newton_;
  StageWeights weights_;
  Secants secants_;
  double matrix_c_ = 0.0;  ///< the c that the matrix was made for; 0: none
  Fields matrix_fields_;   ///< where it was made
  StageWeights matrix_weights_;
  Residual residual_;                                  ///< of the point last looked at
  std::vector<double> velocity_step_, pressure_step_;  ///< and the correction there
  double contraction_ = 1.0;                           ///< of the last stage
  double speed_scale_ = 0.0;
  double displacement_error_ = 0.0;
  mutable Effort effort_;
};

}  // namespace sprung::reference
