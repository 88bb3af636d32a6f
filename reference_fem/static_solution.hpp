#pragma once
/// Equilibrium of bodies without inertia, by the equations and elements of the coupled run: with c
/// = 1 s the "velocity" that the stage solves for is the displacement itself.

#include "reference_fem/fluid_structure.hpp"

namespace sprung::reference {

/// Nodal forces (N per metre of depth) of a uniform dead traction (Pa) on one side of the plane.
std::vector<double> traction_load(const Space& space, Side side, const Vec2& traction);

struct StaticSolution {
  Fields fields;
  int iterations = 0;
  double last_change = 0.0;  ///< m, largest entry of the last correction
};

/// Displacement and pressure under `load`, reached in `increments` equal parts, Newton's method
/// with line search to a correction below `tolerance` times the largest displacement. Throws
/// std::runtime_error if it does not converge, InvertedCell if a cell turns inside out.
StaticSolution solve_static(FluidStructure& system, const std::vector<double>& load,
                            int increments = 1, double tolerance = 1e-10);

}  // namespace sprung::reference
