#include "sph/simulation.hpp"

#include "scene/progress.hpp"
#include "sph/concentration.hpp"
#include "sph/pressure/first_guess.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace sprung::sph {

namespace {

/// Adds the time between its construction and its end to one ACTION's account.
class Stopwatch {
 public:
  Stopwatch(double& account) : account_(account), began_(wall_seconds()) {}
  ~Stopwatch() { account_ += wall_seconds() - began_; }

 private:
  double& account_;
  double began_;
};

std::unique_ptr<PressureSolver> make_solver(PressureSolverKind kind) {
  switch (kind) {
    case PressureSolverKind::bicgstab:
      return make_bicgstab_solver();
    case PressureSolverKind::jacobi_cg:
      return make_jacobi_solver();
    case PressureSolverKind::incomplete_cholesky:
      return make_incomplete_cholesky_solver();
    case PressureSolverKind::cholmod:
      return make_cholmod_solver();
    case PressureSolverKind::boomeramg:
      return make_boomeramg_solver();
    case PressureSolverKind::two_level:
      break;
  }
  return make_two_level_solver();
}

/// Steps between two sortings of the fluid in memory.
constexpr std::int64_t steps_between_sorts = 10;

}  // namespace

const char* to_string(Action action) {
  switch (action) {
    case Action::body_forces:
      return "ACTION 4 body forces";
    case Action::predictor:
      return "ACTION 5 predictor";
    case Action::pressure_assembly:
      return "ACTION 6 pressure, assembly";
    case Action::pressure_solve:
      return "ACTION 6 pressure, solution";
    case Action::corrector:
      return "ACTION 7 corrector";
    case Action::motion:
      return "ACTION 8 motion";
    case Action::support:
      return "ACTION 9 support and mirrors";
    case Action::guard:
      return "guard";
    case Action::output:
      return "probes and records";
  }
  return "";
}

template <int dim>
Simulation<dim>::Simulation(Numerics numerics, Particles<dim> particles, Images<dim> images)
    : numerics_(std::move(numerics)),
      state_{std::move(particles),
             std::move(images),
             {},
             Kernel<dim>(numerics_.smoothing_length_ratio * state_.particles.spacing),
             {},
             Vector<dim>::Zero(),
             Vector<dim>::Zero(),
             {},
             {}},
      solver_(make_solver(numerics_.pressure_solver)) {
  const LatticeSums sums = lattice_sums(state_.kernel, state_.particles.spacing);
  full_weight_ = 2.0 * sums.gradient_weight;
  if (numerics_.normalised_gradient) full_weight_ /= sums.gradient;
  if (numerics_.normalised_gradient) state_.kernel.normalise_gradient(sums.gradient);
}

template <int dim>
void Simulation<dim>::start(double velocity_scale, double fixed_time_step) {
  velocity_scale_ = velocity_scale;
  fixed_time_step_ = fixed_time_step;
  auto& particles = state_.particles;
  map_cells();
  for (const auto& side : inflow_) side.fill(particles);
  for (const auto& side : pressure_sides_) side.fill(particles);
  for (const auto& side : pressure_sides_) pressure_planes_.planes.push_back(side.plane());
  pressure_planes_.least_distance = 0.5 * particles.spacing;
  sort_by_role(particles, std::vector<bool>(particles.size(), false),
               state_.kernel.support_radius());
  prescribe();
  // The first guess of the pressure equation; later ones are the step's before.
  const double level = mean_prescribed_pressure();
  for (std::size_t i = 0; i < particles.unknowns; ++i) particles.pseudo_pressure[i] = level;
  build_support();
  rest_partition_ = state_.support.partition();
}

