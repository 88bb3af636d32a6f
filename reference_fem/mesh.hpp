#pragma once
/// The finite element mesh of a plane scene: quadrilaterals by Gmsh, conforming to every body, refined at
/// clamped corners, free corners and wetted faces, checked before anyone computes on it.

#include "scene/problem.hpp"

#include <deal.II/grid/tria.h>

namespace sprung::reference {

/// Target edge lengths (m). Sizes grow away from corners and faces by `growth` per metre of distance.
struct MeshSizes {
  double bulk = 0.0;            ///< far from every body
  double clamp_corner = 0.0;    ///< where a body's face meets the side that holds it
  double free_corner = 0.0;     ///< at a body's other corners
  double face = 0.0;            ///< along a body's faces
  double growth = 0.0;          ///< d(size)/d(distance)
  int splittings = 0;           ///< Gmsh makes cells 2^splittings larger, each then split so often into four
};

/// Material id of a cell: 0 is fluid, i + 1 is Problem::solids[i].
inline constexpr unsigned fluid_id = 0;

struct MeshQuality {
  double min_scaled_jacobian = 0.0;  ///< smallest sine-like corner quality, 1 for a square
  double min_size = 0.0;             ///< m, shortest edge
  double max_size = 0.0;             ///< m, longest edge
  int cells = 0;
  int solid_cells = 0;
};

/// Fills `mesh`; boundary ids are static_cast<unsigned>(Side). Throws SceneError-like std::runtime_error when
/// Gmsh fails or a cell is too distorted to compute on (scaled Jacobian below 0.1), saying where.
MeshQuality make_mesh(const Problem& problem, const MeshSizes& sizes, dealii::Triangulation<2>& mesh);

}  // namespace sprung::reference
