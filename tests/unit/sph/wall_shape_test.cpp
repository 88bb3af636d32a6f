/// Distance, normal and curvature of walls of any shape, against closed forms.

#include "sph/boundary/wall_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sprung::sph {
namespace {

constexpr double pi = std::numbers::pi;

CurvedWall circle(bool fluid_inside) {
  CurvedWall wall;
  wall.shape = CurvedWall::Shape::circle;
  wall.centre = {1.0, 2.0, 0.0};
  wall.radius = 0.5;
  wall.fluid_inside = fluid_inside;
  return wall;
}

CurvedWall polygon(std::vector<Point> corners, bool fluid_inside) {
  CurvedWall wall;
  wall.shape = CurvedWall::Shape::polygon;
  wall.corners = std::move(corners);
  wall.fluid_inside = fluid_inside;
  return wall;
}

/// The nearest point of the wall, as a view has it.
template <int dim>
Vector<dim> foot(const WallView<dim>& view, const Vector<dim>& x) {
  return x - view.distance * view.normal;
}

TEST(WallShape, CircleFromOutsideAndInside) {
  const auto outside = wall_shape<2>(circle(false)), inside = wall_shape<2>(circle(true));
  EXPECT_EQ(outside->smallest_radius({0.0, 0.0}, {1.0, 1.0}), 0.5);
  const Vector<2> x(1.6, 2.8);  // (0.6, 0.8) from the centre: distance 1 along a 3-4-5 triangle
  auto view = outside->view(x);
  EXPECT_NEAR(view.distance, 0.5, 1e-15);
  EXPECT_NEAR((view.normal - Vector<2>(0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(view.curvature_sum, 2.0, 1e-15);
  EXPECT_EQ(view.curvature_product, 0.0);
  EXPECT_NEAR((foot(view, x) - Vector<2>(1.3, 2.4)).norm(), 0.0, 1e-15);
  view = inside->view(x);
  EXPECT_NEAR(view.distance, -0.5, 1e-15);
  EXPECT_NEAR((view.normal + Vector<2>(0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(view.curvature_sum, -2.0, 1e-15);
  EXPECT_NEAR((foot(view, x) - Vector<2>(1.3, 2.4)).norm(), 0.0, 1e-15);
  // The centre has no direction of its own, but a distance.
  view = inside->view({1.0, 2.0});
  EXPECT_EQ(view.distance, 0.5);
  EXPECT_EQ(view.normal.norm(), 1.0);
}

// A ring at distance d outside a circle mirrors to one inside: areas as (R - d) to (R + d).
TEST(WallShape, MirroredVolumeOfACircle) {
  const auto outside = wall_shape<2>(circle(false)), inside = wall_shape<2>(circle(true));
  for (const double d : {0.0, 0.01, 0.1, 0.3}) {
    EXPECT_NEAR(outside->view({1.5 + d, 2.0}).mirrored_volume(), (0.5 - d) / (0.5 + d), 1e-14);
    EXPECT_NEAR(inside->view({1.5 - d, 2.0}).mirrored_volume(), (0.5 + d) / (0.5 - d), 1e-13);
  }
  // Past the centre there is no mirror.
  EXPECT_EQ(outside->view({2.0, 2.0}).mirrored_volume(), 0.0);
  EXPECT_EQ(outside->view({2.5, 2.0}).mirrored_volume(), 0.0);
}

TEST(WallShape, SeenOnlyFromWithinTheReach) {
  const auto outside = wall_shape<2>(circle(false));
  EXPECT_FALSE(outside->view_within({1.7, 2.0}, 0.19));
  EXPECT_FALSE(outside->view_within({1.3, 2.0}, 0.19));
  EXPECT_NEAR(outside->view_within({1.7, 2.0}, 0.21)->distance, 0.2, 1e-15);
  EXPECT_NEAR(outside->view_within({1.3, 2.0}, 0.21)->distance, -0.2, 1e-15);
}

TEST(WallShape, CylinderIsACircleAcrossItsAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    CurvedWall wall;
    wall.shape = CurvedWall::Shape::cylinder;
    wall.axis = axis;
    wall.radius = 0.5;
    wall.centre = {1.0, 2.0, 3.0};
    wall.centre[axis] = 0.0;
    const auto shape = wall_shape<3>(wall);
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    Vector<3> x(1.0, 2.0, 3.0), normal = Vector<3>::Zero();
    x[axis] = -17.0;
    x[a] += 0.6;
    x[b] += 0.8;
    normal[a] = 0.6;
    normal[b] = 0.8;
    const auto view = shape->view(x);
    EXPECT_NEAR(view.distance, 0.5, 1e-14);
    EXPECT_NEAR((view.normal - normal).norm(), 0.0, 1e-14);
    EXPECT_NEAR(view.curvature_sum, 2.0, 1e-15);
    EXPECT_EQ(view.curvature_product, 0.0);
    Vector<3> on_axis(1.0, 2.0, 3.0);
    const auto middle = shape->view(on_axis);
    EXPECT_EQ(middle.distance, -0.5);
    EXPECT_EQ(middle.normal[axis], 0.0);
    EXPECT_TRUE(shape->patches(0.1).empty());
  }
}

TEST(WallShape, SphereMirrorsVolumesAsSquares) {
  // Both curvatures 1/R: (R - d)^2 to (R + d)^2.
  const double R = 0.5, d = 0.1;
  const WallView<3> view{d, Vector<3>::UnitX(), 2.0 / R, 1.0 / (R * R)};
  EXPECT_NEAR(view.mirrored_volume(), std::pow((R - d) / (R + d), 2), 1e-15);
}

// An L: the square of side 2 without its upper right quarter. Convex corners but one, at (1, 1).
const std::vector<Point> ell{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

struct Place {
  Vector<2> x;
  double distance;  ///< of the fluid inside the L
  Vector<2> normal;
};

std::vector<Place> places_around_the_ell() {
  const double root = std::sqrt(2.0);
  return {
      {{0.5, 0.1}, 0.1, {0, 1}},                           // above the lower edge
      {{1.5, 0.6}, 0.4, {0, -1}},                          // below the step
      {{0.5, -0.1}, -0.1, {0, 1}},                         // outside
      {{1.5, 1.3}, -0.3, {0, -1}},                         // in the notch, nearer the step
      {{1.2, 1.7}, -0.2, {-1, 0}},                         // in the notch, nearer the riser
      {{2.3, -0.4}, -0.5, Vector<2>(-0.6, 0.8)},           // off the convex corner (2, 0)
      {{0.9, 0.9}, 0.1 * root, Vector<2>(-1, -1) / root},  // inside, at the concave corner
      {{-1.0, 3.0}, -root, Vector<2>(1, -1) / root},       // off the convex corner (0, 2)
      {{0.4, 1.7}, 0.3, {0, -1}},                          // below the top
  };
}

TEST(WallShape, PolygonFromBothSidesAndBothWaysRound) {
  auto reversed = ell;
  std::reverse(reversed.begin(), reversed.end());
  for (const auto& corners : {ell, reversed}) {
    const auto inside = wall_shape<2>(polygon(corners, true));
    const auto outside = wall_shape<2>(polygon(corners, false));
    for (const Place& place : places_around_the_ell()) {
      auto view = inside->view(place.x);
      EXPECT_NEAR(view.distance, place.distance, 1e-15) << place.x.transpose();
      EXPECT_NEAR((view.normal - place.normal).norm(), 0.0, 1e-14) << place.x.transpose();
      EXPECT_EQ(view.mirrored_volume(), 1.0);
      view = outside->view(place.x);
      EXPECT_NEAR(view.distance, -place.distance, 1e-15) << place.x.transpose();
      EXPECT_NEAR((view.normal + place.normal).norm(), 0.0, 1e-14) << place.x.transpose();
    }
    EXPECT_TRUE(std::isinf(inside->smallest_radius({0.0, 0.0}, {1.0, 1.0})));
  }
}

TEST(WallShape, APlaceOnThePolygonHasAUnitNormal) {
  const auto view = wall_shape<2>(polygon(ell, true))->view({0.5, 0.0});
  EXPECT_EQ(view.distance, 0.0);
  EXPECT_EQ(std::abs(view.normal[1]), 1.0);
}

/// Over a closed curve the normals add up to zero, and Gauss: the integral of x . n is twice the
/// enclosed area, positive for normals out of it.
void expect_closed(const WallShape<2>& shape, double perimeter, double twice_area, double size) {
  double length = 0.0, flux = 0.0;
  Vector<2> sum = Vector<2>::Zero();
  for (const auto& patch : shape.patches(size)) {
    EXPECT_LE(patch.area, size * (1.0 + 1e-12));
    EXPECT_NEAR(patch.normal.norm(), 1.0, 1e-14);
    EXPECT_NEAR(shape.view(patch.centre).distance, 0.0, 1e-14);
    length += patch.area;
    sum += patch.area * patch.normal;
    flux += patch.area * patch.centre.dot(patch.normal);
  }
  EXPECT_NEAR(length, perimeter, 1e-12);
  EXPECT_NEAR(sum.norm(), 0.0, 1e-13);
  EXPECT_NEAR(flux, twice_area, 1e-12);
}

TEST(WallShape, PatchesCoverTheWallAndFaceTheFluid) {
  expect_closed(*wall_shape<2>(circle(false)), pi, 2.0 * pi * 0.25, 0.03);
  expect_closed(*wall_shape<2>(circle(true)), pi, -2.0 * pi * 0.25, 0.03);
  auto reversed = ell;
  std::reverse(reversed.begin(), reversed.end());
  for (const auto& corners : {ell, reversed}) {
    expect_closed(*wall_shape<2>(polygon(corners, false)), 8.0, 6.0, 0.07);
    expect_closed(*wall_shape<2>(polygon(corners, true)), 8.0, -6.0, 0.07);
  }
}

}  // namespace
}  // namespace sprung::sph