/// Coarse cells of 3 dx, and never narrower than a pair is long: larger ones take more iterations,
/// smaller ones more time each. They fill a periodic axis evenly.
template <int dim>
void Simulation<dim>::map_cells() {
  const auto& particles = state_.particles;
  const double widest = std::max(3.0 * particles.spacing, state_.kernel.support_radius());
  Vector<dim> low = particles.position[0], high = low;
  for (const auto& x : particles.position) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  low -= Vector<dim>::Constant(0.5 * particles.spacing);
  high += Vector<dim>::Constant(0.5 * particles.spacing);
  for (const auto& period : state_.images.periodic()) {
    low[period.axis] = period.low;
    high[period.axis] = period.high;
    cells_.periodic[period.axis] = true;
  }
  const Vector<dim> extent = high - low;
  for (int d = 0; d < dim; ++d) {
    cells_.extent[d] = std::max(1, static_cast<int>(std::floor(extent[d] / widest + 1e-9)));
    inverse_cell_[d] = cells_.extent[d] / extent[d];
  }
  cell_origin_ = low;
  // Disorder may have moved the outermost particles; nodes keep their places to walls and sides.
  for (const auto& wall : state_.images.walls())
    (wall.inward > 0 ? low : high)[wall.axis] = wall.place;
  const auto settle = [&](const OpenPlane<dim>& plane) {
    (plane.outward < 0 ? low : high)[plane.axis] = plane.place;
  };
  for (const auto& side : inflow_) settle(side.plane());
  for (const auto& side : pressure_sides_) settle(side.plane());
  if (!vacuum_ && numerics_.density_feedback > 0.0)
    filling_ = FillingGrid<dim>(low, high, particles.spacing);
}

template <int dim>
void Simulation<dim>::prescribe() {
  auto& particles = state_.particles;
  for (auto* effect : effects_.time_dependence) effect->set(state_);
  for (const auto& side : pressure_sides_) {
    side.copy_velocity(particles, state_.kernel);
    side.prescribe(particles, state_.clock.time, state_.balanced_acceleration);
  }
  for (const auto& side : inflow_)
    side.prescribe(particles.role, particles.position, particles.velocity, state_.clock.time);
}

template <int dim>
void Simulation<dim>::relax(int sweeps) {
  auto& particles = state_.particles;
  const double dx = particles.spacing, cap = 0.05 * dx;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const std::size_t n = particles.unknowns;
    displacement_.assign(n, Vector<dim>::Zero());
#pragma omp parallel for schedule(static)
    for (std::size_t i = particles.solids; i < n; ++i) {
      // 0.2 dx^2 is a step well inside the diffusive limit.
      const Vector<dim> sum = 0.2 * dx * dx * particles.volume * towards_emptier_side(state_, i);
      const double length = sum.norm();
      displacement_[i] = length > cap ? Vector<dim>(cap / length * sum) : sum;
    }
    for (std::size_t i = particles.solids; i < n; ++i) {
      particles.position[i] += displacement_[i];
      state_.images.wrap(particles.position[i]);
      state_.images.turn_back(particles.position[i]);
    }
    search();
  }
  correct_gradients();
}

template <int dim>
TimeStepChoice Simulation<dim>::time_step_limit() const {
  TimeStepChoice choice{numerics_.courant * state_.particles.spacing / velocity_scale_,
                        "CFL, courant x spacing / velocity scale"};
  FastestMode fastest;
  std::string_view name;
  for (const auto* limit : effects_.limits) {
    const double value = limit->largest_time_step(state_);
    if (value < choice.value) choice = {value, limit->limit_name()};
    const FastestMode mode = limit->fastest_mode(state_);
    if (!std::isfinite(stable_time_step(mode))) continue;
    name = name.empty() ? limit->limit_name() : "viscosity and springs";
    fastest.decay += mode.decay;
    fastest.frequency = std::hypot(fastest.frequency, mode.frequency);
  }
  const double value = kept_of_limit * stable_time_step(fastest);
  return value < choice.value ? TimeStepChoice{value, name} : choice;
}

template <int dim>
TimeStepChoice Simulation<dim>::chosen_time_step() const {
  if (fixed_time_step_ > 0.0) return {fixed_time_step_, "sph.time_step"};
  return time_step_limit();
}

template <int dim>
void Simulation<dim>::choose_time_step() {
  Clock& clock = state_.clock;
  clock.previous_time_step = clock.time_step;
  const double largest = step_factor_ * chosen_time_step().value;
  // Equal steps up to the next time at which someone looks: no sliver of a step before it.
  const double left = stop_at_ - clock.time;
  clock.time_step = std::isfinite(left) ? left / std::ceil(left / largest * (1.0 - 1e-9)) : largest;
}

