#pragma once
/// The table [reference_fem] of a scene: discretisation, time stepping and the solid's law.

#include "reference_fem/mesh.hpp"
#include "reference_fem/time_integration.hpp"
#include "scene/document.hpp"

namespace sprung::reference {

struct Settings {
  MeshSizes sizes;
  int degree = 2;
  double time_step = 0.0;  ///< s
  double largest_time_step =
      0.0;  ///< s; steps grow up to it while their error stays below the tolerance
  double step_tolerance = 0.0;  ///< error of one step, relative to body size and largest speed
  TimeScheme scheme;
  TimeScheme starter;  ///< for the steps after a kink, when there is no slope to start from
  double poisson_ratio = 0.0;
  double solid_density = 0.0;  ///< kg/m3
  MaterialLaw law = MaterialLaw::neo_hookean;
  NewtonSettings newton;
  double mesh_stiffening = 0.0;
  double checkpoint_every = 0.0;  ///< s
};

/// Reads the table with its defaults and checks that `problem` is one this solver knows: plane,
/// viscous, with an open side. Throws SceneError. Leaves [sph] and [numerics], the particle
/// solver's, unread.
Settings read_settings(Document& document, const Problem& problem);

/// The scheme of that name ("tr_bdf2", "esdirk3", "backward_euler") and the one that starts it.
TimeScheme scheme_named(const std::string& name);
TimeScheme starter_of(const TimeScheme& scheme);

}  // namespace sprung::reference
