#pragma once
/// The geometry of Turek and Hron, "Proposal for numerical benchmarking of fluid-structure
/// interaction between an elastic object and laminar incompressible flow" (2006): channel 2.5 x
/// 0.41 m, cylinder of radius 0.05 m at (0.2, 0.2), flag 0.35 x 0.02 m behind it.

#include "reference_fem/mesh.hpp"

namespace sprung::reference::testing {

enum class Flag { elastic, rigid, alone };

/// Blocks around cylinder and flag, every cell split `splittings` times with the circle kept round.
/// A rigid flag is a hole like the cylinder; alone, it is the whole plane.
void make_turek_hron_mesh(Flag flag, int splittings, dealii::Triangulation<2>& mesh);

}  // namespace sprung::reference::testing