template <int dim>
void Simulation<dim>::add_body_forces() {
  const Stopwatch watch(seconds_[std::size_t(Action::body_forces)]);
  acceleration_.assign(state_.particles.unknowns, Vector<dim>::Zero());
  for (const auto& force : effects_.body_forces) force->add_acceleration(state_, acceleration_);
}

template <int dim>
void Simulation<dim>::predict_velocity() {
  const Stopwatch watch(seconds_[std::size_t(Action::predictor)]);
  auto& particles = state_.particles;
  for (const auto& term : effects_.diffusion) term->add_acceleration(state_, acceleration_);
  particles.predicted_velocity = particles.velocity;
  const double dt = state_.clock.time_step;
  for (std::size_t i = 0; i < particles.unknowns; ++i)
    particles.predicted_velocity[i] += dt * acceleration_[i];
  for (const auto& side : inflow_) {
    side.prescribe(particles.role, particles.position, particles.predicted_velocity,
                   state_.clock.time + dt);
    side.meet_at_plane(particles, state_.clock.time + dt, state_.kernel);
  }
}

/// Eq. 3's sum, sum_j V (u_j - u_i) . grad W_ij, 1/s; with the corrected gradient where that is
/// chosen. `where`: of these particles only, 0 for the others; empty: of all.
template <int dim>
void Simulation<dim>::divergence(const std::vector<Vector<dim>>& velocity,
                                 std::vector<double>& result, std::span<const char> where) {
  const auto& particles = state_.particles;
  const auto& points = state_.images.points();
  state_.images.extend_for_divergence(velocity, state_.extended_velocity);
  const std::size_t n = particles.unknowns;
  result.resize(n);
  const bool corrected = !state_.gradient_correction.empty();
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    if (!where.empty() && !where[i]) {
      result[i] = 0.0;
      continue;
    }
    const auto near = state_.support.of(i);
    const Vector<dim> u = state_.extended_velocity[i], x = points[i];
    if (corrected) {
      const SymmetricMatrix<dim> correction = state_.gradient_correction[i];
      double sum = 0.0;
      for (std::size_t k = 0; k < near.index.size(); ++k) {
        const Vector<dim> r = x - points[near.index[k]];
        const Vector<dim> du = state_.extended_velocity[near.index[k]] - u;
        sum += near.gradient_factor[k] * correction.form(du, r);
      }
      result[i] = particles.volume * sum;
      continue;
    }
    double sum = 0.0;
    for (std::size_t k = 0; k < near.index.size(); ++k)
      sum += near.gradient_factor[k] *
             (state_.extended_velocity[near.index[k]] - u).dot(x - points[near.index[k]]);
    result[i] = particles.volume * sum;
  }
}

/// With the moment M_i = -sum_j V F_ij (x_i - x_j)(x_i - x_j)^T, which is 1 on an even
/// distribution:
///
/// L_i = M_i^-1 makes gradients of linear fields exact (Bonet & Lok 1999, Eq. 45).
///
/// A_i = (1 + s |M - T|^2 / dim) / T - s (M - T) with T = tr M / dim, s = (dim + 2) / (2 T^2) makes
/// the viscous sum exact for r^2 and, to first order in the unevenness, for any quadratic field:
/// the sum of V |F| r . A r is tr (A M) = dim. A factor a + e . D e on pairs of direction e, D
/// traceless, adds (2/(dim + 2)) D to an isotropic M: the mean of e_k^4 less that of e_k^2 e_l^2 is
/// 2/(dim (dim + 2)), over the mean 1/dim of e_k^2. Rows that slide past each other need this:
/// their sums of x^2 and y^2 differ by a few per cent.
///
/// Where neighbours lie too much on one side (a free surface) both stay 1.
template <int dim>
void Simulation<dim>::correct_gradients() {
  if (!numerics_.gradient_correction) return;
  const auto& particles = state_.particles;
  const auto& points = state_.images.points();
  const SymmetricMatrix<dim> one(Matrix<dim>::Identity());
  state_.gradient_correction.resize(particles.unknowns);
  state_.laplacian_correction.resize(particles.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < particles.unknowns; ++i) {
    const Vector<dim> x = points[i];
    SymmetricMatrix<dim, Two> outer;
    for_each_two<dim>(state_.support.of(i),
                      [&](Two f, const auto& j) { outer.add(f, difference(x, points, j)); });
    const Matrix<dim> moment = -particles.volume * sum_of(outer).full();
    constexpr double least_determinant = 0.2;  // of the whole lattice's 1
    if (moment.determinant() <= least_determinant) {
      state_.gradient_correction[i] = state_.laplacian_correction[i] = one;
      continue;
    }
    state_.gradient_correction[i] = SymmetricMatrix<dim>(moment.inverse());
    const double mean = moment.trace() / dim;
    const Matrix<dim> uneven = moment - mean * Matrix<dim>::Identity();
    const double strength = 0.5 * (dim + 2) / (mean * mean);
    state_.laplacian_correction[i] = SymmetricMatrix<dim>(
        (1.0 + strength * uneven.squaredNorm() / dim) / mean * Matrix<dim>::Identity() -
        strength * uneven);
  }
  // Prescribed particles have none of their own.
  std::fill(state_.laplacian_correction.begin() + particles.unknowns,
            state_.laplacian_correction.end(), one);
}

