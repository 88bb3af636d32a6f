#pragma once
/// Watches a run: when a value leaves its sound range the run stops and says what, where, when and
/// what to change. Costs one pass over the particles.

#include "sph/scene_setup.hpp"

#include <optional>
#include <string>

namespace sprung::sph {

/// A message when the state is not sound: a value that is not a number, a speed beyond ten times
/// the velocity scale, a spring stretched or shortened past a factor two, a crowd of lost
/// particles.
template <int dim>
std::optional<std::string> find_fault(const ParticleScene<dim>& scene);

}  // namespace sprung::sph
