#pragma once
/// Where a curved wall is: distance, normal and curvature at any place near it.

#include "sph/vector.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

namespace sprung::sph {

/// The wall seen from a place: the nearest point of it lies at x - distance normal.
template <int dim>
struct WallView {
  double distance = 0.0;  ///< m, positive on the fluid's side
  Vector<dim> normal;     ///< unit, into the fluid
  /// Sum and product of the principal curvatures (1/m, 1/m2) of the wall at the nearest point,
  /// positive where normals diverge (the outside of a cylinder). In the plane the product is 0.
  double curvature_sum = 0.0;
  double curvature_product = 0.0;
  /// div n at the place, 1/m: the sum of the curvatures of the parallel surface through it.
  double divergence_of_normals() const {
    const double d = distance;
    return (curvature_sum + 2.0 * curvature_product * d) /
           (1.0 + curvature_sum * d + curvature_product * d * d);
  }
  /// Volume of a small region mirrored in the wall over its own: parallel surfaces at distances d
  /// and -d have areas in the ratio prod(1 - k d) / prod(1 + k d). At least 0.
  double mirrored_volume() const {
    const double d = distance;
    const double outer = 1.0 + curvature_sum * d + curvature_product * d * d;
    const double inner = 1.0 - curvature_sum * d + curvature_product * d * d;
    return outer > 0.0 && inner > 0.0 ? inner / outer : 0.0;
  }
};

/// A piece of the wall.
template <int dim>
struct WallPatch {
  Vector<dim> centre;  ///< m
  Vector<dim> normal;  ///< unit, into the fluid
  double area = 0.0;   ///< m2; m in the plane
};

template <int dim>
class WallShape {
 public:
  virtual ~WallShape() = default;
  virtual WallView<dim> view(const Vector<dim>& x) const = 0;
  /// The same where the wall is closer than `reach` (m) on either side, else nothing.
  virtual std::optional<WallView<dim>> view_within(const Vector<dim>& x, double reach) const {
    const auto seen = view(x);
    if (std::abs(seen.distance) >= reach) return std::nullopt;
    return seen;
  }
  /// Smallest radius of curvature (m) of the wall in the box from `low` to `high`: the reach of the
  /// kernel must stay below it, or a mirror particle would fall past the centre. Infinity where the
  /// wall is flat.
  virtual double smallest_radius(const Vector<dim>& low, const Vector<dim>& high) const = 0;
  /// The wall in pieces no longer than about `size` (m). A cylinder has no end of its own and is
  /// not cut: empty.
  virtual std::vector<WallPatch<dim>> patches(double size) const = 0;
};

/// Throws std::runtime_error with the reason when a surface file cannot be used.
template <int dim>
std::unique_ptr<WallShape<dim>> wall_shape(const CurvedWall& wall);

}  // namespace sprung::sph
