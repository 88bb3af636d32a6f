// Plates of few layers: what static tests and vibration give with and without surface correction.
#include "calibration/bending_test.hpp"
#include "calibration/equilibrium.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace {

using namespace sprung;
using namespace sprung::calibration;
using enum sph::Bonds;

/// Tip's deflection (m) of the paper's beam, 15 mm x 100 mm, `n` layers, clamped at the bottom,
/// under 10 N/m on each metre of its left side.
double cantilever_tip(int n) {
  constexpr double width = 0.015, height = 0.1, line_load = 10.0;
  const double dx = width / n;
  const int rows = static_cast<int>(std::lround(height / dx));
  const double pitch = height / rows;
  const std::array<int, 2> count{n, rows};
  Solid shape = shape_of<2>(count, dx);
  shape.body.to = {width, height, 0.0};
  shape.clamped = Side::bottom;
  auto particles = fitted<2>(shape, dx);
  const auto rest = particles.position;
  const auto network = network_of<2>(particles, shape, {2, isotropic, 300.0}, true);
  std::vector<Vector<2>> load(particles.size(), Vector<2>::Zero());
  for (std::size_t i = 0; i < load.size(); ++i) {
    load[i][0] = line_load * pitch / n;
  }
  find_equilibrium<2>(network, particles, load, 1e-7);
  const auto mean = [&](int row) {
    double sum = 0.0;
    for (int i = 0; i < n; ++i) sum += (particles.position[row * n + i] - rest[row * n + i])[0] / n;
    return sum;
  };
  const double last = mean(rows - 1);
  return last + 0.5 * (last - mean(rows - 2));
}

const Material plane{2, isotropic, 300.0}, space{3, isotropic, 300.0};
constexpr double thirty_degrees = std::numbers::pi / 6.0;

TEST(Plates, UncorrectedSpringsAloneBendByTheirLaw) {
  // 3/4 of the incompressible modulus, and (n-1)/n of it: exact for bonds without lateral
  // constraint.
  for (const int n : {2, 3, 4, 6})
    EXPECT_NEAR(bending_ratio({n, {2, equal, 0.0}, false}), 0.75 * (n - 1.0) / n, 2e-4) << n;
}

TEST(Plates, UncorrectedWithCellsBendByTheLawOfCells) {
  // The law is that of kappa without bound; 1/kappa is 0.3 %.
  for (const int n : {2, 3, 4, 6}) {
    const Plate plate{n, plane, false};
    EXPECT_NEAR(bending_ratio(plate) / uncorrected_bending_law(plate), 1.0, 5e-3) << n;
  }
  for (const int n : {2, 3}) {
    const Plate bar{n, space, false, n + 1};
    EXPECT_NEAR(bending_ratio(bar) / uncorrected_bending_law(bar), 1.0, 5e-3) << n;
  }
}

TEST(Plates, CorrectedBendAndStretchAsTheContinuum) {
  // 1/kappa = 0.3 %: in bending the lateral strain cannot relax quite as in the continuum of finite
  // kappa.
  for (const int n : {2, 3, 4, 6}) {
    EXPECT_NEAR(stretching_ratio({n, plane, true}), 1.0, 4e-3) << n;
    EXPECT_NEAR(bending_ratio({n, plane, true}), 1.0, 4e-3) << n;
  }
}

TEST(Plates, CorrectedInSpaceBendAndStretchAsTheContinuum) {
  // As in the plane; the section of a bar warps, which few particles follow to 0.1 % or so.
  for (const int n : {2, 3}) {
    EXPECT_NEAR(stretching_ratio({n, space, true, n + 1}), 1.0, 5e-3) << n;
    EXPECT_NEAR(bending_ratio({n, space, true, n + 1}), 1.0, 5e-3) << n;
  }
}

TEST(Plates, TurnedAgainstTheAxesAreTheSame) {
  for (const int n : {2, 3, 4}) {
    Plate plate{n, plane, true};
    const double bending = bending_ratio(plate), frequency = frequency_ratio(plate);
    plate.angle = thirty_degrees;
    // The same network, turned: rounding, and Newton's tolerance of 1e-8 of a force that the
    // slender plate divides by (16 n)^2.
    EXPECT_NEAR(bending_ratio(plate) / bending, 1.0, 1e-4) << n;
    EXPECT_NEAR(frequency_ratio(plate) / frequency, 1.0, 1e-4) << n;
  }
}

TEST(Plates, BentToAnArcBendAsTheCurvedBar) {
  // The line of strains through a cell has the bond's own length at its midpoint: off by the
  // square of spacing over radius, (bend/n)^2, and of the strain's own curvature, bend^2/n^2; 1 %
  // is the measure of both at bend = 0.2.
  for (const int n : {2, 3, 4})
    for (const double bend : {0.1, 0.2}) {
      Plate plate{n, plane, true};
      plate.bend = bend;
      EXPECT_NEAR(bending_ratio(plate), 1.0, 0.01) << n << ", " << bend;
    }
}

TEST(Plates, CorrectedRingAsTheTimoshenkoBeam) {
  // The clamp holds the lateral strain that beam theory lets go. At length 20/3 h it takes 2.9 %
  // off the tip's deflection (cantilever_tip of 12 and 16 layers over Timoshenko's: 0.9716,
  // 0.9714), as if the beam were 0.048 h shorter; at length 10 h that is 1 % of the frequency.
  for (const int n : {2, 3, 4}) EXPECT_NEAR(frequency_ratio({n, plane, true}), 1.01, 0.01) << n;
  // Of many layers, too: the deflection is not found from the rounding of positions.
  EXPECT_NEAR(frequency_ratio({24, plane, true}), 1.01, 3e-3);
}

// A cantilever of length 20/3 thicknesses under an even load converges from both sides; against 16
// layers, 1.5 % at 3 and 4 layers and 0.5 % at 8: the clamp's corners cost this much, half of it
// at twice the layers.
TEST(Plates, ClampedBendAsFinerOnes) {
  const double fine = cantilever_tip(16);
  for (const auto& [n, tolerance] : {std::pair{3, 0.015}, {4, 0.015}, {8, 0.005}})
    EXPECT_NEAR(cantilever_tip(n) / fine, 1.0, tolerance) << n;
}

TEST(Plates, OfOneLayerAreRefused) {
  EXPECT_THROW(bending_ratio({1, plane, true}), std::invalid_argument);
}

TEST(TimoshenkoBeam, HasEulersRootWhenSlender) {
  EXPECT_NEAR(timoshenko_root(1e-12, 1e-12), 3.5160152685, 1e-8);
}

TEST(TimoshenkoBeam, LosesToShearWhatDunkerleysSumSays) {
  // Dunkerley's sum of 1/omega^2 for bending and shear bounds the root from below within a per cent
  // when small.
  const double s2 = 1e-3;
  const double shear_only = 0.5 * std::numbers::pi / std::sqrt(s2);
  const double sum =
      1.0 / std::sqrt(1.0 / (3.5160153 * 3.5160153) + 1.0 / (shear_only * shear_only));
  EXPECT_NEAR(timoshenko_root(1e-12, s2) / sum, 1.0, 5e-3);
}

}  // namespace
