#pragma once
/// Blocks of quadrilaterals around a round cylinder in a channel, with or without a flag behind it:
/// the geometry of Schaefer and Turek (1996) and of Turek and Hron (2006). Better cells than an
/// unstructured mesh would have, and nested when split, the circle staying round.

#include "reference_fem/mesh.hpp"

#include <array>
#include <optional>

namespace sprung::reference {

/// What `cylinder_in_channel` found in a scene; lengths in m.
struct CylinderBlocks {
  std::array<double, 2> from{}, to{};  ///< of the channel
  std::array<double, 2> centre{};
  double radius = 0.0;
  double half_square = 0.0;  ///< of the square of blocks around the cylinder
  bool has_flag = false;
  double half_flag = 0.0;  ///< half the flag's thickness; it starts on the circle
  double flag_end = 0.0;   ///< x of its free end
  enum class Flag { none, elastic, rigid, alone } flag = Flag::none;
  unsigned cylinder_id = 0, flag_id = 0;  ///< boundary ids of the rims
};

/// The scene as such blocks, if it is one: a plane channel with one circle, fluid outside, and
/// behind it at most one flag: a body, or a rigid polygon with four corners, along x and as high
/// above the circle's centre as below. `bodies_only` leaves the fluid out.
std::optional<CylinderBlocks> cylinder_in_channel(const Problem& problem, bool bodies_only);

/// Fills `mesh`; cells have the sizes `sizes` asks for: `bulk` in the channel before the
/// cylinder, `face` at cylinder and flag; the rest follows in fixed proportion.
void make_cylinder_mesh(const CylinderBlocks& blocks, const MeshSizes& sizes,
                        dealii::Triangulation<2>& mesh);

}  // namespace sprung::reference
