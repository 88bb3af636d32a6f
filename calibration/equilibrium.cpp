#include "calibration/equilibrium.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace sprung::calibration {

namespace {

/// Steps of Newton's method towards rest under dead forces.
template <int dim>
class StaticSystem {
 public:
  StaticSystem(const sph::ElasticNetwork<dim>& network, const sph::Particles<dim>& particles)
      : time_step_((network.reference.size() > network.movable ? 1e7 : 3e4) /
                   sph::highest_frequency(network, particles.density)),
        state_{particles,
               sph::Images<dim>({}),
               {},
               sph::Kernel<dim>(particles.spacing),
               {0.0, time_step_, 0.0, 0}},
        solid_(network, state_.particles, sph::SpringIntegration::implicit_force),
        at_rest_(network.movable, sph::Vector<dim>::Zero()),
        acceleration_(network.movable) {}

  std::vector<sph::Vector<dim>>& position() { return state_.particles.position; }

  /// Displacement (K + m/(g dt^2))^-1 (F + load), K the tangent at the present positions. Inertia
  /// is what is left beside K: next to none for a clamped body, for a free one enough to hold it.
  std::vector<sph::Vector<dim>> step(const std::vector<sph::Vector<dim>>& load) {
    const std::size_t n = at_rest_.size();
    auto& velocity = state_.particles.velocity;
    std::fill(acceleration_.begin(), acceleration_.end(), sph::Vector<dim>::Zero());
    std::fill(velocity.begin(), velocity.end(), sph::Vector<dim>::Zero());
    solid_.add_acceleration(state_, acceleration_);
    for (std::size_t i = 0; i < n; ++i)
      velocity[i] = time_step_ * (acceleration_[i] + load[i] / solid_.mass(i));
    solid_.constrain(state_, at_rest_);
    // velocity = dt (M + g dt^2 K)^-1 (F + f), so dx = g dt velocity with the solver's g = 1/2.
    std::vector<sph::Vector<dim>> displacement(n);
    for (std::size_t i = 0; i < n; ++i) displacement[i] = 0.5 * time_step_ * velocity[i];
    return displacement;
  }

 private:
  double time_step_;
  sph::State<dim> state_;
  sph::ElasticSolid<dim> solid_;
  std::vector<sph::Vector<dim>> at_rest_, acceleration_;
};

}  // namespace

template <int dim>
double find_equilibrium(sph::ElasticNetwork<dim> network, sph::Particles<dim>& particles,
                        const std::vector<sph::Vector<dim>>& load, double tolerance,
                        const std::function<void(std::vector<sph::Vector<dim>>&)>& keep) {
  const std::size_t n = network.movable;
  StaticSystem<dim> system(network, particles);
  double largest_load = 0.0;
  for (const auto& f : load) largest_load = std::max(largest_load, f.norm());
  std::vector<sph::Vector<dim>> force;
  double unbalanced = 0.0, before = 0.0;
  // Where bonds push, their part of the tangent is left out and convergence is linear.
  constexpr int most = 300;
  for (int iteration = 0; iteration < most; ++iteration) {
    sph::elastic_forces<dim>(network, {system.position().data(), n}, force);
    before = unbalanced;
    unbalanced = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      unbalanced = std::max(unbalanced, (force[i] + load[i]).norm() / largest_load);
    // Stiff area springs turn the rounding of positions into forces: what no step reduces any more
    // is that.
    const bool rounding = iteration > 2 && unbalanced < 1e3 * tolerance && unbalanced >= before;
    if (unbalanced < tolerance || rounding) {
      particles.position = system.position();
      return unbalanced;
    }
    const auto displacement = system.step(load);
    for (std::size_t i = 0; i < n; ++i) system.position()[i] += displacement[i];
    if (keep) keep(system.position());
  }
  throw std::runtime_error(fmt::format(
      "no static equilibrium: unbalanced force {:.3g} of the load after {} Newton steps; "
      "the load is too large for the springs",
      unbalanced, most));
}

template <int dim>
std::vector<sph::Vector<dim>> linear_response(const sph::ElasticNetwork<dim>& network,
                                              const sph::Particles<dim>& particles,
                                              const std::vector<sph::Vector<dim>>& load) {
  return StaticSystem<dim>(network, particles).step(load);
}

template std::vector<sph::Vector<2>> linear_response<2>(const sph::ElasticNetwork<2>&,
                                                        const sph::Particles<2>&,
                                                        const std::vector<sph::Vector<2>>&);
template double find_equilibrium<2>(sph::ElasticNetwork<2>, sph::Particles<2>&,
                                    const std::vector<sph::Vector<2>>&, double,
                                    const std::function<void(std::vector<sph::Vector<2>>&)>&);
template double find_equilibrium<3>(sph::ElasticNetwork<3>, sph::Particles<3>&,
                                    const std::vector<sph::Vector<3>>&, double,
                                    const std::function<void(std::vector<sph::Vector<3>>&)>&);

}  // namespace sprung::calibration
