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

  /// (y + z) z / 2, m2, of a fluid particle y above the surface and a solid one z below: by this
  /// times u_nn, a velocity's second derivative along the normal, a parabola lies beyond the
  /// straight line of reach().
  double bend(std::size_t fluid, const Vector<dim>& from_solid) const {
    const double apart = from_solid.dot(normal_[fluid]);
    return 0.5 * apart * std::max(apart - distance_[fluid], 0.0);
  }

  using Matrix = Eigen::Matrix<double, dim, dim>;

  /// From a solid particle to the surface, along the normal at a fluid particle, turned to rest, m.
  Vector<dim> arm(std::size_t fluid, std::size_t solid) const;

  /// The fluid pulls at the surface, but its pairs pull at solid particles as deep as the kernel
  /// reaches. `moment`: of each solid particle, the sum of force times arm. Finds what these forces
  /// do more at the surface than at their particles, as forces on each particle and its neighbours
  /// at rest, whose sum is zero: by virtual work, with a displacement that is linear there.
  void carry_out(const std::vector<Matrix>& moment, std::vector<Vector<dim>>& force) const;

 private:
  using Rotation = Matrix;
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
  /// Of each of these neighbours: the gradient at rest is the sum of (u_t - u_s) gradient_of^T,
  /// 1/m.
  std::vector<std::vector<Vector<dim>>> gradient_of_;
  std::vector<Rotation> rotation_;
  std::vector<Vector<dim>> normal_;
  std::vector<double> distance_;
};

}  // namespace sprung::sph