/// Eq. 3's sum for the predicted velocity, less the divergence that the new one is to have. A step
/// with velocity u makes of a volume det(1 + dt grad u), 1 + dt div u - dt^2/2 tr (grad u)^2 to
/// second order, where div u is itself of the order of dt: div u = dt/2 tr (grad u)^2 keeps it.
/// With div u = 0 fluid that turns at the rate W thins out at the rate W^2 dt.
template <int dim>
void Simulation<dim>::divergence_to_remove() {
  const auto& particles = state_.particles;
  if (!numerics_.volume_along_step) return divergence(particles.predicted_velocity, source_);
  // The gradient is the old velocity's: the predicted one has still to lose its divergence. One
  // sweep for both, since it is the lists that cost.
  const auto& points = state_.images.points();
  state_.images.extend_for_divergence(particles.predicted_velocity, state_.extended_velocity);
  state_.images.extend_for_divergence(particles.velocity, extended_before_);
  const double half_step = 0.5 * state_.clock.time_step;
  const bool corrected = !state_.gradient_correction.empty();
  const Matrix<dim> one = Matrix<dim>::Identity();
  const std::size_t n = particles.unknowns;
  source_.resize(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix<dim> correction = corrected ? state_.gradient_correction[i].full() : one;
    const Vector<dim> x = points[i], u = state_.extended_velocity[i], before = extended_before_[i];
    OuterProductSum<dim> outer, outer_before;
    for_each_two<dim>(state_.support.of(i), [&](Two f, const auto& j) {
      TwoVectors<dim> fr = difference(x, points, j);
      for (Two& component : fr) component *= f;
      outer.add(difference(u, state_.extended_velocity, j), fr);
      outer_before.add(difference(before, extended_before_, j), fr);
    });
    source_[i] = -particles.volume * outer.sum().cwiseProduct(correction).sum();
    if (i < particles.solids) continue;  // the springs decide how a body moves, after the pressure
    const Matrix<dim> gradient = particles.volume * outer_before.sum() * correction;
    source_[i] -= half_step * (gradient * gradient).trace();
  }
}

/// The first particle that the feedbacks act on: bodies whose cells keep their own area would be
/// constrained twice.
template <int dim>
std::size_t Simulation<dim>::first_fed_back() const {
  return numerics_.area_stiffness > 0.0 ? state_.particles.solids : 0;
}

