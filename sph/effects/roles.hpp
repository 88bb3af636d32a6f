#pragma once
/// What an effect may do. Each role is one function; an effect's class head shows which it plays. A
/// virtual call wraps a sweep over the particles; it never stands inside one.

#include "sph/boundary/images.hpp"
#include "sph/neighbours.hpp"
#include "sph/symmetric_form.hpp"

#include <cmath>
#include <limits>
#include <string_view>

namespace sprung::sph {

struct Clock {
  double time = 0.0;                ///< s
  double time_step = 0.0;           ///< of the step under way, s
  double previous_time_step = 0.0;  ///< 0 before the first step
  std::int64_t step = 0;
};

/// What an effect may look at.
template <int dim>
struct State {
  Particles<dim> particles;
  Images<dim> images;
  Support<dim> support;
  Kernel<dim> kernel;
  Clock clock;
  /// The part of a uniform force per mass that pressure alone balances, m/s2. It never enters the
  /// motion: pseudo_pressure is psi + a . x, and only what shows or prescribes a pressure uses it.
  Vector<dim> balanced_acceleration = Vector<dim>::Zero();
  /// The rest of a uniform force per mass, which drives the flow, in the last step, m/s2.
  Vector<dim> driving_acceleration = Vector<dim>::Zero();
  /// L_i, to be applied to a particle's sums over V F r; empty without gradient correction.
  std::vector<SymmetricMatrix<dim>> gradient_correction = {};
  /// A_i: a pair's term of the viscous sum counts e . (A_i + A_j)/2 e, e along the pair; empty
  /// without gradient correction. See Simulation::correct_gradients.
  std::vector<SymmetricMatrix<dim>> laplacian_correction = {};
  /// Scratch of one sweep at a time: velocities of particles and images, m/s.
  mutable std::vector<Vector<dim>> extended_velocity = {};
  /// p in Pa of particle i.
  double pressure(std::size_t i) const {
    return particles.density *
           (balanced_acceleration.dot(particles.position[i]) - particles.pseudo_pressure[i]);
  }
};

/// Adds to the acceleration (m/s2) of the particles that have an equation.
template <int dim>
class Acceleration {
 public:
  virtual ~Acceleration() = default;
  virtual void add_acceleration(const State<dim>& state,
                                std::vector<Vector<dim>>& acceleration) = 0;
};

/// Sets what depends on time alone (the speed of a wall, a uniform force).
template <int dim>
class TimeDependence {
 public:
  virtual ~TimeDependence() = default;
  /// Called at the start and whenever the clock has moved.
  virtual void set(State<dim>& state) = 0;
};

/// The fastest of what the step advances explicitly.
struct FastestMode {
  double decay = 0.0;      ///< 1/s, of diffusion by Adams-Bashforth
  double frequency = 0.0;  ///< rad/s, of springs moved with the new velocity
};

/// Largest step (s) that holds both, infinite without either. A mode that both act on turns its
/// sign from step to step, the first to become unstable, when r dt + (w dt / 2)^2 = 1: put z = -1
/// into u' = u - r dt (3/2 u - 1/2 u_before) - w^2 dt x, x' = x + dt u'.
inline double stable_time_step(const FastestMode& mode) {
  return 2.0 / (mode.decay + std::hypot(mode.decay, mode.frequency));
}

/// Part of its stable range that a step which sets itself keeps to.
constexpr double kept_of_limit = 0.8;

/// Bounds the time step.
template <int dim>
class TimeStepLimit {
 public:
  virtual ~TimeStepLimit() = default;
  /// Adds up with what the other effects say, for a mode of both is faster than that of either.
  virtual FastestMode fastest_mode(const State<dim>&) const { return {}; }
  /// A bound (s) of any other kind.
  virtual double largest_time_step(const State<dim>&) const {
    return std::numeric_limits<double>::infinity();
  }
  /// What sets the bound, in words that outlive the effect.
  virtual std::string_view limit_name() const = 0;
};

/// Moves particles beside their own velocity (shifting), or prescribes their motion.
template <int dim>
class Motion {
 public:
  virtual ~Motion() = default;
  /// Called with old positions and new velocities, before the particles move. Adds to
  /// `displacement` (m, one per particle with an equation) and may correct the velocity for the new
  /// place.
  virtual void add_displacement(State<dim>& state, std::vector<Vector<dim>>& displacement) = 0;
};

/// Has the last word on the velocity of the particles that it owns, after the corrector (ACTION 7).
template <int dim>
class Constraint {
 public:
  virtual ~Constraint() = default;
  /// `old_velocity`: before the step. May change state.particles.velocity.
  virtual void constrain(State<dim>& state, const std::vector<Vector<dim>>& old_velocity) = 0;
};

}  // namespace sprung::sph
