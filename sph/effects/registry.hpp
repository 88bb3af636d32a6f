#pragma once
/// The only table of effects.

#include "sph/scene_setup.hpp"

namespace sprung::sph {

/// Creates the effects that the scene names, and only those.
template <int dim>
void add_effects(ParticleScene<dim>& scene, const ModulusTable& table);

}  // namespace sprung::sph
