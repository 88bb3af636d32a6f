#include "sph/kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sprung::sph {
namespace {

constexpr double pi = std::numbers::pi;

/// Simpson's rule over the support; the integrand is a polynomial of degree 6 or 7 in r, so 2000
/// intervals leave round-off only.
template <int dim>
double integral(const Kernel<dim>& kernel) {
  constexpr int intervals = 2000;
  const double step = kernel.support_radius() / intervals;
  double sum = 0.0;
  for (int k = 0; k <= intervals; ++k) {
    const double r = k * step;
    const double shell = dim == 2 ? 2.0 * pi * r : 4.0 * pi * r * r;
    const double weight = k == 0 || k == intervals ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
    sum += weight * shell * kernel.value(std::min(r, kernel.support_radius()));
  }
  return sum * step / 3.0;
}

TEST(Kernel, HasUnitIntegral) {
  for (const double h : {0.00375, 1.0, 1.3}) {
    EXPECT_NEAR(integral(Kernel<2>(h)), 1.0, 1e-11);
    EXPECT_NEAR(integral(Kernel<3>(h)), 1.0, 1e-11);
  }
}

TEST(Kernel, GradientFactorIsTheDerivativeOverTheDistance) {
  const double h = 0.7;
  const Kernel<2> plane(h);
  const Kernel<3> space(h);
  // Central difference: error e^2 W'''/6 (about 1e-9 of W') and round-off 1e-16/e.
  const double e = 1e-5 * h;
  for (double r = 0.05 * h; r < 1.99 * h; r += 0.097 * h) {
    const double in_plane = (plane.value(r + e) - plane.value(r - e)) / (2.0 * e) / r;
    const double in_space = (space.value(r + e) - space.value(r - e)) / (2.0 * e) / r;
    EXPECT_NEAR(plane.gradient_factor(r), in_plane, 1e-8 * plane.gradient_factor(0.0) * -1.0) << r;
    EXPECT_NEAR(space.gradient_factor(r), in_space, 1e-8 * space.gradient_factor(0.0) * -1.0) << r;
  }
}

TEST(Kernel, VanishesWithItsGradientAtTheEndOfTheSupport) {
  const Kernel<2> kernel(0.5);
  EXPECT_DOUBLE_EQ(kernel.support_radius(), 1.0);
  EXPECT_EQ(kernel.value(1.0), 0.0);
  EXPECT_EQ(kernel.gradient_factor(1.0), 0.0);
}

// At h = dx only the shells at dx, sqrt(2) dx (and sqrt(3) dx in space) count. With
// F = -5 alpha (1 - q/2)^3 and sum x^2 over a shell 2, 4 in the plane and 2, 8, 8 in space:
//   plane: 5 . 7/(4 pi) [2/8 + 4 (1 - 1/sqrt 2)^3]                          = 0.976 (method.md)
//   space: 5 . 21/(16 pi) [2/8 + 8 (1 - 1/sqrt 2)^3 + 8 (1 - sqrt(3)/2)^3]  = 0.982 (method.md)
TEST(Kernel, LatticeGradientFactorsAtOneSpacing) {
  const double edge = std::pow(1.0 - 1.0 / std::numbers::sqrt2, 3);
  const double corner = std::pow(1.0 - std::numbers::sqrt3 / 2.0, 3);
  const double plane = 35.0 / (4.0 * pi) * (0.25 + 4.0 * edge);
  const double space = 105.0 / (16.0 * pi) * (0.25 + 8.0 * edge + 8.0 * corner);
  EXPECT_NEAR(plane, 0.976, 5e-4);
  EXPECT_NEAR(space, 0.982, 5e-4);
  const double dx = 0.013;
  EXPECT_NEAR(lattice_sums(Kernel<2>(dx), dx).gradient, plane, 1e-13);
  EXPECT_NEAR(lattice_sums(Kernel<3>(dx), dx).gradient, space, 1e-13);
}

TEST(Kernel, NormalisedGradientIsExactForLinearFieldsOnTheLattice) {
  const double dx = 0.02;
  for (const double ratio : {1.0, 1.3, 1.5, 2.0}) {
    Kernel<2> plane(ratio * dx);
    plane.normalise_gradient(lattice_sums(plane, dx).gradient);
    EXPECT_NEAR(lattice_sums(plane, dx).gradient, 1.0, 1e-13) << ratio;
    Kernel<3> space(ratio * dx);
    space.normalise_gradient(lattice_sums(space, dx).gradient);
    EXPECT_NEAR(lattice_sums(space, dx).gradient, 1.0, 1e-13) << ratio;
  }
}

TEST(Kernel, LatticePartitionTendsToOne) {
  // The lattice sum of a kernel of unit integral tends to 1 as the support grows; for Wendland C2
  // the error falls faster than (dx/h)^3, so 1e-4 at h = 4 dx is safe and 2e-2 at h = dx expected.
  const double dx = 1.0;
  EXPECT_NEAR(lattice_sums(Kernel<2>(4.0 * dx), dx).partition, 1.0, 1e-4);
  EXPECT_NEAR(lattice_sums(Kernel<3>(4.0 * dx), dx).partition, 1.0, 1e-4);
  EXPECT_GT(std::abs(lattice_sums(Kernel<2>(dx), dx).partition - 1.0), 1e-4);
}

}  // namespace
}  // namespace sprung::sph
