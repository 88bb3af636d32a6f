#pragma once
/// Says before a run which effects the scene calls for and why, which limit sets the time step, and
/// what the run will cost.

#include "sph/scene_setup.hpp"

#include <string>

namespace sprung::sph {

/// The cost is measured: a few steps of the very scene are taken. Throws SceneError,
/// std::runtime_error.
template <int dim>
std::string explain(Document& document, const ModulusTable& table);

}  // namespace sprung::sph
