#include "reference_fem/time_integration.hpp"

#include "reference_fem/secants.hpp"
#include "scene/progress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sprung::reference {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

void add(std::vector<double>& y, double factor, const std::vector<double>& x) {
  for (std::size_t i = 0; i < y.size(); ++i) y[i] += factor * x[i];
}

}  // namespace

Stopwatch::Stopwatch(Effort& effort, const char* phase)
    : slot_(effort.seconds[phase]), begin_(processor_seconds()) {}

Stopwatch::~Stopwatch() {
  slot_ += processor_seconds() - begin_;
}

TimeIntegration::TimeIntegration(FluidStructure& system, const MeshMotion& motion,
                                 NewtonSettings newton)
    : system_(system), motion_(motion), newton_(newton) {}

State TimeIntegration::initial_state() const {
  State state;
  const auto n = 2 * static_cast<std::size_t>(system_.space().nodes());
  state.now = {std::vector<double>(n),
               std::vector<double>(static_cast<std::size_t>(system_.pressure_unknowns())),
               std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  return state;
}

void TimeIntegration::update_from_velocity(Fields& fields, const std::vector<double>& base_velocity,
                                           const std::vector<double>& base_displacement) const {
  fields.mesh_velocity = fields.velocity;
  {
    const Stopwatch watch(effort_, "mesh motion");
    motion_.extend(fields.mesh_velocity);
  }
  integrate(fields, base_velocity, base_displacement);
}

void TimeIntegration::integrate(Fields& fields, const std::vector<double>& base_velocity,
                                const std::vector<double>& base_displacement) const {
  const double c = weights_.c;
  for (std::size_t i = 0; i < fields.velocity.size(); ++i) {
    fields.acceleration[i] = (fields.velocity[i] - base_velocity[i]) / c;
    fields.displacement[i] = base_displacement[i] + c * fields.mesh_velocity[i];
  }
}

void TimeIntegration::conclude(Fields& fields, const std::vector<double>& base_velocity,
                               const std::vector<double>& base_displacement) const {
  for (int n = 0; n < system_.space().nodes(); ++n)
    if (system_.space().in_solid(n))
      for (std::size_t i = 2 * static_cast<std::size_t>(n), end = i + 2; i < end; ++i)
        fields.mesh_velocity[i] = fields.velocity[i];
  integrate(fields, base_velocity, base_displacement);
}

void TimeIntegration::linearize(const Fields& fields) {
  const Stopwatch watch(effort_, "factorisation");
  forget_matrix_only();
  system_.linearize(fields, weights_);
  matrix_c_ = weights_.c;
  matrix_fields_ = fields;
  matrix_weights_ = weights_;
  ++effort_.factorizations;
}

double TimeIntegration::correction_at(Fields& fields, const std::vector<double>& base_velocity,
                                      const std::vector<double>& base_displacement) {
  update_from_velocity(fields, base_velocity, base_displacement);
  if (std::abs(matrix_c_ - weights_.c) > 1e-9 * weights_.c) {
    linearize(fields);
    contraction_ = 1.0;
  }
  {
    const Stopwatch watch(effort_, "assembly");
    system_.residual(fields, weights_, residual_);
  }
  const Stopwatch watch(effort_, "solve");
  system_.correct(residual_, velocity_step_, pressure_step_);
  ++effort_.iterations;
  const double change = largest(velocity_step_) + 0.0 * largest(pressure_step_);
  return std::isfinite(change) ? change : infinite;
}

/// Where an iteration stood before its last step, and Newton's correction there: what the line
/// search goes back to.
struct TimeIntegration::LastStep {
  std::vector<double> velocity, pressure, velocity_step, pressure_step;
  double length = 0.0;       ///< part of the correction that was taken; 0: there is no last step
  double change = infinite;  ///< size of the correction (m/s), if the same matrix judges the next
  bool fresh = false;        ///< the matrix was made in this stage,
  bool here = false;         ///< and at this very point
};

/// Undoes the last step: a matrix made elsewhere is made anew there, otherwise half the step is
/// taken. Throws what went wrong if there is nothing to go back to or the step is short already.
void TimeIntegration::go_back(LastStep& last, const std::exception_ptr& fault, Fields& fields,
                              const std::vector<double>& base_velocity,
                              const std::vector<double>& base_displacement) {
  const double shortest = std::pow(0.5, newton_.max_halvings) * 1.01;
  if (last.length == 0.0 || last.length <= shortest) {
    if (fault) std::rethrow_exception(fault);
    throw std::runtime_error("Newton's method does not converge, however short its steps");
  }
  fields.velocity = last.velocity;
  fields.pressure = last.pressure;
  if (!last.here) {
    update_from_velocity(fields, base_velocity, base_displacement);
    linearize(fields);
    last = {};
    last.fresh = last.here = true;
    return;
  }
  ++effort_.halvings;
  last.length *= 0.5;
  add(fields.velocity, last.length, last.velocity_step);
  add(fields.pressure, last.length, last.pressure_step);
}

void TimeIntegration::solve_stage(Fields& fields, const std::vector<double>& base_velocity,
                                  const std::vector<double>& base_displacement) {
  ++effort_.stages;
  secants_.begin_stage();
  LastStep last;
  for (int iteration = 0; iteration < newton_.max_iterations;) {
    const long made = effort_.factorizations;
    double change = infinite;
    std::exception_ptr fault;
    try {
      change = correction_at(fields, base_velocity, base_displacement);
    } catch (const InvertedCell&) {
      fault = std::current_exception();
    }
    if (change == infinite && !fault)
      fault = std::make_exception_ptr(
          std::runtime_error("Newton's method met a value that is not finite"));
    const bool here = effort_.factorizations > made || (last.here && last.length == 0.0);
    const bool fresh = last.fresh || here;
    const bool grown = newton_.max_halvings > 0 && change > last.change;
    if (grown || fault) {
      go_back(last, fault, fields, base_velocity, base_displacement);
      continue;
    }
    ++iteration;
    const double theta = change / last.change;  // 0 if not known
    if (fresh && (theta > 0.8 || (theta > 0.0 && last.length < 1.0))) {
      linearize(fields);  // far from the solution: Newton's method proper
      last = {};
      last.fresh = last.here = true;
      continue;
    }
    last = {
        fields.velocity, fields.pressure, velocity_step_, pressure_step_, 1.0, change, fresh, here};
    secants_.accelerate(fields.velocity, fields.pressure, velocity_step_, pressure_step_);
    add(fields.velocity, 1.0, velocity_step_);
    add(fields.pressure, 1.0, pressure_step_);
    const double speed = std::max(speed_scale_, largest(fields.velocity));
    if (theta > 0.0) contraction_ = std::max(theta, 1e-3);
    const double remaining =
        contraction_ < 1.0 ? contraction_ / (1.0 - contraction_) * change : change;
    if (remaining <= newton_.tolerance * speed) {
      speed_scale_ = speed;  // of solutions only: a step that is taken back may be far too fast
      conclude(fields, base_velocity, base_displacement);
      return;
    }
    if (!fresh && theta > newton_.slow) {
      // The matrix no longer pays. Another one cannot judge the step just taken.
      forget_matrix_only();
      last.change = infinite;
    }
  }
  throw std::runtime_error("Newton's method did not converge in " +
                           std::to_string(newton_.max_iterations) + " iterations");
}

void TimeIntegration::save(Archive& archive) const {
  if (matrix_c_ == 0.0) return;
  archive["matrix/velocity"] = matrix_fields_.velocity;
  archive["matrix/pressure"] = matrix_fields_.pressure;
  archive["matrix/displacement"] = matrix_fields_.displacement;
  archive["matrix/mesh_velocity"] = matrix_fields_.mesh_velocity;
  archive["matrix/acceleration"] = matrix_fields_.acceleration;
  archive["matrix/weights"] = std::vector<double>{matrix_weights_.c, matrix_weights_.inertia,
                                                  matrix_weights_.time, contraction_};
  secants_.save(archive);
}

void TimeIntegration::restore(const Archive& archive) {
  forget_matrix();
  if (!archive.contains("matrix/weights")) return;
  const auto read = [&archive](const char* name) {
    return std::get<std::vector<double>>(archive.at(name));
  };
  matrix_fields_ = {read("matrix/velocity"), read("matrix/pressure"), read("matrix/displacement"),
                    read("matrix/mesh_velocity"), read("matrix/acceleration")};
  const std::vector<double> weights = read("matrix/weights");
  matrix_weights_ = {weights.at(0), weights.at(1), weights.at(2)};
  {
    const Stopwatch watch(effort_, "factorisation");
    system_.linearize(matrix_fields_, matrix_weights_);
  }
  matrix_c_ = matrix_weights_.c;
  contraction_ = weights.at(3);
  secants_.restore(archive);
}

namespace {

/// The latest solution and the slope and pressure before it: a stage's first guess is their
/// extrapolation.
struct Trend {
  const Fields* last = nullptr;
  double last_time = 0.0;
  bool has_slope = false;  ///< last->acceleration is valid
  const std::vector<double>* before_slope = nullptr;
  const std::vector<double>* before_pressure = nullptr;
  double before_time = 0.0;

  void follow(const Fields& solved, double time) {
    if (has_slope && last_time < time) {
      before_slope = &last->acceleration;
      before_pressure = &last->pressure;
      before_time = last_time;
    }
    last = &solved;
    last_time = time;
    has_slope = true;
  }
  /// Velocity quadratic, pressure linear in time, as far as known.
  Fields guess(double time) const {
    Fields fields = *last;
    if (!has_slope) return fields;
    const double s = time - last_time;
    add(fields.velocity, s, last->acceleration);
    if (before_slope == nullptr) return fields;
    const double ratio = s / (last_time - before_time);
    add(fields.velocity, 0.5 * s * ratio, last->acceleration);
    add(fields.velocity, -0.5 * s * ratio, *before_slope);
    add(fields.pressure, ratio, last->pressure);
    add(fields.pressure, -ratio, *before_pressure);
    return fields;
  }
};

/// Largest difference in displacement between the scheme and its embedded formula; 0 if it has
/// none.
double embedded_error(const TimeScheme& scheme, double dt, const std::vector<Fields>& solved) {
  if (scheme.embedded.empty()) return 0.0;
  double error = 0.0;
  for (std::size_t i = 0; i < solved.back().displacement.size(); ++i) {
    double sum = 0.0;
    for (std::size_t j = 0; j < solved.size(); ++j)
      sum += (scheme.a.back()[j] - scheme.embedded[j]) * solved[j].mesh_velocity[i];
    error = std::max(error, std::abs(dt * sum));
  }
  return error;
}

Trend trend_of(const State& state) {
  Trend trend;
  trend.last = &state.now;
  trend.last_time = state.time;
  trend.has_slope = state.slope_known;
  if (state.has_before) {
    trend.before_slope = &state.before_acceleration;
    trend.before_pressure = &state.before_pressure;
    trend.before_time = state.before_time;
  }
  return trend;
}

}  // namespace

void TimeIntegration::step(State& state, const TimeScheme& scheme, double dt) {
  const std::size_t stages = scheme.c.size();
  // Per stage: the solution, whose acceleration and mesh velocity are the stage's slopes.
  std::vector<Fields> solved(stages);
  if (scheme.explicit_first) {
    if (!state.slope_known) throw std::logic_error("the scheme needs a slope to start from");
    solved[0] = state.now;
  }
  weights_ = {scheme.gamma * dt, 1.0, state.time};
  Trend trend = trend_of(state);
  for (std::size_t i = scheme.explicit_first ? 1 : 0; i < stages; ++i) {
    const double time = state.time + scheme.c[i] * dt;
    std::vector<double> base_velocity = state.now.velocity,
                        base_displacement = state.now.displacement;
    for (std::size_t j = 0; j < i; ++j) {
      add(base_velocity, dt * scheme.a[i][j], solved[j].acceleration);
      add(base_displacement, dt * scheme.a[i][j], solved[j].mesh_velocity);
    }
    solved[i] = trend.guess(time);
    weights_.time = time;
    system_.impose(time, solved[i].velocity);
    solve_stage(solved[i], base_velocity, base_displacement);
    trend.follow(solved[i], time);
  }
  displacement_error_ = embedded_error(scheme, dt, solved);
  State next;
  next.time = state.time + dt;
  next.slope_known = true;
  if (stages >= 2) {
    const std::size_t inner = stages - 2;
    next.has_before = true;
    next.before_time = state.time + scheme.c[inner] * dt;
    next.before_acceleration = std::move(solved[inner].acceleration);
    next.before_pressure = std::move(solved[inner].pressure);
  }
  next.now = std::move(solved.back());
  state = std::move(next);
  ++effort_.steps;
}

}  // namespace sprung::reference
