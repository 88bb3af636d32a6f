#include "sph/neighbours.hpp"

#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace sprung::sph {
namespace {

/// Compares the lists of the first `owners` points with a search over all pairs.
template <int dim>
void expect_all_pairs(const std::vector<Vector<dim>>& points, std::size_t owners, double h,
                      double volume) {
  const Kernel<dim> kernel(h);
  Support<dim> support;
  support.build(kernel, points, owners, volume);
  ASSERT_EQ(support.size(), owners);
  ASSERT_EQ(support.partition().size(), owners);
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < owners; ++i) {
    std::vector<std::int32_t> expected;
    double partition = volume * kernel.value(0.0);
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double r = (points[i] - points[j]).norm();
      if (j == i || !(r < kernel.support_radius())) continue;
      expected.push_back(static_cast<std::int32_t>(j));
      partition += volume * kernel.value(r);
    }
    const auto found = support.of(i);
    ASSERT_EQ(found.index.size(), found.gradient_factor.size());
    for (std::size_t k = 0; k < found.index.size(); ++k) {
      const double r = (points[i] - points[found.index[k]]).norm();
      ASSERT_NEAR(found.gradient_factor[k], kernel.gradient_factor(r),
                  -1e-12 * kernel.gradient_factor(0.0));
    }
    std::vector<std::int32_t> sorted(found.index.begin(), found.index.end());
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted, expected) << "particle " << i;
    ASSERT_NEAR(support.partition()[i], partition, 1e-12);
    pairs += expected.size();
  }
  EXPECT_EQ(support.pairs(), pairs);
  EXPECT_GT(pairs, owners);  // the comparison was not empty
}

TEST(Support, PlaneLatticeEqualsAllPairs) {
  // 1.3 dx: no shell of the lattice lies at the edge of the support, so rounding decides nothing.
  const auto points = test::lattice<2>({31, 17}, 0.1);
  expect_all_pairs<2>(points, points.size(), 0.13, 0.01);
}

TEST(Support, DisorderedPlaneEqualsAllPairs) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const auto points = test::lattice<2>({23, 29}, 0.1, 0.45, seed);
    expect_all_pairs<2>(points, points.size(), 0.13, 0.01);
  }
}

TEST(Support, UniformlyRandomPointsInThePlane) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> x(-3.0, 5.0), y(100.0, 101.5);
  std::vector<Vector<2>> points;
  for (int k = 0; k < 600; ++k) points.emplace_back(x(generator), y(generator));
  expect_all_pairs<2>(points, 600, 0.11, 0.02);
}

TEST(Support, SpaceEqualsAllPairs) {
  expect_all_pairs<3>(test::lattice<3>({9, 11, 7}, 0.1), 9 * 11 * 7, 0.13, 1e-3);
  const auto points = test::lattice<3>({9, 8, 10}, 0.1, 0.4, 5);
  expect_all_pairs<3>(points, points.size(), 0.13, 1e-3);
  expect_all_pairs<3>(points, points.size(), 0.2, 1e-3);
}

TEST(Support, ImagesAreNeighboursWithoutListsOfTheirOwn) {
  const auto particles = test::particles_at<2>(test::lattice<2>({14, 9}, 0.1, 0.3, 4), 0.1);
  Images<2> images(test::walls_of_box<2>({1.4, 0.9}, true));
  images.mirror(particles, 0.26);
  ASSERT_GT(images.points().size(), particles.size());
  expect_all_pairs<2>(images.points(), particles.size(), 0.13, 0.01);

  const auto cube = test::particles_at<3>(test::lattice<3>({6, 5, 7}, 0.1, 0.3, 4), 0.1);
  Images<3> around(test::walls_of_box<3>({0.6, 0.5, 0.7}, false));
  around.mirror(cube, 0.26);
  expect_all_pairs<3>(around.points(), cube.size(), 0.13, 1e-3);
}

TEST(Support, RebuildsForFewerAndMoreParticles) {
  Support<2> support;
  const Kernel<2> kernel(0.13);
  const auto many = test::lattice<2>({40, 40}, 0.1);
  const auto few = test::lattice<2>({3, 3}, 0.1);
  support.build(kernel, many, many.size(), 0.01);
  // In the interior at h = 1.3 dx: 4 + 4 + 4 + 8 neighbours (dx, sqrt 2, 2, sqrt 5 < 2.6).
  EXPECT_EQ(support.of(20 * 40 + 20).index.size(), 20u);
  support.build(kernel, few, few.size(), 0.01);
  EXPECT_EQ(support.size(), 9u);
  EXPECT_EQ(support.of(4).index.size(), 8u);
  support.build(kernel, many, many.size(), 0.01);
  EXPECT_EQ(support.of(20 * 40 + 20).index.size(), 20u);
}

TEST(Support, RefusesACrowd) {
  std::vector<Vector<2>> points;
  for (int k = 0; k < 200; ++k) points.emplace_back(1e-4 * k, 0.0);
  Support<2> support;
  EXPECT_THROW(support.build(Kernel<2>(1.0), points, points.size(), 1.0), std::runtime_error);
}

TEST(Support, RefusesAParticleThatHasFlownAway) {
  auto points = test::lattice<2>({10, 10}, 0.1);
  points.push_back({1e12, 0.0});
  Support<2> support;
  EXPECT_THROW(support.build(Kernel<2>(0.13), points, points.size(), 0.01), std::runtime_error);
}

// Disabled because it fails: the search grid's box ignores the NaN, and the cell number made from
// it lies outside the grid. To be enabled with a check of each point in CellGrid.
TEST(Support, RefusesAPositionThatIsNotANumber) {
  for (const std::size_t place : {std::size_t{0}, std::size_t{50}, std::size_t{99}}) {
    auto points = test::lattice<2>({10, 10}, 0.1);
    points[place][1] = std::numeric_limits<double>::quiet_NaN();
    Support<2> support;
    EXPECT_THROW(support.build(Kernel<2>(0.13), points, points.size(), 0.01), std::runtime_error)
        << place;
  }
}

TEST(Support, CellOrderIsAPermutationThatGroupsCells) {
  const auto points = test::lattice<2>({12, 12}, 0.1, 0.4, 3);
  const auto order = Support<2>::cell_order(points, 20, points.size(), 0.3);
  std::vector<std::int32_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  ASSERT_EQ(sorted.size(), points.size() - 20);
  for (std::size_t k = 0; k < sorted.size(); ++k) EXPECT_EQ(sorted[k], static_cast<int>(k) + 20);
  // Rows of cells in order: the cell's row never decreases along the order.
  double low = points[0][1];
  for (const auto& x : points) low = std::min(low, x[1]);
  int row = 0;
  for (const std::int32_t i : order) {
    const int now = static_cast<int>((points[i][1] - low + 3e-10) / 0.3);
    EXPECT_GE(now, row);
    row = now;
  }
}

}  // namespace
}  // namespace sprung::sph
