// Lattice constants C11, C12, C44 in units of k_e against lattice sums done by hand: with bonds of
// stiffness w k_e dx^(dim-2) along r n, C_ijkl = sum over half the bonds of w r^2 n_i n_j n_k n_l.
#include "calibration/lattice_modulus.hpp"

#include <gtest/gtest.h>

#include <map>

namespace {

using namespace sprung;
using namespace sprung::calibration;
using enum sph::Bonds;

// Central differences of the energy with steps of 1e-4: truncation and rounding are both about
// 1e-8.
constexpr double tolerance = 1e-6;

struct Constants {
  double c11, c12, c44;
};

template <int dim>
void expect_cubic(sph::Bonds bonds, const Constants& expected) {
  const auto c = BulkLattice<dim>({dim, bonds, 0.0}).elastic_constants();
  for (int a = 0; a < voigt_size<dim>; ++a)
    for (int b = 0; b < voigt_size<dim>; ++b) {
      const bool normal = a < dim && b < dim;
      const double value =
          a != b ? (normal ? expected.c12 : 0.0) : (normal ? expected.c11 : expected.c44);
      EXPECT_NEAR(c(a, b), value, tolerance) << a << " " << b;
    }
}

TEST(LatticeConstants, InThePlane) {
  expect_cubic<2>(equal, {2.0, 1.0, 1.0});
  expect_cubic<2>(isotropic, {1.5, 0.5, 0.5});
}

TEST(LatticeConstants, InSpace) {
  expect_cubic<3>(equal, {13.0 / 3.0, 7.0 / 3.0, 7.0 / 3.0});
  expect_cubic<3>(isotropic, {3.0, 1.0, 1.0});
}

TEST(LatticeConstants, ZenerRatioIsOneForIsotropicBonds) {
  const auto plane = BulkLattice<2>({2, isotropic, 0.0}).elastic_constants();
  EXPECT_NEAR(2.0 * plane(2, 2) / (plane(0, 0) - plane(0, 1)), 1.0, tolerance);
  const auto space = BulkLattice<3>({3, isotropic, 0.0}).elastic_constants();
  EXPECT_NEAR(2.0 * space(3, 3) / (space(0, 0) - space(0, 1)), 1.0, tolerance);
  const auto paper = BulkLattice<3>({3, equal, 0.0}).elastic_constants();
  EXPECT_NEAR(2.0 * paper(3, 3) / (paper(0, 0) - paper(0, 1)), 7.0 / 3.0, tolerance);
}

TEST(LatticeConstants, AreaSpringsAddTheirModulusToTheLameConstant) {
  const double kappa = 30.0, g = 0.5;
  const auto c = BulkLattice<2>({2, isotropic, kappa}).elastic_constants();
  EXPECT_NEAR(c(0, 0), 1.5 + kappa * g, 1e-4);  // C is 20 times larger, rounding as well
  EXPECT_NEAR(c(0, 1), 0.5 + kappa * g, 1e-4);
  EXPECT_NEAR(c(2, 2), 0.5, 1e-5);
}

TEST(LatticeModulus, OfThePapersBondsDependsOnDirection) {
  const BulkLattice<3> space({3, equal, 0.0});
  EXPECT_NEAR(space.modulus_per_stiffness({1, 0, 0}), 3.00, 1e-5);
  EXPECT_NEAR(space.modulus_per_stiffness({1, 1, 0}), 5.25, 1e-5);
  EXPECT_NEAR(space.modulus_per_stiffness({1, 1, 1}), 7.00, 1e-5);
  const BulkLattice<2> plane({2, equal, 0.0});
  EXPECT_NEAR(plane.modulus_per_stiffness({1, 0}), 1.5, 1e-5);
  EXPECT_NEAR(plane.modulus_per_stiffness({1, 1}), 3.0, 1e-5);
}

TEST(LatticeModulus, OfIsotropicBondsDoesNot) {
  const BulkLattice<3> space({3, isotropic, 0.0});
  for (const Vector<3>& d : {Vector<3>{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {3, 1, 2}, {-1, 5, 2}})
    EXPECT_NEAR(space.modulus_per_stiffness(d), 3.0, 1e-5) << d.transpose();
  const BulkLattice<2> plane({2, isotropic, 0.0});
  for (const Vector<2>& d : {Vector<2>{1, 0}, {1, 1}, {2, 1}, {-1, 7}})
    EXPECT_NEAR(plane.modulus_per_stiffness(d), 1.5, 1e-5) << d.transpose();
}

// E of the incompressible cubic crystal: 1/E = 2/(3 (C11 - C12)) (1 - 3 J) + J/C44 ..., written out
// for a pull along d with J = d1^2 d2^2 + d2^2 d3^2 + d3^2 d1^2; the limit of Nye's formula for
// infinite bulk modulus.
TEST(LatticeModulus, FollowsTheClosedFormOfTheCubicCrystal) {
  const BulkLattice<3> lattice({3, equal, 0.0});
  const double c_prime = 0.5 * (13.0 / 3.0 - 7.0 / 3.0), c44 = 7.0 / 3.0;
  for (const Vector<3>& direction : {Vector<3>{1, 2, 0}, {1, 2, 3}, {-2, 1, 5}, {1, 1, 4}}) {
    const Vector<3> d = direction.normalized();
    const double j =
        d[0] * d[0] * d[1] * d[1] + d[1] * d[1] * d[2] * d[2] + d[2] * d[2] * d[0] * d[0];
    const double compliance = 1.0 / (3.0 * c_prime) - j * (1.0 / c_prime - 1.0 / c44);
    EXPECT_NEAR(lattice.modulus_per_stiffness(d), 1.0 / compliance, 1e-5) << direction.transpose();
  }
}

TEST(LatticeModulus, WithAreaSpringsIsThatOfTheNearlyIncompressibleSolid) {
  // lambda = (1 + kappa) G in plane strain: 4/3 E = 4 G (lambda + G)/(lambda + 2 G), G = k_e/2.
  for (const double kappa : {10.0, 30.0, 300.0})
    for (const Vector<2>& d : {Vector<2>{1, 0}, {1, 1}, {3, 1}})
      EXPECT_NEAR(BulkLattice<2>({2, isotropic, kappa}).modulus_per_stiffness(d),
                  1.5 * (2.0 + kappa) / (3.0 + kappa), 1e-5)
          << kappa << ": " << d.transpose();
}

/// Bonds of the particle in the middle of a block, by length over dx.
template <int dim>
std::map<long, int> bonds_by_squared_length(sph::Bonds bonds) {
  std::array<int, dim> count;
  count.fill(7);
  // A spacing whose multiples are not exact, so that 2 dx is the tie that it is in real scenes.
  const double spacing = 0.1 / 27.0;
  const auto particles = block<dim>(count, spacing);
  const auto network = network_of<dim>(particles, shape_of<dim>(count, spacing), {dim, bonds, 0.0});
  const auto centre = static_cast<std::int32_t>(particles.size() / 2);
  std::map<long, int> found;
  for (const auto& bond : network.bonds)
    if (bond.a == centre || bond.b == centre)
      ++found[std::lround(bond.rest_length * bond.rest_length / (spacing * spacing))];
  return found;
}

TEST(BondShells, StopShortOfTheTieAtTwoSpacings) {
  // Squared lengths 1, 2, 3; a cut "<= 2 dx" would add 4 (plane) or 6 (space) of squared length 4.
  using Shells = std::map<long, int>;
  EXPECT_EQ(bonds_by_squared_length<2>(equal), (Shells{{1, 4}, {2, 4}}));
  EXPECT_EQ(bonds_by_squared_length<2>(isotropic), (Shells{{1, 4}, {2, 4}}));
  EXPECT_EQ(bonds_by_squared_length<3>(equal), (Shells{{1, 6}, {2, 12}, {3, 8}}));
  EXPECT_EQ(bonds_by_squared_length<3>(isotropic), (Shells{{1, 6}, {2, 12}}));
}

}  // namespace
