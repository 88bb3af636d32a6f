#pragma once
/// Quadrilaterals by Gmsh where a scene's curved walls leave no room for blocks: any circles and
/// polygons, holes in the fluid or its outer wall, and bodies between them.

#include "reference_fem/mesh.hpp"

#include <deal.II/base/point.h>

#include <vector>

namespace sprung::reference {

/// Meshes the scene in the Gmsh model that is open, and returns the surfaces by material id. Cells
/// have `face` at curved walls and at bodies, `clamp_corner` and `free_corner` at a body's corners,
/// and grow to `bulk` with the distance; a circle is cut into sixteen at least. Throws
/// std::runtime_error if the walls leave no fluid.
std::vector<std::vector<int>> build_unstructured(const Problem& problem, const MeshSizes& sizes);

/// Position in Problem::curved_walls of the wall that both points lie on; -1 if there is none.
int wall_through(const Problem& problem, const dealii::Point<2>& a, const dealii::Point<2>& b);

}  // namespace sprung::reference