/// The projection has no memory of volume, and what it leaves of the divergence would add up: Eq.
/// 3's source gets the rate at which the particles lack volume, as filling.hpp measures it.
template <int dim>
void Simulation<dim>::add_density_feedback() {
  const auto& particles = state_.particles;
  const double rate = numerics_.density_feedback * velocity_scale_ / particles.spacing;
  const std::size_t n = particles.unknowns;
  if (rate == 0.0) return;
  if (vacuum_) {
    const auto& partition = state_.support.partition();
    for (std::size_t i = 0; i < n; ++i)
      source_[i] += rate * (rest_partition_[i] / partition[i] - 1.0);
    return;
  }
  const auto& points = state_.images.points();
  const auto weights = state_.images.weights();
  point_volume_.assign(points.size(), particles.volume);
  for (std::size_t i = 0; i < weights.size(); ++i) point_volume_[i] *= weights[i];
  if (!solid_volume_.empty()) {
    const auto scale = [&](std::size_t i, std::size_t solid) {
      point_volume_[i] *= solid_volume_[solid] / particles.volume;
    };
    for (std::size_t i = 0; i < particles.solids; ++i) scale(i, i);
    for (std::size_t i = particles.size(); i < points.size(); ++i)
      if (const auto source =
              static_cast<std::size_t>(state_.images.source(static_cast<std::int32_t>(i)));
          source < particles.solids)
        scale(i, source);
  }
  lacking_.resize(n);
  filling_.lacking(points, point_volume_, lacking_);
  const std::size_t first = first_fed_back();
  // Where pressures alone drive the flow, a source against a wrong number changes the flow itself,
  // so its mean is weak there: the number then drifts by a few parts in a thousand instead.
  double mean = 0.0;
  if (inflow_.empty() && pressure_sides_.size() > 1)
    mean = 0.9 * std::accumulate(lacking_.begin() + first, lacking_.end(), 0.0) /
           static_cast<double>(n - first);
  for (std::size_t i = first; i < n; ++i) source_[i] += rate * (lacking_[i] - mean);
}

/// Disorder alone makes kernel sums differ by 0.7 to 0.9 % (standard deviation, vortices at h = 1.3
/// dx); what exceeds three of those is a void or a clump, such as opens behind a body that its
/// springs hold back from where the projection sent it.
template <int dim>
void Simulation<dim>::add_void_feedback() {
  const auto& particles = state_.particles;
  const std::size_t first = first_fed_back();
  const std::size_t n = particles.unknowns;
  if (numerics_.void_feedback == 0.0 || vacuum_ || first == n) return;
  // As fast as the flow is now: where it has come to rest between two pulses, correcting at the
  // rate of the fastest flow expected drives particles into each other beside the open sides.
  const double speed = std::min(velocity_scale_, fastest(particles));
  const double rate =
      std::min(numerics_.void_feedback * speed / particles.spacing, 1.0 / state_.clock.time_step);
  constexpr double disorder = 0.025;
  const auto& partition = state_.support.partition();
  double mean = 0.0;
  for (std::size_t i = first; i < n; ++i) mean += 1.0 / partition[i];
  mean = static_cast<double>(n - first) / mean;
  for (std::size_t i = first; i < n; ++i) {
    const double lacking = mean / partition[i] - 1.0;
    source_[i] += rate * (lacking - std::clamp(lacking, -disorder, disorder));
  }
}

