/// Outlines whose distances follow from plane geometry.

#include "validation/outline_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace sprung {
namespace {

using Curve = std::vector<PlanePoint>;

TEST(DistanceToCurve, IsPerpendicularWithinAndToTheEndBeyond) {
  const Curve line{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}};
  EXPECT_DOUBLE_EQ(distance_to_curve({0.5, 0.2}, line), 0.2);
  EXPECT_DOUBLE_EQ(distance_to_curve({-0.3, 0.4}, line), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_curve({1.1, 0.5}, line), 1.1 - 1.0);
}

TEST(OutlineDistance, DoesNotSeeMaterialSlidingAlongTheCurve) {
  // The same straight curve; the middle point alone has slid along it by 0.1.
  const Curve reference{{0.0, 0.0}, {0.0, 0.5}, {0.0, 1.0}};
  const Curve candidate{{0.0, 0.0}, {0.0, 0.6}, {0.0, 1.0}};
  const OutlineDistance distance = outline_distance(reference, candidate);
  EXPECT_DOUBLE_EQ(distance.largest, 0.0);
  EXPECT_NEAR(distance.largest_material, 0.1, 1e-15);
  EXPECT_NEAR(distance.rms_material, 0.1 / std::sqrt(3.0), 1e-15);
}

TEST(OutlineDistance, OfAParallelCurveIsTheGap) {
  const Curve reference{{0.0, 0.0}, {0.0, 0.5}, {0.0, 1.0}};
  const Curve candidate{{0.02, 0.0}, {0.02, 0.5}, {0.02, 1.0}};
  const OutlineDistance distance = outline_distance(reference, candidate);
  EXPECT_NEAR(distance.largest, 0.02, 1e-16);
  EXPECT_NEAR(distance.rms, 0.02, 1e-16);
  EXPECT_NEAR(distance.rms_material, 0.02, 1e-16);
}

TEST(OutlineDistance, SeesAHumpFromEitherSide) {
  // One vertex stands out by 0.3: its distance to the straight curve is 0.3; the straight curve's
  // middle is 0.3 cos(atan(0.3 / 0.5)) from the hump's flanks.
  const Curve straight{{0.0, 0.0}, {0.0, 0.5}, {0.0, 1.0}};
  const Curve hump{{0.0, 0.0}, {0.3, 0.5}, {0.0, 1.0}};
  const double flank = 0.3 * std::cos(std::atan(0.3 / 0.5));
  const double rms = std::sqrt((0.09 + flank * flank) / 6.0);
  EXPECT_NEAR(outline_distance(straight, hump).largest, 0.3, 1e-15);
  EXPECT_NEAR(outline_distance(hump, straight).largest, 0.3, 1e-15);
  EXPECT_NEAR(outline_distance(straight, hump).rms, rms, 1e-15);
}

TEST(OutlineDistance, RefusesUnequalNumbersOfPoints) {
  const Curve two{{0.0, 0.0}, {0.0, 1.0}};
  const Curve three{{0.0, 0.0}, {0.0, 0.5}, {0.0, 1.0}};
  EXPECT_THROW(outline_distance(two, three), std::invalid_argument);
}

}  // namespace
}  // namespace sprung
