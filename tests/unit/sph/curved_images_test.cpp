/// Images in walls of any shape, and the pressure matrix that folds them.

#include "sph/pressure/matrix.hpp"
#include "tests/unit/sph/dense_matrix.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <cmath>
#include <numbers>

namespace sprung::sph {
namespace {

template <int dim>
ShapedWall<dim> round_wall(double radius, bool fluid_inside, bool no_slip) {
  CurvedWall wall;
  wall.shape = dim == 2 ? CurvedWall::Shape::circle : CurvedWall::Shape::cylinder;
  wall.axis = 2;
  wall.radius = radius;
  wall.fluid_inside = fluid_inside;
  return {wall_shape<dim>(wall), no_slip};
}

TEST(CurvedImages, StandOnTheRayAcrossTheCircle) {
  // At 0.1 outside a circle of radius 0.5, along (3, 4)/5; at 0.05; beyond the reach; inside it.
  const auto particles =
      test::particles_at<2>({{0.36, 0.48}, {0.0, -0.55}, {2.0, 0.0}, {0.3, 0.2}}, 0.1);
  Images<2> images({}, {}, {round_wall<2>(0.5, false, true)});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_NEAR((images.points()[4] - Vector<2>(0.24, 0.32)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((images.points()[5] - Vector<2>(0.0, -0.45)).norm(), 0.0, 1e-15);
  EXPECT_EQ(images.source(4), 0);
  EXPECT_EQ(images.source(5), 1);
  ASSERT_EQ(images.weights().size(), 6u);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(images.weights()[i], 1.0);
  EXPECT_NEAR(images.weights()[4], 0.4 / 0.6, 1e-15);  // (R - d)/(R + d)
  EXPECT_NEAR(images.weights()[5], 0.45 / 0.55, 1e-15);
  EXPECT_FALSE(images.by_shaped_wall(3));
  EXPECT_TRUE(images.by_shaped_wall(4));
  EXPECT_TRUE(images.outside_a_wall(particles.position[3]));
  EXPECT_FALSE(images.outside_a_wall(particles.position[0]));
}

TEST(CurvedImages, InsideACircleTheWeightIsTheInverse) {
  const auto particles = test::particles_at<2>({{0.24, 0.32}}, 0.1);
  Images<2> images({}, {}, {round_wall<2>(0.5, true, true)});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_NEAR((images.points()[1] - Vector<2>(0.36, 0.48)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(images.weights()[1], 0.6 / 0.4, 1e-14);
}

TEST(CurvedImages, CylinderKeepsThePlaceAlongItsAxis) {
  const auto particles = test::particles_at<3>({{0.24, 0.32, 7.25}}, 0.1);
  Images<3> images({}, {}, {round_wall<3>(0.5, true, false)});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 1u);
  EXPECT_NEAR((images.points()[1] - Vector<3>(0.36, 0.48, 7.25)).norm(), 0.0, 1e-14);
  EXPECT_NEAR(images.weights()[1], 0.6 / 0.4, 1e-14);
}

// The mirrored ring of a whole neighbourhood has the area that the weights say: with particles on a
// fine polar grid in d = 0..0.2 outside the circle, images fill the ring 0.3..0.5 inside it.
TEST(CurvedImages, WeightsAddUpToTheMirroredArea) {
  std::vector<Vector<2>> points;
  std::vector<double> area;
  constexpr int rings = 400;
  for (int k = 0; k < rings; ++k) {
    const double r = 0.5 + 0.2 * (k + 0.5) / rings;
    points.emplace_back(r, 0.0);
    area.push_back(2.0 * std::numbers::pi * r * 0.2 / rings);
  }
  const auto particles = test::particles_at<2>(points, 0.1);
  Images<2> images({}, {}, {round_wall<2>(0.5, false, true)});
  images.mirror(particles, 0.3);
  ASSERT_EQ(images.size(), points.size());
  double sum = 0.0;
  for (std::size_t m = 0; m < points.size(); ++m)
    sum += area[images.source(static_cast<std::int32_t>(points.size() + m))] *
           images.weights()[points.size() + m];
  // Both integrands are linear in r, so the midpoint rule is exact.
  EXPECT_NEAR(sum, std::numbers::pi * (0.25 - 0.09), 1e-13);
}

TEST(CurvedImages, NoSlipTurnsTheVelocityRoundAndFreeSlipItsNormalPart) {
  const auto particles = test::particles_at<2>({{0.36, 0.48}}, 0.1);
  const Vector<2> normal(0.6, 0.8), along(-0.8, 0.6);
  const std::vector<Vector<2>> velocity{2.0 * normal + 3.0 * along};
  const Vector<2> reflected = -2.0 * normal + 3.0 * along;
  std::vector<Vector<2>> extended;
  for (const bool no_slip : {true, false}) {
    Images<2> images({}, {}, {round_wall<2>(0.5, false, no_slip)});
    images.mirror(particles, 0.2);
    images.extend_for_viscosity(velocity, extended);
    EXPECT_NEAR((extended[1] - (no_slip ? Vector<2>(-velocity[0]) : reflected)).norm(), 0.0, 1e-14);
    images.extend_for_divergence(velocity, extended);
    EXPECT_NEAR((extended[1] - reflected).norm(), 0.0, 1e-14);
  }
}

// Inside a pipe of radius R the flow R^2 - r^2, Laplacian -4, is 2 R y - y^2 at a distance y from
// the wall, and goes on across it. Outside a cylinder log(1 + s), s = y / R, has no Laplacian; what
// it becomes is off by 2 s^3 - 10/3 s^4 + ... (by series), where the plain mirror is off by s^2.
TEST(CurvedImages, WithTheLaplacianAProfileGoesOnAcrossANoSlipWall) {
  const double radius = 0.5;
  for (const double y : {0.02, 0.05, 0.1, 0.15}) {
    const auto inside = test::particles_at<3>({{radius - y, 0.0, 0.3}}, 0.1);
    Images<3> pipe({}, {}, {round_wall<3>(radius, true, true)});
    pipe.mirror(inside, 0.2);
    std::vector<Vector<3>> extended;
    pipe.extend_for_viscosity({{0.0, 0.0, 2.0 * radius * y - y * y}}, {{0.0, 0.0, -2.0}}, 2.0,
                              extended);
    EXPECT_NEAR(extended[1][2], -2.0 * radius * y - y * y, 1e-15);

    const auto outside = test::particles_at<2>({{radius + y, 0.0}}, 0.1);
    Images<2> cylinder({}, {}, {round_wall<2>(radius, false, true)});
    cylinder.mirror(outside, 0.2);
    std::vector<Vector<2>> beyond;
    const double s = y / radius;
    cylinder.extend_for_viscosity({{0.0, std::log1p(s)}}, {{0.0, 0.0}}, 1.0, beyond);
    EXPECT_NEAR(beyond[1][1], std::log1p(-s), 2.0 * s * s * s);
  }
}

TEST(CurvedImages, APlaceOutsideIsTurnedBack) {
  Images<2> images({}, {}, {round_wall<2>(0.5, true, true)});
  images.mirror(test::particles_at<2>({{0.0, 0.0}}, 0.1), 0.2);  // tells the reach
  Vector<2> x(0.36, 0.48);                                       // 0.1 outside
  images.turn_back(x);
  EXPECT_NEAR((x - Vector<2>(0.24, 0.32)).norm(), 0.0, 1e-15);
  const Vector<2> kept = x;
  images.turn_back(x);
  EXPECT_EQ(x, kept);
}

TEST(CurvedImages, AreCopiedAcrossAPeriodicSideWithTheirWeight) {
  const auto particles = test::particles_at<3>({{0.24, 0.32, 0.05}}, 0.1);
  Images<3> images({}, {{2, 0.0, 1.0}}, {round_wall<3>(0.5, true, true)});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 3u);  // the mirror, and both one period on
  int mirrors = 0;
  for (std::int32_t m = 1; m < 4; ++m) {
    const bool mirror = std::abs(images.points()[m].head<2>().norm() - 0.6) < 1e-12;
    mirrors += mirror;
    EXPECT_EQ(images.by_shaped_wall(m), mirror);
    EXPECT_NEAR(images.weights()[m], mirror ? 1.5 : 1.0, 1e-14);
    EXPECT_EQ(images.source(m), 0);
  }
  EXPECT_EQ(mirrors, 2);
}

/// Disordered particles on the fluid's side of a round wall, at least 0.25 dx from it.
template <int dim>
Particles<dim> beside_the_wall(const ShapedWall<dim>& wall, const std::array<int, dim>& count,
                               double dx, const Vector<dim>& origin) {
  std::vector<Vector<dim>> points;
  for (auto x : test::lattice<dim>(count, dx, 0.2, 21)) {
    x += origin;
    if (wall.shape->view(x).distance > 0.25 * dx) points.push_back(x);
  }
  return test::particles_at<dim>(points, dx);
}

/// opposite() of (i, mirror of j): the distance between j and the mirror of i, which is found by
/// going through all images again; both have the wall's own period or flat mirror on them.
template <int dim>
void expect_opposite_pairs(const Particles<dim>& particles, const Images<dim>& images,
                           const ShapedWall<dim>& wall, double reach) {
  const auto n = static_cast<std::int32_t>(particles.size());
  int pairs = 0;
  for (std::int32_t i = 0; i < n; i += 7)
    for (std::size_t m = n; m < images.points().size(); ++m) {
      const auto index = static_cast<std::int32_t>(m);
      if (!images.by_shaped_wall(index)) continue;
      const std::int32_t j = images.source(index);
      if ((images.points()[m] - particles.position[i]).norm() >= reach) continue;
      const auto view = wall.shape->view(particles.position[i]);
      const auto found = images.opposite(i, index);
      if (view.distance >= reach) {
        EXPECT_LT(found.distance, 0.0);
        continue;
      }
      EXPECT_NEAR(found.weight, view.mirrored_volume(), 1e-14);
      // Among the images of i that j sees, one lies as far from j.
      double nearest = 1e300;
      for (std::size_t other = n; other < images.points().size(); ++other) {
        const auto o = static_cast<std::int32_t>(other);
        if (images.by_shaped_wall(o) && images.source(o) == i)
          nearest = std::min(
              nearest,
              std::abs((images.points()[other] - particles.position[j]).norm() - found.distance));
      }
      if (found.distance < reach) {
        EXPECT_NEAR(nearest, 0.0, 1e-13) << i << ' ' << j;
        ++pairs;
      }
    }
  EXPECT_GT(pairs, 20);
}

/// Symmetric, rows that sum to zero, off-diagonal entries <= 0, and images that matter.
template <int dim>
void expect_sound_matrix(const Particles<dim>& particles, Images<dim> images,
                         const ShapedWall<dim>& wall) {
  const Kernel<dim> kernel(1.3 * particles.spacing);
  images.mirror(particles, kernel.support_radius());
  expect_opposite_pairs(particles, images, wall, kernel.support_radius());
  Support<dim> support;
  support.build(kernel, images.points(), particles.unknowns, particles.volume, images.weights());
  PressureMatrix matrix;
  matrix.assemble(particles, images, support, kernel);
  EXPECT_TRUE(matrix.singular());
  const Eigen::MatrixXd a = test::dense(matrix);
  const double size = a.diagonal().maxCoeff();
  // Distances of a pair are found on either side of the wall: round-off of the entries.
  EXPECT_LT((a - a.transpose()).cwiseAbs().maxCoeff(), 1e-12 * size);
  EXPECT_LT(a.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12 * size);
  Eigen::MatrixXd off = a;
  off.diagonal().setZero();
  EXPECT_LE(off.maxCoeff(), 0.0);
  // Without images the rows beside the wall would be lighter by a third and more.
  Images<dim> none(images.walls(), images.periodic());
  none.mirror(particles, kernel.support_radius());
  PressureMatrix bare;
  Support<dim> short_support;
  short_support.build(kernel, none.points(), particles.unknowns, particles.volume);
  bare.assemble(particles, none, short_support, kernel);
  EXPECT_GT((a - test::dense(bare)).cwiseAbs().maxCoeff(), 0.05 * size);
}

TEST(PressureMatrixWithCurvedWalls, IsSymmetricWithRowsThatSumToZero) {
  const double dx = 0.1;
  {
    const auto wall = round_wall<2>(0.5, false, true);
    const auto particles = beside_the_wall<2>(wall, {20, 20}, dx, {-1.0, -1.0});
    // The circle in a box of walls that it touches nowhere.
    std::vector<Wall<2>> walls{{0, -1.0, 1, true, Vector<2>::Zero()},
                               {0, 1.0, -1, true, Vector<2>::Zero()},
                               {1, -1.0, 1, true, Vector<2>::Zero()},
                               {1, 1.0, -1, true, Vector<2>::Zero()}};
    expect_sound_matrix<2>(particles, Images<2>(walls, {}, {wall}), wall);
  }
  {
    const auto wall = round_wall<2>(0.8, true, true);
    const auto particles = beside_the_wall<2>(wall, {18, 18}, dx, {-0.9, -0.9});
    expect_sound_matrix<2>(particles, Images<2>({}, {}, {wall}), wall);
  }
  {
    // A pipe along z, periodic; and one closed by flat walls.
    const auto wall = round_wall<3>(0.4, true, true);
    const auto particles = beside_the_wall<3>(wall, {9, 9, 6}, dx, {-0.45, -0.45, 0.0});
    expect_sound_matrix<3>(particles, Images<3>({}, {{2, 0.0, 0.6}}, {wall}), wall);
    const std::vector<Wall<3>> ends{{2, 0.0, 1, true, Vector<3>::Zero()},
                                    {2, 0.6, -1, true, Vector<3>::Zero()}};
    expect_sound_matrix<3>(particles, Images<3>(ends, {}, {wall}), wall);
  }
}

}  // namespace
}  // namespace sprung::sph