/// The equation is solved for the difference from this: its tolerance is a part of the right side,
/// which the level of the prescribed pressures must not enter.
template <int dim>
double Simulation<dim>::mean_prescribed_pressure() const {
  const auto& particles = state_.particles;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = particles.unknowns; i < particles.size(); ++i)
    if (particles.role[i] == Role::outflow) {
      sum += particles.pseudo_pressure[i];
      ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

template <int dim>
void Simulation<dim>::solve_pressure() {
  auto& particles = state_.particles;
  const std::size_t n = particles.unknowns;
  double shift = 0.0;
  {
    const Stopwatch watch(seconds_[std::size_t(Action::pressure_assembly)]);
    guess_newcomers(particles, state_.support);
    shift = mean_prescribed_pressure();
    for (double& psi : particles.pseudo_pressure) psi -= shift;
    matrix_.assemble(particles, state_.images, state_.support, state_.kernel, pressure_planes_,
                     vacuum_ ? full_weight_ : 0.0);
    divergence_to_remove();
    add_density_feedback();
    add_void_feedback();
    for (std::size_t i = 0; i < n; ++i)
      source_[i] = source_[i] / state_.clock.time_step + matrix_.boundary_source()[i];
    if (matrix_.singular()) remove_mean(source_);
    cells_.assign<dim>({particles.position.data(), n}, cell_origin_, inverse_cell_);
    solver_->prepare(matrix_, cells_);
  }
  const Stopwatch watch(seconds_[std::size_t(Action::pressure_solve)]);
  const int projections = particles.solids > 0 && !vacuum_ ? numerics_.body_projections : 1;
  // What one solution leaves the next one takes back, so none need go as far as one alone.
  const double tolerance = projections > 1 ? std::min(0.1, 100.0 * numerics_.pressure_tolerance)
                                           : numerics_.pressure_tolerance;
  pressure_report_ = {};
  find_pressure(source_, {particles.pseudo_pressure.data(), n}, tolerance);
  if (projections > 1) find_surroundings_of_bodies();
  for (int k = 1; k < projections; ++k) project_what_is_left(tolerance);
  for (double& psi : particles.pseudo_pressure) psi += shift;
  if (matrix_.singular()) remove_mean({particles.pseudo_pressure.data(), n});
}

template <int dim>
void Simulation<dim>::find_pressure(std::span<const double> source,
                                    std::span<double> pseudo_pressure, double tolerance) {
  const SolveReport report = solver_->solve(matrix_, source, pseudo_pressure, tolerance);
  if (!report.converged || !std::isfinite(report.relative_residual))
    throw std::runtime_error("the pressure equation did not converge: relative residual " +
                             std::to_string(report.relative_residual) + " after " +
                             std::to_string(report.iterations) + " iterations");
  pressure_report_ = {pressure_report_.iterations + report.iterations, report.relative_residual,
                      true};
}

/// Eq. 3's Laplacian is not the divergence of Eq. 4's gradient, and of a velocity that changes
/// within the kernel's reach, one projection leaves a good part. It goes with the next steps: a
/// pressure that must answer to springs, which pull at the body and not at the fluid beside it,
/// does so some steps late, and the body moves as in a more viscous fluid. One step of iterative
/// refinement beside bodies: psi += A^-1 (b - D G psi). Fluid alone loses by it.
template <int dim>
void Simulation<dim>::project_what_is_left(double tolerance) {
  auto& particles = state_.particles;
  accelerate_by_pressure(reached_);
  // Velocities that are prescribed do not change.
  acceleration_.resize(particles.size(), Vector<dim>::Zero());
  divergence(acceleration_, left_, beside_);
  for (std::size_t i = 0; i < left_.size(); ++i)
    if (beside_[i]) left_[i] += source_[i] - matrix_.boundary_source()[i];
  if (matrix_.singular()) remove_mean(left_);
  pressure_change_.assign(left_.size(), 0.0);
  find_pressure(left_, pressure_change_, tolerance);
  for (std::size_t i = 0; i < left_.size(); ++i)
    particles.pseudo_pressure[i] += pressure_change_[i];
}

/// beside_: solid particles and those with a solid neighbour. reached_: these and their neighbours,
/// whose velocities the divergence there asks for.
template <int dim>
void Simulation<dim>::find_surroundings_of_bodies() {
  const auto& particles = state_.particles;
  beside_.assign(particles.unknowns, 0);
  for (std::size_t i = 0; i < particles.unknowns; ++i) {
    const auto near = state_.support.lower(i).index;
    beside_[i] = i < particles.solids || std::any_of(near.begin(), near.end(), [&](auto j) {
                   return static_cast<std::size_t>(j) < particles.solids;
                 });
  }
  reached_ = beside_;
  for (std::size_t i = 0; i < particles.unknowns; ++i)
    if (beside_[i])
      for (const std::int32_t j : state_.support.of(i).index)
        if (const auto s = static_cast<std::size_t>(state_.images.source(j));
            s < particles.unknowns)
          reached_[s] = 1;
}

/// acceleration_ becomes the gradient of psi; `where`: at these particles only, 0 elsewhere; empty:
/// at all.
template <int dim>
void Simulation<dim>::accelerate_by_pressure(std::span<const char> where) {
  const auto& particles = state_.particles;
  const auto& points = state_.images.points();
  const std::size_t n = particles.unknowns;
  acceleration_.resize(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    if (!where.empty() && !where[i]) {
      acceleration_[i].setZero();
      continue;
    }
    Vector<dim> sum = Vector<dim>::Zero();
    // In vacuum sum V (psi_i + psi_j) grad W, the negative adjoint of Eq. 3's divergence: forces
    // between two particles are opposite, and a section at a free surface carries the whole
    // pressure. On a full lattice the terms with psi_i add up to zero, so the sign means nothing.
    const double psi_i = vacuum_ ? -particles.pseudo_pressure[i] : particles.pseudo_pressure[i];
    const auto inner = state_.support.inner(i);
    for (std::size_t k = 0; k < inner.index.size(); ++k) {
      const std::int32_t j = inner.index[k];
      sum += inner.gradient_factor[k] * (psi_i - particles.pseudo_pressure[j]) *
             (points[i] - points[j]);
    }
    const auto outer = state_.support.outer(i);
    for (std::size_t k = 0; k < outer.index.size(); ++k) {
      const std::int32_t j = outer.index[k];
      const std::int32_t s = state_.images.source(j);
      if (particles.role[s] == Role::inflow) continue;  // dpsi/dn = 0 there, as in the matrix
      double difference = psi_i - particles.pseudo_pressure[s];
      if (particles.role[s] == Role::outflow)
        difference *= pressure_planes_.reach(points[i], points[j]);
      sum += outer.gradient_factor[k] * difference * (points[i] - points[j]);
    }
    if (!state_.gradient_correction.empty()) sum = state_.gradient_correction[i] * sum;
    acceleration_[i] = -particles.volume * sum;
  }
}

template <int dim>
void Simulation<dim>::correct_velocity() {
  const Stopwatch watch(seconds_[std::size_t(Action::corrector)]);
  auto& particles = state_.particles;
  const std::size_t n = particles.unknowns;
  const double dt = state_.clock.time_step;
  accelerate_by_pressure();
  // The old velocity is still wanted by the mean of ACTION 8, so it is kept in place of u*.
  for (std::size_t i = 0; i < n; ++i) {
    const Vector<dim> u_new = particles.predicted_velocity[i] + dt * acceleration_[i];
    particles.predicted_velocity[i] = particles.velocity[i];
    particles.velocity[i] = u_new;
  }
  for (std::size_t i = n; i < particles.size(); ++i)
    std::swap(particles.velocity[i], particles.predicted_velocity[i]);
  for (const auto& side : inflow_)
    side.prescribe(particles.role, particles.position, particles.velocity, state_.clock.time + dt);
  for (auto* constraint : effects_.constraints)
    constraint->constrain(state_, particles.predicted_velocity);
}

template <int dim>
double Simulation<dim>::remaining_divergence() {
  std::vector<double> result;
  divergence(state_.particles.velocity, result);
  return result.empty() ? 0.0 : std::sqrt(dot(result, result) / static_cast<double>(result.size()));
}

template <int dim>
void Simulation<dim>::move_particles() {
  const Stopwatch watch(seconds_[std::size_t(Action::motion)]);
  auto& particles = state_.particles;
  const double dt = state_.clock.time_step;
  const bool mean = numerics_.position_update == PositionUpdate::mean_velocity;
  displacement_.resize(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i)
    displacement_[i] =
        mean ? Vector<dim>(0.5 * dt * (particles.velocity[i] + particles.predicted_velocity[i]))
             : Vector<dim>(dt * particles.velocity[i]);
  for (const auto& side : pressure_sides_) side.keep_volume(particles, displacement_);
  for (const auto& motion : effects_.motion) motion->add_displacement(state_, displacement_);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.position[i] += displacement_[i];
    state_.images.wrap(particles.position[i]);
  }
  Clock& clock = state_.clock;
  clock.time += dt;
  if (std::abs(clock.time - stop_at_) < 1e-9 * dt) clock.time = stop_at_;
  ++clock.step;
}

