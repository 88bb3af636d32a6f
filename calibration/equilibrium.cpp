#include "calibration/equilibrium.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace sprung::calibration {

template <int dim>
double find_equilibrium(sph::ElasticNetwork<dim> network, sph::Particles<dim>& particles,
                        const std::vector<sph::Vector<dim>>& load, double tolerance,
                        const std::function<void(std::vector<sph::Vector<dim>>&)>& keep) {
  using sph::Vector;
  const std::size_t n = network.movable;
  const double mass = particles.mass();
  // Inertia is what is left beside the tangent stiffness: next to none for a clamped body, for a
  // free one enough to hold it in place.
  const bool clamped = network.reference.size() > n;
  const double time_step = (clamped ? 1e7 : 3e4) / sph::highest_frequency(network, mass);
  sph::State<dim> state{particles,
                        sph::Images<dim>({}),
                        {},
                        sph::Kernel<dim>(particles.spacing),
                        {0.0, time_step, 0.0, 0}};
  sph::ElasticSolid<dim> solid(network, particles, sph::SpringIntegration::implicit_force);
  double largest_load = 0.0;
  for (const auto& f : load) largest_load = std::max(largest_load, f.norm());
  const std::vector<Vector<dim>> at_rest(n, Vector<dim>::Zero());
  std::vector<Vector<dim>> force, acceleration(n);
  double unbalanced = 0.0, before = 0.0;
  // Where bonds push, their part of the tangent is left out and convergence is linear.
  constexpr int most = 300;
  for (int iteration = 0; iteration < most; ++iteration) {
    sph::elastic_forces<dim>(network, {state.particles.position.data(), n}, force);
    before = unbalanced;
    unbalanced = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      unbalanced = std::max(unbalanced, (force[i] + load[i]).norm() / largest_load);
    // Stiff area springs turn the rounding of positions into forces: what no step reduces any more
    // is that.
    const bool rounding = iteration > 2 && unbalanced < 1e3 * tolerance && unbalanced >= before;
    if (unbalanced < tolerance || rounding) {
      particles.position = state.particles.position;
      return unbalanced;
    }
    std::fill(acceleration.begin(), acceleration.end(), Vector<dim>::Zero());
    std::fill(state.particles.velocity.begin(), state.particles.velocity.end(),
              Vector<dim>::Zero());
    solid.add_acceleration(state, acceleration);
    for (std::size_t i = 0; i < n; ++i)
      state.particles.velocity[i] = time_step * (acceleration[i] + load[i] / mass);
    solid.constrain(state, at_rest);
    // velocity = dt (M + g dt^2 K)^-1 (F + f), so dx = g dt velocity with the solver's g = 1/2.
    for (std::size_t i = 0; i < n; ++i)
      state.particles.position[i] += 0.5 * time_step * state.particles.velocity[i];
    if (keep) keep(state.particles.position);
  }
  throw std::runtime_error(fmt::format(
      "no static equilibrium: unbalanced force {:.3g} of the load after {} Newton steps; "
      "the load is too large for the springs",
      unbalanced, most));
}

template double find_equilibrium<2>(sph::ElasticNetwork<2>, sph::Particles<2>&,
                                    const std::vector<sph::Vector<2>>&, double,
                                    const std::function<void(std::vector<sph::Vector<2>>&)>&);
template double find_equilibrium<3>(sph::ElasticNetwork<3>, sph::Particles<3>&,
                                    const std::vector<sph::Vector<3>>&, double,
                                    const std::function<void(std::vector<sph::Vector<3>>&)>&);

}  // namespace sprung::calibration
