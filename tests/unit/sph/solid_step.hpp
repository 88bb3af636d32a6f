#pragma once
/// The time step of a body without a fluid.

#include "sph/effects/elastic_solid.hpp"

namespace sprung::sph::test {

/// ACTIONs 4 to 8 for a solid alone under a `load` (N) on each node, with the new-velocity update.
inline void step_solid(ElasticSolid<2>& solid, State<2>& state, double dt,
                       const std::vector<Vector<2>>& load, bool implicit) {
  auto& particles = state.particles;
  state.clock.time_step = dt;
  std::vector<Vector<2>> acceleration(particles.size(), Vector<2>::Zero());
  solid.add_acceleration(state, acceleration);
  const auto old = particles.velocity;
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.velocity[i] += dt * (acceleration[i] + load[i] / particles.mass());
  if (implicit) solid.constrain(state, old);
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.position[i] += dt * particles.velocity[i];
  ++state.clock.step;
}

}  // namespace sprung::sph::test