template <int dim>
void Simulation<dim>::update_support_and_mirrors() {
  const Stopwatch watch(seconds_[std::size_t(Action::support)]);
  auto& particles = state_.particles;
  std::vector<bool> dropped;
  // The columns of an outflow are carried by copied velocities, which may lead one through the line
  // of a wall.
  for (std::size_t i = particles.unknowns; i < particles.size(); ++i)
    if (particles.role[i] == Role::outflow) state_.images.turn_back(particles.position[i]);
  for (const auto& side : inflow_) side.exchange(particles, state_.clock.time, books_);
  for (const auto& side : pressure_sides_) side.exchange(particles, books_);
  dropped.assign(particles.size(), false);
  for (std::size_t i = particles.solids; i < particles.size(); ++i)
    for (const auto& side : pressure_sides_)
      dropped[i] = dropped[i] || side.beyond(particles.position[i]);
  for (std::size_t i = particles.solids; i < particles.size(); ++i) {
    if (particles.role[i] == Role::fluid && state_.images.outside_a_wall(particles.position[i])) {
      dropped[i] = !state_.images.reflect(particles.position[i], particles.velocity[i],
                                          0.5 * particles.spacing);
      ++(dropped[i] ? books_.lost : books_.turned);
    }
    for (const auto& side : inflow_)
      if (particles.role[i] == Role::fluid && side.upstream(particles.position[i]) && !dropped[i]) {
        dropped[i] = true;
        ++books_.upstream;
      }
  }
  const bool sort = state_.clock.step % steps_between_sorts == 0;
  sort_by_role(particles, dropped, sort ? state_.kernel.support_radius() : 0.0);
  prescribe();
  build_support();
}

