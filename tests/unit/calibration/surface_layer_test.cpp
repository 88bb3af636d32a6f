// The layer below a free face in which the pressure equation does not keep the volume.
#include "calibration/surface_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace sprung;
using namespace sprung::calibration;

const Material paper{3, sph::Bonds::equal, 0.0};

// At h = dx only neighbouring layers meet: g = sin(k)/dx, l = 2 (1 - cos k)/dx^2, so that with
// x = cos k and T = 2 (courant/feedback) C11/(k_e sigma) the condition is T (1 - x)^2 + 1 + x = 0.
// sigma by hand, from the shells of 6, 12 and 8 neighbours.
TEST(SurfaceLayer, DecaysAsTheQuadraticEquationSaysWhereOnlyNeighboursMeet) {
  const auto part = [](double r) { return 1.0 - 0.5 * r; };
  const auto w = [&](double r) { return std::pow(part(r), 4) * (1.0 + 2.0 * r); };
  const auto f = [&](double r) { return 5.0 * std::pow(part(r), 3); };
  const double d2 = std::numbers::sqrt2, d3 = std::numbers::sqrt3;
  const double sigma =
      (2.0 * f(1) + 8.0 * f(d2) + 8.0 * f(d3)) / (1.0 + 6.0 * w(1) + 12.0 * w(d2) + 8.0 * w(d3));
  const double courant = 0.387, feedback = 0.5;
  const double t = 2.0 * courant / feedback * 13.0 / 3.0 / sigma;
  const std::complex<double> x =
      (2.0 * t - 1.0 - std::sqrt(std::complex<double>(1.0 - 8.0 * t))) / (2.0 * t);
  const auto z = surface_layer_decay(paper, 1.0, courant, feedback);
  EXPECT_LT(std::abs(z), 1.0);
  EXPECT_NEAR(std::abs(0.5 * (z + 1.0 / z) - x), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(z), 0.489, 1e-3);  // and by NumPy's roots
  EXPECT_NEAR(std::arg(z), 0.747, 1e-3);
  EXPECT_NEAR(std::abs(surface_layer_decay(paper, 1.3, courant, feedback)), 0.513, 1e-3);
}

// One decaying complex pair: S_(m+2) = 2 Re z S_(m+1) - |z|^2 S_m, from the second layer on. The
// tolerance, 0.4 % of the error there, is what the other faces, 20 layers away at most, and the
// load's end layers add.
TEST(SurfaceLayer, OfABlockFollowsTheDerivedDecay) {
  Pull pull;
  pull.layers = 20;
  pull.load = 1e-2;
  for (const double ratio : {1.0, 1.3}) {
    pull.smoothing_length_ratio = ratio;
    const SurfaceLayer layer = measure_surface_layer<3>(paper, pull);
    const auto z = surface_layer_decay(paper, ratio, layer.courant, pull.density_feedback);
    const auto& error = layer.density_error;
    const std::size_t first = ratio == 1.0 ? 2 : 3;  // the kernel's reach more
    EXPECT_GT(error[first], 0.03);
    for (std::size_t m = first; m + 2 < 9; ++m)
      EXPECT_NEAR(error[m + 2], 2.0 * z.real() * error[m + 1] - std::norm(z) * error[m], 4e-4)
          << ratio << " " << m;
    EXPECT_GT(layer.poisson_ratio[1], 0.515);        // within the layer
    EXPECT_NEAR(layer.poisson_ratio[5], 0.5, 5e-3);  // beyond it
  }
}

}  // namespace
