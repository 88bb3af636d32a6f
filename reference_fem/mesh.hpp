#pragma once
/// The finite element mesh of a plane scene: quadrilaterals by Gmsh, conforming to every body and
/// wall, graded towards clamped and free corners, checked before anyone computes on it. They stand
/// in blocks where the scene allows that (bodies along the axes; one cylinder with at most one
/// flag, cylinder_mesh.hpp), unstructured otherwise (unstructured_mesh.hpp). Meshes that differ
/// only in their splittings are nested, which is what extrapolation needs.

#include "scene/problem.hpp"

#include <deal.II/grid/tria.h>

namespace sprung::reference {

/// Target edge lengths (m). Cells grow from the lines of the bodies' faces outward, neighbour by
/// neighbour, until they reach `face` along and across a body, `bulk` elsewhere.
struct MeshSizes {
  double bulk = 0.0;
  double clamp_corner = 0.0;  ///< where a body's face meets the side that holds it
  double free_corner = 0.0;   ///< at a body's other corners, where the flow separates
  double face = 0.0;
  double growth = 0.0;  ///< ratio of neighbours in Gmsh's mesh
  int splittings = 0;  ///< Gmsh makes cells 2^splittings larger, each then split so often into four
  bool bodies_only = false;   ///< leave the fluid out
  bool unstructured = false;  ///< no blocks, even where they fit
  double wall = 0.0;          ///< at the channel's no-slip sides; 0: as anywhere else
};

/// Material id of a cell: 0 is fluid, i + 1 is Problem::solids[i].
inline constexpr unsigned fluid_id = 0;
/// Boundary ids below it are Sides; this is the free face of a body without fluid around it.
inline constexpr unsigned free_id = 6;
/// obstacle_id + i is Problem::curved_walls[i]: the rim of a rigid obstacle, no-slip, to which a
/// body that touches it is fixed.
inline constexpr unsigned obstacle_id = 7;
inline constexpr unsigned most_obstacles = 24;

struct MeshQuality {
  double min_scaled_jacobian = 0.0;  ///< smallest sine-like corner quality, 1 for a square
  double min_size = 0.0;             ///< m, shortest edge
  double max_size = 0.0;             ///< m, longest edge
  int cells = 0;
  int solid_cells = 0;
};

bool is_no_slip(const Problem& problem, Side side);

/// Fills `mesh`; boundary ids are static_cast<unsigned>(Side). Throws std::runtime_error when
/// Gmsh fails or a cell is too distorted to compute on (scaled Jacobian below 0.1), saying where.
MeshQuality make_mesh(const Problem& problem, const MeshSizes& sizes,
                      dealii::Triangulation<2>& mesh);

}  // namespace sprung::reference
