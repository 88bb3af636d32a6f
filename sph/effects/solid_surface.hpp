#pragma once
/// Where the surface of a body lies between its outer particles and the fluid: half a spacing
/// outside the outer row's centres on a lattice that the body fills, less where the body cuts a
/// cell.

#include "sph/effects/elastic_network.hpp"
#include "sph/effects/roles.hpp"

#include <algorithm>

namespace sprung::sph {

/// For each fluid particle near a body, the outward normal of the body's surface and the distance
/// to it.
template <int dim>
class SolidSurface {
 public:
  /// `bodies`: the shapes at rest, one per body, with the range of their particles.
  struct Body {
    Solid shape;
    std::size_t first, last;
  };
  SolidSurface(const std::vector<Body>& bodies, const Particles<dim>& particles);

  /// Finds normals and distances for the present positions.
  void update(const State<dim>& state);

  /// How many times farther a solid particle at `solid` lies from fluid particle `fluid`, along the
  /// normal, than the surface does: (x_f - x_s) . n / d. The velocity that varies linearly from the
  /// fluid particle's to the body's at the surface differs by this factor more from the fluid's at
  /// the solid particle's place than the body's own velocity does (Morris, Fox & Zhu 1997 for fixed
  /// walls). At least 1, at most 5.
  double reach(std::size_t fluid, const Vector<dim>& from_solid) const {
    return std::clamp(from_solid.dot(normal_[fluid]) / distance_[fluid], 1.0, 5.0);
  }

 private:
  using Rotation = Eigen::Matrix<double, dim, dim>;
  /// Distances from a solid particle to the faces of its body at rest, along the body's own axes
  /// there.
  struct Depth {
    std::array<double, 2 * dim> to_face;  ///< order of Side
    Rotation own_axes;                    ///< as columns
  };
  Rotation rotation_of(std::size_t solid, const std::vector<Vector<dim>>& position) const;
  double depth_along(std::size_t solid, const Vector<dim>& rest_normal) const;

  std::vector<Depth> depth_;
  std::vector<Vector<dim>> reference_;
  std::vector<std::vector<std::int32_t>> near_at_rest_;
  std::vector<Rotation> rotation_;
  std::vector<Vector<dim>> normal_;
  std::vector<double> distance_;
};

}  // namespace sprung::sph
