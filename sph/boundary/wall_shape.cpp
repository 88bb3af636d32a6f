#include "sph/boundary/wall_shape.hpp"

#include "sph/boundary/triangulated_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sprung::sph {

namespace {

/// A circle in the plane, a circular cylinder in space.
template <int dim>
class Round final : public WallShape<dim> {
 public:
  Round(const CurvedWall& wall)
      : centre_(as_vector<dim>(wall.centre)),
        radius_(wall.radius),
        axis_(wall.axis),
        inside_(wall.fluid_inside) {}
  WallView<dim> view(const Vector<dim>& x) const override {
    Vector<dim> r = x - centre_;
    if (dim == 3) r[axis_] = 0.0;
    const double length = r.norm();
    Vector<dim> outward = Vector<dim>::Zero();
    if (length > 0.0)
      outward = r / length;
    else
      outward[dim == 3 && axis_ == 0 ? 1 : 0] = 1.0;
    const double sign = inside_ ? -1.0 : 1.0;
    return {sign * (length - radius_), sign * outward, sign / radius_, 0.0};
  }
  double smallest_radius(const Vector<dim>&, const Vector<dim>&) const override { return radius_; }
  std::vector<WallPatch<dim>> patches(double size) const override {
    std::vector<WallPatch<dim>> result;
    if constexpr (dim == 2) {
      const double around = 2.0 * std::numbers::pi * radius_;
      const int count = std::max(16, static_cast<int>(std::ceil(around / size)));
      for (int k = 0; k < count; ++k) {
        const double angle = 2.0 * std::numbers::pi * (k + 0.5) / count;
        const Vector<2> outward(std::cos(angle), std::sin(angle));
        result.push_back(
            {centre_ + radius_ * outward, inside_ ? Vector<2>(-outward) : outward, around / count});
      }
    }
    return result;
  }

 private:
  Vector<dim> centre_;
  double radius_;
  int axis_;
  bool inside_;
};

/// A closed polygon in the plane.
class Polygon final : public WallShape<2> {
 public:
  explicit Polygon(const CurvedWall& wall) : inside_(wall.fluid_inside) {
    for (const Point& corner : wall.corners) corners_.push_back(as_vector<2>(corner));
  }
  WallView<2> view(const Vector<2>& x) const override {
    double best = std::numeric_limits<double>::infinity();
    Vector<2> nearest = corners_[0], edge_normal(1.0, 0.0);
    bool within = false;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Vector<2>& a = corners_[k];
      const Vector<2>& b = corners_[(k + 1) % corners_.size()];
      const Vector<2> ab = b - a;
      const double t = std::clamp((x - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      const Vector<2> p = a + t * ab;
      const double d2 = (x - p).squaredNorm();
      if (d2 < best) {
        best = d2;
        nearest = p;
        edge_normal = Vector<2>(ab[1], -ab[0]).normalized();
      }
      // Crossings of the ray to the right (Jordan).
      if ((a[1] > x[1]) != (b[1] > x[1]) &&
          x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
        within = !within;
    }
    const double length = std::sqrt(best);
    const double sign = within == inside_ ? 1.0 : -1.0;
    Vector<2> normal = length > 0.0 ? Vector<2>(sign * (x - nearest) / length) : edge_normal;
    return {sign * length, normal, 0.0, 0.0};
  }
  double smallest_radius(const Vector<2>&, const Vector<2>&) const override {
    return std::numeric_limits<double>::infinity();
  }
  std::vector<WallPatch<2>> patches(double size) const override {
    std::vector<WallPatch<2>> result;
    double twice_area = 0.0;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Vector<2>& a = corners_[k];
      const Vector<2>& b = corners_[(k + 1) % corners_.size()];
      twice_area += a[0] * b[1] - a[1] * b[0];
    }
    const double outward = (twice_area > 0.0) != inside_ ? 1.0 : -1.0;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Vector<2>& a = corners_[k];
      const Vector<2> edge = corners_[(k + 1) % corners_.size()] - a;
      const int count = static_cast<int>(std::ceil(edge.norm() / size));
      const Vector<2> normal = outward * Vector<2>(edge[1], -edge[0]).normalized();
      for (int n = 0; n < count; ++n)
        result.push_back({a + edge * ((n + 0.5) / count), normal, edge.norm() / count});
    }
    return result;
  }

 private:
  std::vector<Vector<2>> corners_;
  bool inside_;
};

class Surface final : public WallShape<3> {
 public:
  explicit Surface(const CurvedWall& wall)
      : surface_(TriangulatedSurface::read(wall.file)), inside_(wall.fluid_inside) {}
  WallView<3> view(const Vector<3>& x) const override {
    return seen_from(x, *surface_.nearest(x, std::numeric_limits<double>::infinity()));
  }
  std::optional<WallView<3>> view_within(const Vector<3>& x, double reach) const override {
    const auto near = surface_.nearest(x, reach);
    if (!near) return std::nullopt;
    return seen_from(x, *near);
  }
  double smallest_radius(const Vector<3>& low, const Vector<3>& high) const override {
    return surface_.smallest_radius(low, high);
  }
  /// The triangles as they are: a surface worth integrating over is fine enough.
  std::vector<WallPatch<3>> patches(double) const override {
    std::vector<WallPatch<3>> result;
    for (std::size_t t = 0; t < surface_.triangles(); ++t) {
      const auto [centre, area] = surface_.triangle(t);
      const Vector<3> normal = area.normalized();
      result.push_back({centre, inside_ ? Vector<3>(-normal) : normal, area.norm()});
    }
    return result;
  }

 private:
  WallView<3> seen_from(const Vector<3>& x, const TriangulatedSurface::Nearest& near) const {
    const double sign = inside_ ? -1.0 : 1.0;
    const Vector<3> r = x - near.point;
    const double length = r.norm();
    // Outside where the smooth normal says so; the facets' own planes would flip it at an edge.
    const double side = r.dot(near.normal) >= 0.0 ? 1.0 : -1.0;
    const Vector<3> outward =
        length > 1e-12 * surface_.size() ? Vector<3>(side * r / length) : near.normal;
    return {sign * side * length, sign * outward, sign * near.curvature_sum,
            near.curvature_product};
  }
  TriangulatedSurface surface_;
  bool inside_;
};

}  // namespace

template <>
std::unique_ptr<WallShape<2>> wall_shape<2>(const CurvedWall& wall) {
  if (wall.shape == CurvedWall::Shape::polygon) return std::make_unique<Polygon>(wall);
  return std::make_unique<Round<2>>(wall);
}

template <>
std::unique_ptr<WallShape<3>> wall_shape<3>(const CurvedWall& wall) {
  if (wall.shape == CurvedWall::Shape::surface) return std::make_unique<Surface>(wall);
  return std::make_unique<Round<3>>(wall);
}

}  // namespace sprung::sph
