#include "sph/neighbours.hpp"

#include "sph/counting_sort.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
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

// By hand: bucket 1 stays empty, and equal items keep their order.
TEST(CountingSort, KeepsTheOrderWithinABucket) {
  const std::vector<std::int32_t> bucket_of{3, 0, 2, 3, 0, 3};
  std::vector<std::int32_t> begin, order(bucket_of.size());
  counting_sort(bucket_of, 4, begin, [&](std::size_t i, std::int32_t place) {
    order[place] = static_cast<std::int32_t>(i);
  });
  EXPECT_EQ(order, (std::vector<std::int32_t>{1, 4, 2, 0, 3, 5}));
  EXPECT_EQ(begin, (std::vector<std::int32_t>{0, 2, 2, 3, 6}));
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

TEST(Support, APlaneAThirdTooDenseEqualsAllPairs) {
  // More pairs than a chunk has room for at first.
  const auto points = test::lattice<2>({37, 33}, 0.1 / std::sqrt(1.33), 0.2, 5);
  expect_all_pairs<2>(points, points.size(), 0.13, 0.01);
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

TEST(Support, OwnersOfOtherBlocksStandApart) {
  const auto points = test::lattice<2>({90, 60}, 0.1, 0.3, 4);
  const std::size_t owners = 5000;
  ASSERT_GT(owners, 2 * support_block);
  Support<2> support;
  support.build(Kernel<2>(0.13), points, owners, 0.01);
  std::size_t other = 0;
  for (std::size_t i = 0; i < owners; ++i) {
    const auto inner = support.inner(i).index;
    const SupportEnds ends = support.ends()[i];
    for (std::int32_t k = 0; k < ends.inner; ++k) {
      const std::size_t block = static_cast<std::size_t>(inner[k]) / support_block;
      const bool before = k < ends.before_block, after = k >= ends.in_block;
      EXPECT_EQ(before, block < i / support_block);
      EXPECT_EQ(after, block > i / support_block);
      other += before || after;
    }
  }
  EXPECT_GT(other, 0u);
}

TEST(Support, PartsOfAListAreOwnersBelowOwnersAboveAndTheRest) {
  const auto points = test::lattice<2>({12, 10}, 0.1, 0.4, 9);
  const std::size_t owners = 70;
  Support<2> support;
  support.build(Kernel<2>(0.13), points, owners, 0.01);
  std::size_t outer = 0;
  for (std::size_t i = 0; i < owners; ++i) {
    const auto self = static_cast<std::int32_t>(i);
    for (const std::int32_t j : support.lower(i).index) EXPECT_LT(j, self);
    for (const std::int32_t j : support.upper(i).index) {
      EXPECT_GT(j, self);
      EXPECT_LT(j, static_cast<std::int32_t>(owners));
    }
    for (const std::int32_t j : support.outer(i).index)
      EXPECT_GE(j, static_cast<std::int32_t>(owners));
    outer += support.outer(i).index.size();
    EXPECT_EQ(support.lower(i).index.size() + support.upper(i).index.size(),
              support.inner(i).index.size());
    EXPECT_EQ(support.inner(i).index.size() + support.outer(i).index.size(),
              support.of(i).index.size());
    EXPECT_EQ(support.inner(i).index.data(), support.of(i).index.data());
    // The arrays themselves tell the same.
    const std::size_t first = support.starts()[i];
    EXPECT_EQ(support.indices() + first, support.of(i).index.data());
    EXPECT_EQ(support.gradient_factors() + first, support.of(i).gradient_factor.data());
    const SupportEnds ends = support.ends()[i];
    EXPECT_EQ(static_cast<std::size_t>(ends.lower), support.lower(i).index.size());
    EXPECT_EQ(static_cast<std::size_t>(ends.inner), support.inner(i).index.size());
    EXPECT_EQ(static_cast<std::size_t>(ends.all), support.of(i).index.size());
    for (std::size_t k = 0; k < support.of(i).index.size(); ++k) {
      const double r = (points[i] - points[support.of(i).index[k]]).norm();
      EXPECT_NEAR(support.of(i).gradient_factor[k], Kernel<2>(0.13).gradient_factor(r), 1e-9);
    }
  }
  EXPECT_GT(outer, 50u);
}

TEST(Support, WeightsCountInFactorsAndPartition) {
  const auto points = test::lattice<2>({9, 9}, 0.1, 0.3, 2);
  std::vector<double> weights(points.size());
  for (std::size_t j = 0; j < points.size(); ++j) weights[j] = 0.5 + 0.01 * double(j);
  const Kernel<2> kernel(0.13);
  const double volume = 0.01;
  Support<2> plain, weighted;
  plain.build(kernel, points, 60, volume);
  weighted.build(kernel, points, 60, volume, weights);
  for (std::size_t i = 0; i < 60; ++i) {
    const auto a = plain.of(i), b = weighted.of(i);
    ASSERT_TRUE(std::equal(a.index.begin(), a.index.end(), b.index.begin(), b.index.end()));
    double partition = volume * kernel.value(0.0);  // the particle's own volume is its own
    for (std::size_t k = 0; k < a.index.size(); ++k) {
      const double weight = weights[a.index[k]];
      EXPECT_DOUBLE_EQ(b.gradient_factor[k], weight * a.gradient_factor[k]);
      partition += weight * volume * kernel.value((points[i] - points[a.index[k]]).norm());
    }
    EXPECT_NEAR(weighted.partition()[i], partition, 1e-13);
  }
}

TEST(Support, AroundCentresThatAreNoParticles) {
  const auto points = test::lattice<2>({11, 8}, 0.1, 0.4, 6);
  auto centres = test::lattice<2>({5, 4}, 0.17, 0.4, 8);
  // Beyond every cell, a little and far: a column that is thrown out asks about such places.
  for (const double far : {0.3, 0.7, 5.0, 1e9, 1e200})
    for (const double x : {-far, 1.1 + far})
      for (const double y : {-far, 0.4, 0.8 + far}) centres.emplace_back(x, y);
  const Kernel<2> kernel(0.13);
  Support<2> support;
  support.build_around(kernel, centres, points, 0.01);
  ASSERT_EQ(support.size(), centres.size());
  for (std::size_t c = 0; c < centres.size(); ++c) {
    std::vector<std::int32_t> expected;
    double partition = 0.0;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double r = (centres[c] - points[j]).norm();
      if (!(r < kernel.support_radius())) continue;
      expected.push_back(static_cast<std::int32_t>(j));
      partition += 0.01 * kernel.value(r);
    }
    EXPECT_TRUE(support.inner(c).index.empty());
    std::vector<std::int32_t> found(support.outer(c).index.begin(), support.outer(c).index.end());
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected) << c;
    EXPECT_NEAR(support.partition()[c], partition, 1e-12) << c;
  }
}

// Many places close together, few particles: places are not each other's neighbours.
TEST(Support, ManyCentresAroundFewParticles) {
  const auto points = test::lattice<2>({6, 6}, 0.1);
  std::vector<Vector<2>> centres;
  for (int k = 0; k < 1001; ++k) centres.emplace_back(6e-4 * k, 0.31);
  Support<2> support;
  support.build_around(Kernel<2>(0.13), centres, points, 0.01);
  for (std::size_t c = 0; c < centres.size(); ++c) EXPECT_LE(support.of(c).index.size(), 24u);
  // A centre on a particle counts it as well.
  support.build_around(Kernel<2>(0.13), std::vector<Vector<2>>{points[14]}, points, 0.01);
  EXPECT_EQ(support.of(0).index.size(), 21u);
  // A centre far from all has none.
  support.build_around(Kernel<2>(0.13), std::vector<Vector<2>>{{9.0, -7.0}, {0.3, 0.3}}, points,
                       0.01);
  EXPECT_TRUE(support.of(0).index.empty());
  EXPECT_EQ(support.partition()[0], 0.0);
  EXPECT_FALSE(support.of(1).index.empty());
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
