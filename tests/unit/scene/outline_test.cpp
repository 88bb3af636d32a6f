/// Outline points by hand.

#include "scene/problem.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung {
namespace {

Solid body(std::optional<Side> clamped) {
  Solid solid;
  solid.name = "block";
  solid.body = {{1, 2, 0}, {3, 3, 0}};  // 2 wide, 1 high
  solid.clamped = clamped;
  return solid;
}

void expect_points(const std::vector<Point>& points, const std::vector<Point>& expected) {
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      // 2 and 1 in halves: exact in binary up to the division of the arc length
      EXPECT_NEAR(points[i][axis], expected[i][axis], 1e-14) << "point " << i << ", axis " << axis;
}

TEST(Outline, ClampedAtTheBottomGoesUpAlongAndDown) {  // 1 + 2 + 1 = 4 long
  expect_points(outline_points(body(Side::bottom), 9), {{1, 2, 0},
                                                        {1, 2.5, 0},
                                                        {1, 3, 0},
                                                        {1.5, 3, 0},
                                                        {2, 3, 0},
                                                        {2.5, 3, 0},
                                                        {3, 3, 0},
                                                        {3, 2.5, 0},
                                                        {3, 2, 0}});
}

TEST(Outline, ClampedElsewhereStartsAtThatSidesCorner) {
  expect_points(outline_points(body(Side::top), 5),
                {{3, 3, 0}, {3, 2, 0}, {2, 2, 0}, {1, 2, 0}, {1, 3, 0}});
  expect_points(outline_points(body(Side::left), 6),  // 2 + 1 + 2 = 5 long
                {{1, 3, 0}, {2, 3, 0}, {3, 3, 0}, {3, 2, 0}, {2, 2, 0}, {1, 2, 0}});
  expect_points(outline_points(body(Side::right), 6),
                {{3, 2, 0}, {2, 2, 0}, {1, 2, 0}, {1, 3, 0}, {2, 3, 0}, {3, 3, 0}});
}

TEST(Outline, FreeBodyGoesRoundOnce) {  // 6 long
  expect_points(outline_points(body(std::nullopt), 6),
                {{1, 2, 0}, {1, 3, 0}, {2, 3, 0}, {3, 3, 0}, {3, 2, 0}, {2, 2, 0}});
}

// The paper's beam: 0.1 + 0.015 + 0.1 m in 86 intervals of 2.5 mm, so points 40 and 46 are the
// corners of the tip, exactly, and every point lies on a side.
TEST(Outline, BeamHitsItsCornersExactly) {
  Solid beam;
  beam.body = {{0.3, 0, 0}, {0.315, 0.1, 0}};
  beam.clamped = Side::bottom;
  const auto points = outline_points(beam, 87);
  EXPECT_EQ(points.front(), (Point{0.3, 0, 0}));
  EXPECT_EQ(points[40], (Point{0.3, 0.1, 0}));
  EXPECT_EQ(points[46], (Point{0.315, 0.1, 0}));
  EXPECT_EQ(points.back(), (Point{0.315, 0, 0}));
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double step =
        std::abs(points[i + 1][0] - points[i][0]) + std::abs(points[i + 1][1] - points[i][1]);
    EXPECT_NEAR(step, 0.0025, 1e-15);  // round-off of 0.215 m: 3e-17
    EXPECT_TRUE(points[i][0] == 0.3 || points[i][0] == 0.315 || points[i][1] == 0.1) << i;
  }
}

TEST(Outline, RefusesWhatItCannotDraw) {
  EXPECT_THROW(outline_points(body(Side::bottom), 1), std::invalid_argument);
  EXPECT_THROW(outline_points(body(Side::back), 10), std::invalid_argument);
}

}  // namespace
}  // namespace sprung
