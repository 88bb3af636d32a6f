#include "sph/boundary/images.hpp"

#include "sph/neighbours.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <set>

namespace sprung::sph {
namespace {

Wall<2> bottom(bool no_slip, Vector<2> velocity = Vector<2>::Zero()) {
  return {1, 0.0, 1, no_slip, velocity};
}

Particles<2> two_particles() {
  // One inside the reach of a wall at y = 0, one beyond it.
  return test::particles_at<2>({{0.4, 0.03}, {0.6, 0.30}}, 0.1);
}

TEST(Images, AreMirroredAlongTheNormalWithinReach) {
  const auto particles = two_particles();
  Images<2> images({bottom(true)});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 1u);
  ASSERT_EQ(images.points().size(), 3u);
  EXPECT_EQ(images.points()[0], particles.position[0]);
  EXPECT_EQ(images.points()[1], particles.position[1]);
  EXPECT_EQ(images.points()[2], Vector<2>(0.4, -0.03));
  EXPECT_EQ(images.source(2), 0);
  EXPECT_EQ(images.source(1), 1);
}

TEST(Images, NoneForAParticleOutsideTheWall) {
  const auto particles = test::particles_at<2>({{0.4, -0.03}, {0.4, 0.03}}, 0.1);
  Images<2> images({bottom(true)});
  images.mirror(particles, 0.2);
  EXPECT_EQ(images.size(), 1u);
  EXPECT_TRUE(images.outside_a_wall(particles.position[0]));
  EXPECT_FALSE(images.outside_a_wall(particles.position[1]));
}

// Particle and image change roles: place and normal velocity are the mirror image's.
TEST(Images, ReflectsWhatHasCrossedAWallByLittle) {
  Images<2> images({bottom(true), {0, 1.0, -1, false}});
  Vector<2> x(0.4, -0.03), u(0.5, -0.2);
  EXPECT_TRUE(images.reflect(x, u, 0.05));
  EXPECT_EQ(x, Vector<2>(0.4, 0.03));
  EXPECT_EQ(u, Vector<2>(0.5, 0.2));
  // In a corner, across both walls at once.
  x = {1.02, -0.03};
  u = {0.5, -0.2};
  EXPECT_TRUE(images.reflect(x, u, 0.05));
  EXPECT_DOUBLE_EQ(x[0], 0.98);
  EXPECT_DOUBLE_EQ(x[1], 0.03);
  EXPECT_EQ(u, Vector<2>(-0.5, 0.2));
  // Farther out than a step may carry it.
  x = {0.4, -0.06};
  EXPECT_FALSE(images.reflect(x, u, 0.05));
}

TEST(Images, NoSlipTurnsTheVelocityRound) {
  const auto particles = two_particles();
  Images<2> images({bottom(true)});
  images.mirror(particles, 0.2);
  const std::vector<Vector<2>> velocity{{0.7, -0.2}, {5.0, 5.0}};
  std::vector<Vector<2>> extended;
  images.extend_for_viscosity(velocity, extended);
  ASSERT_EQ(extended.size(), 3u);
  EXPECT_EQ(extended[0], velocity[0]);
  EXPECT_EQ(extended[1], velocity[1]);
  EXPECT_EQ(extended[2], Vector<2>(-0.7, 0.2));  // mean with its source: zero, the wall's
}

TEST(Images, MovingWallIsMetHalfWay) {
  const auto particles = two_particles();
  const Vector<2> lid(1.5, 0.0);
  Images<2> images({bottom(true, lid)});
  images.mirror(particles, 0.2);
  const std::vector<Vector<2>> velocity{{0.7, -0.2}, {5.0, 5.0}};
  std::vector<Vector<2>> extended;
  images.extend_for_viscosity(velocity, extended);
  EXPECT_NEAR((0.5 * (extended[0] + extended[2]) - lid).norm(), 0.0, 1e-15);
}

// u = w + a y + b y^2 / 2 above a wall that moves with w goes on below it, Laplacian b known.
TEST(Images, WithTheLaplacianAParabolaGoesOnAcrossANoSlipWall) {
  const auto particles = two_particles();
  const Vector<2> wall(1.5, 0.0), a(3.0, 0.0), b(-8.0, 40.0);
  const auto profile = [&](double y) -> Vector<2> { return wall + y * a + 0.5 * y * y * b; };
  Images<2> images({bottom(true, wall)});
  images.mirror(particles, 0.2);
  std::vector<Vector<2>> extended;
  const std::vector<Vector<2>> velocity{profile(0.03), {5.0, 5.0}}, field{-0.5 * b, -0.5 * b};
  images.extend_for_viscosity(velocity, field, -2.0, extended);
  EXPECT_NEAR((extended[2] - profile(-0.03)).norm(), 0.0, 1e-15);
  EXPECT_EQ(extended[0], velocity[0]);
  Images<2> free({bottom(false)});
  free.mirror(particles, 0.2);
  free.extend_for_viscosity(velocity, field, -2.0, extended);
  EXPECT_EQ(extended[2], Vector<2>(velocity[0][0], -velocity[0][1]));
}

TEST(Images, FreeSlipTurnsTheNormalPartOnly) {
  const auto particles = two_particles();
  Images<2> images({bottom(false)});
  images.mirror(particles, 0.2);
  std::vector<Vector<2>> extended;
  images.extend_for_viscosity({{0.7, -0.2}, {5.0, 5.0}}, extended);
  EXPECT_EQ(extended[2], Vector<2>(0.7, 0.2));
}

TEST(Images, DivergenceSeesTheNormalPartTurnedRoundAtEitherWall) {
  const auto particles = two_particles();
  for (const bool no_slip : {true, false}) {
    Images<2> images({bottom(no_slip)});
    images.mirror(particles, 0.2);
    std::vector<Vector<2>> extended;
    images.extend_for_divergence({{0.7, -0.2}, {5.0, 5.0}}, extended);
    EXPECT_EQ(extended[2], Vector<2>(0.7, 0.2));
  }
}

TEST(Images, CornerIsMirroredTwice) {
  const auto particles = test::particles_at<2>({{0.02, 0.03}}, 0.1);
  Images<2> images({{0, 0.0, 1, true, {0.0, 0.25}}, bottom(false)});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 3u);
  const std::vector<Vector<2>> places(images.points().begin() + 1, images.points().end());
  EXPECT_EQ(places[0], Vector<2>(-0.02, 0.03));
  EXPECT_EQ(places[1], Vector<2>(0.02, -0.03));
  EXPECT_EQ(places[2], Vector<2>(-0.02, -0.03));
  for (int m = 1; m < 4; ++m) EXPECT_EQ(images.source(m), 0);
  std::vector<Vector<2>> extended;
  // No slip on the left (wall velocity 0.25 along y), free slip below, one after the other.
  images.extend_for_viscosity({{0.7, -0.2}}, extended);
  EXPECT_NEAR((extended[1] - Vector<2>(-0.7, 0.7)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((extended[2] - Vector<2>(0.7, 0.2)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((extended[3] - Vector<2>(-0.7, -0.7)).norm(), 0.0, 1e-15);
  images.extend_for_divergence({{0.7, -0.2}}, extended);
  EXPECT_EQ(extended[1], Vector<2>(-0.7, -0.2));
  EXPECT_EQ(extended[2], Vector<2>(0.7, 0.2));
  EXPECT_EQ(extended[3], Vector<2>(-0.7, 0.2));
}

TEST(Images, CornerOfThreeWallsHasSeven) {
  const auto particles = test::particles_at<3>({{0.02, 0.03, 0.01}}, 0.1);
  Images<3> images(test::walls_of_box<3>({1.0, 1.0, 1.0}, true));
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 7u);
  std::set<std::array<double, 3>> places;
  for (std::size_t m = 1; m < 8; ++m) {
    const auto& x = images.points()[m];
    places.insert({x[0], x[1], x[2]});
    EXPECT_NEAR(x.norm(), particles.position[0].norm(), 1e-16);
  }
  EXPECT_EQ(places.size(), 7u);
}

TEST(Images, ContinueTheLatticeBeyondTheWalls) {
  // Walls half a spacing outside the outer rows: particles and images together fill 8 x 7 cells.
  const auto particles = test::particles_at<2>(test::lattice<2>({4, 3}, 0.25), 0.25);
  Images<2> images(test::walls_of_box<2>({1.0, 0.75}, true));
  images.mirror(particles, 0.5);
  EXPECT_EQ(images.points().size(), 8u * 7u);
  std::set<std::pair<long, long>> sites;
  for (const auto& x : images.points())
    sites.insert({std::lround(x[0] / 0.25 - 0.5), std::lround(x[1] / 0.25 - 0.5)});
  EXPECT_EQ(sites.size(), 8u * 7u);
}

// --- periodic sides
// ---------------------------------------------------------------------------------

std::set<std::pair<long, long>> in_hundredths(const std::vector<Vector<2>>& points) {
  std::set<std::pair<long, long>> places;
  for (const auto& x : points)
    places.insert({std::lround(100.0 * x[0]), std::lround(100.0 * x[1])});
  return places;
}

TEST(PeriodicImages, StandBeyondTheOtherSide) {
  // Near the low side, near the high one, in the middle.
  const auto particles = test::particles_at<2>({{0.05, 0.5}, {0.97, 0.5}, {0.5, 0.5}}, 0.1);
  Images<2> images({}, {{0, 0.0, 1.0}});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(in_hundredths({images.points().begin() + 3, images.points().end()}),
            (std::set<std::pair<long, long>>{{105, 50}, {-3, 50}}));
  for (std::int32_t m = 3; m < 5; ++m) {
    const auto source = particles.position[images.source(m)];
    EXPECT_NEAR(std::abs(images.points()[m][0] - source[0]), 1.0, 1e-15);
    EXPECT_FALSE(images.by_shaped_wall(m));
  }
  EXPECT_TRUE(images.weights().empty());
  std::vector<Vector<2>> extended;
  const std::vector<Vector<2>> velocity{{0.7, -0.2}, {0.1, 0.3}, {5.0, 5.0}};
  for (const bool viscous : {true, false}) {
    if (viscous)
      images.extend_for_viscosity(velocity, extended);
    else
      images.extend_for_divergence(velocity, extended);
    for (std::int32_t m = 3; m < 5; ++m) EXPECT_EQ(extended[m], velocity[images.source(m)]);
  }
}

TEST(PeriodicImages, CornerOfTwoAxesHasThree) {
  const auto particles = test::particles_at<2>({{0.05, 0.48}}, 0.1);
  Images<2> images({}, {{0, 0.0, 1.0}, {1, -0.5, 0.5}});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(in_hundredths({images.points().begin() + 1, images.points().end()}),
            (std::set<std::pair<long, long>>{{105, 48}, {5, -52}, {105, -52}}));
  for (std::int32_t m = 1; m < 4; ++m) EXPECT_EQ(images.source(m), 0);
}

TEST(PeriodicImages, ContinueTheLattice) {
  const auto particles = test::particles_at<3>(test::lattice<3>({4, 5, 4}, 0.25), 0.25);
  Images<3> images({}, {{0, 0.0, 1.0}, {1, 0.0, 1.25}, {2, 0.0, 1.0}});
  images.mirror(particles, 0.5);
  EXPECT_EQ(images.points().size(), 8u * 9u * 8u);
  std::set<std::array<long, 3>> sites;
  for (const auto& x : images.points())
    sites.insert({std::lround(x[0] / 0.25 - 0.5), std::lround(x[1] / 0.25 - 0.5),
                  std::lround(x[2] / 0.25 - 0.5)});
  EXPECT_EQ(sites.size(), 8u * 9u * 8u);
}

TEST(PeriodicImages, MirrorsInAWallAreCopiedToo) {
  const auto particles = test::particles_at<2>({{0.05, 0.03}}, 0.1);
  const Vector<2> lid(1.5, 0.0);
  Images<2> images({bottom(true, lid)}, {{0, 0.0, 1.0}});
  images.mirror(particles, 0.2);
  ASSERT_EQ(images.size(), 3u);
  EXPECT_EQ(in_hundredths({images.points().begin() + 1, images.points().end()}),
            (std::set<std::pair<long, long>>{{5, -3}, {105, 3}, {105, -3}}));
  std::vector<Vector<2>> extended;
  images.extend_for_viscosity({{0.7, -0.2}}, extended);
  for (std::size_t m = 1; m < 4; ++m) {
    const bool below = images.points()[m][1] < 0.0;
    const Vector<2> expected = below ? Vector<2>(2.3, 0.2) : Vector<2>(0.7, -0.2);  // 2 u_w - u
    EXPECT_NEAR((extended[m] - expected).norm(), 0.0, 1e-15);
  }
  images.set_wall_velocity(0, {-1.0, 0.0});
  images.extend_for_viscosity({{0.7, -0.2}}, extended);
  for (std::size_t m = 1; m < 4; ++m) {
    if (images.points()[m][1] < 0.0) {
      EXPECT_NEAR(extended[m][0], -2.7, 1e-15);
    }
  }
  images.extend_for_divergence({{0.7, -0.2}}, extended);
  for (std::size_t m = 1; m < 4; ++m)
    EXPECT_EQ(extended[m], Vector<2>(0.7, images.points()[m][1] < 0.0 ? 0.2 : -0.2));
}

TEST(PeriodicImages, WrapBringsAPlaceBackIn) {
  const Images<2> images({}, {{0, -1.0, 1.0}});
  for (const auto& [from, to] : {std::pair{0.25, 0.25},
                                 {-1.0, -1.0},
                                 {1.0, -1.0},
                                 {1.25, -0.75},
                                 {-1.5, 0.5},
                                 {7.25, -0.75},
                                 {-7.25, 0.75}}) {
    Vector<2> x(from, 42.0);
    images.wrap(x);
    EXPECT_EQ(x, Vector<2>(to, 42.0)) << from;
  }
}

// The sum of kernels knows no origin: every particle has the same filling wherever the seam lies.
TEST(PeriodicImages, TheSeamIsNowhere) {
  const double dx = 0.1;
  auto particles = test::particles_at<2>(test::lattice<2>({9, 7}, dx, 0.3, 12), dx);
  Images<2> images({}, {{0, 0.0, 0.9}, {1, 0.0, 0.7}});
  const Kernel<2> kernel(1.3 * dx);
  Support<2> support;
  images.mirror(particles, kernel.support_radius());
  support.build(kernel, images.points(), particles.size(), particles.volume);
  const auto before = support.partition();
  for (auto& x : particles.position) {
    x += Vector<2>(0.3172, -5.211);
    images.wrap(x);
  }
  images.mirror(particles, kernel.support_radius());
  support.build(kernel, images.points(), particles.size(), particles.volume);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_NEAR(support.partition()[i], before[i], 1e-12);
}

}  // namespace
}  // namespace sprung::sph