template <int dim>
void Simulation<dim>::build_support() {
  search();
  correct_gradients();
}

/// Images and neighbours at the particles' places.
template <int dim>
void Simulation<dim>::search() {
  auto& particles = state_.particles;
  state_.images.mirror(particles, state_.kernel.support_radius());
  state_.support.build(state_.kernel, state_.images.points(), particles.unknowns, particles.volume,
                       state_.images.weights());
}

template <int dim>
double Simulation<dim>::inflow_flux() const {
  double flux = 0.0;
  for (const auto& side : inflow_) flux += side.flux(state_.clock.time);
  return flux;
}

template <int dim>
void Simulation<dim>::save(Archive& archive) const {
  const auto& p = state_.particles;
  archive["position"] = flattened<dim>(p.position);
  archive["velocity"] = flattened<dim>(p.velocity);
  archive["predicted_velocity"] = flattened<dim>(p.predicted_velocity);
  archive["pseudo_pressure"] = p.pseudo_pressure;
  std::vector<std::int64_t> role(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) role[i] = static_cast<std::int64_t>(p.role[i]);
  archive["role"] = role;
  archive["identity"] = p.identity;
  for (const auto& array : p.carried)
    archive["carried/" + array.name] = flattened<dim>(*array.values);
  const Clock& c = state_.clock;
  archive["clock"] = std::vector<double>{c.time, c.time_step, c.previous_time_step, step_factor_};
  archive["counters"] = std::vector<std::int64_t>{c.step,
                                                  p.next_identity,
                                                  static_cast<std::int64_t>(p.solids),
                                                  static_cast<std::int64_t>(p.unknowns),
                                                  books_.entered,
                                                  books_.left,
                                                  books_.returned,
                                                  books_.upstream,
                                                  books_.lost,
                                                  books_.turned};
}

template <int dim>
void Simulation<dim>::restore(const Archive& archive) {
  auto& p = state_.particles;
  const auto read = [&](const std::string& name, std::vector<Vector<dim>>& values) {
    unflatten<dim>(std::get<std::vector<double>>(archive.at(name)), values);
  };
  read("position", p.position);
  read("velocity", p.velocity);
  read("predicted_velocity", p.predicted_velocity);
  p.pseudo_pressure = std::get<std::vector<double>>(archive.at("pseudo_pressure"));
  p.identity = std::get<std::vector<std::int64_t>>(archive.at("identity"));
  const auto& role = std::get<std::vector<std::int64_t>>(archive.at("role"));
  p.role.resize(role.size());
  for (std::size_t i = 0; i < role.size(); ++i) p.role[i] = static_cast<Role>(role[i]);
  for (auto& array : p.carried) read("carried/" + array.name, *array.values);
  const auto& clock = std::get<std::vector<double>>(archive.at("clock"));
  const auto& counters = std::get<std::vector<std::int64_t>>(archive.at("counters"));
  state_.clock = {clock[0], clock[1], clock[2], counters[0]};
  step_factor_ = clock[3];
  p.next_identity = counters[1];
  p.solids = static_cast<std::size_t>(counters[2]);
  p.unknowns = static_cast<std::size_t>(counters[3]);
  books_ = {counters[4], counters[5], counters[6], counters[7], counters[8], counters[9]};
  for (auto* effect : effects_.time_dependence) effect->set(state_);
  build_support();
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace sprung::sph
