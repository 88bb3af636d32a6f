// Stress against stretch of the spring lattice: its own law, written out by hand, and its distance
// from the neo-Hookean solid.
#include "calibration/finite_strain.hpp"
#include "sph/effects/calibrated_strain.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace sprung;
using namespace sprung::calibration;
using enum sph::Bonds;
using enum Deformation;

const Material space{3, isotropic, 0.0};
constexpr double g = spring_stiffness;  // G = k_e of the isotropic lattice in space

// Per particle of the isotropic lattice: 3 bonds along the axes, 2 diagonals in each plane, each
// k_e dx (length - rest length)2/2; d/ds along each path, lengths in dx.
TEST(SpringLaw, OfAUniaxialPullInSpace) {
  for (const double s : {0.7, 0.9, 1.1, 1.3}) {
    const double t = std::pow(s, -0.5), dt = -0.5 * std::pow(s, -1.5);
    const double oblique = std::sqrt(s * s + t * t), rest = std::sqrt(2.0);
    const double law = (s - 1.0) + 2.0 * (t - 1.0) * dt +
                       4.0 * (oblique - rest) * (s + t * dt) / oblique +
                       2.0 * rest * rest * (t - 1.0) * dt;
    // Central differences with steps of 1e-5.
    EXPECT_NEAR(lattice_stress(space, uniaxial, s) / spring_stiffness, law, 1e-8) << s;
  }
}

TEST(SpringLaw, OfSimpleShearInSpace) {
  for (const double shear : {0.1, 0.3, 0.6}) {
    const double rest = std::sqrt(2.0), along = std::sqrt(1.0 + shear * shear);
    const double longer = std::sqrt((1.0 + shear) * (1.0 + shear) + 1.0);
    const double shorter = std::sqrt((1.0 - shear) * (1.0 - shear) + 1.0);
    const double out = std::sqrt(2.0 + shear * shear);  // the two diagonals of the plane of y and z
    const double law = (along - 1.0) * shear / along + (longer - rest) * (1.0 + shear) / longer -
                       (shorter - rest) * (1.0 - shear) / shorter +
                       2.0 * (out - rest) * shear / out;
    EXPECT_NEAR(lattice_stress(space, simple_shear, shear) / spring_stiffness, law, 1e-8) << shear;
  }
}

TEST(SpringLaw, BeginsAsTheNeoHookeanSolid) {
  const double s = 1e-3;
  for (const auto deformation : {uniaxial, equibiaxial, pure_shear})
    // The next term is of the order of the strain.
    EXPECT_NEAR(lattice_stress(space, deformation, 1.0 + s) /
                    neo_hookean_stress(3, g, deformation, 1.0 + s),
                1.0, 3.0 * s)
        << to_string(deformation);
  EXPECT_NEAR(lattice_stress(space, simple_shear, s) / (g * s), 1.0, 3.0 * s);
  EXPECT_NEAR(lattice_stress({2, isotropic, 300.0}, uniaxial, 1.0 + s) /
                  neo_hookean_stress(2, 0.5 * spring_stiffness, uniaxial, 1.0 + s),
              1.0, 3.0 * s);
}

// sph::calibrated_strain: 1 % of the stress to there, more than that at half as much again, of one
// of the lattices at least.
TEST(CalibratedStrain, IsWhereTheStressIsOffByOnePerCent) {
  for (const int dimension : {2, 3}) {
    double worst_beyond = 0.0;
    for (const auto bonds : {equal, isotropic}) {
      const Material material{dimension, bonds, 0.0};
      const auto ratio = [&](double strain) {
        return lattice_stress(material, uniaxial, 1.0 + strain) /
               neo_hookean_stress(dimension, 1.0, uniaxial, 1.0 + strain);
      };
      const double at_rest = 0.5 * (ratio(1e-4) + ratio(-1e-4));
      const double range = sph::calibrated_strain(dimension);
      for (const double sign : {-1.0, 1.0}) {
        // The paper's bonds in the plane: 1.2 % at -5 %.
        EXPECT_NEAR(ratio(sign * range) / at_rest, 1.0, 0.0125);
        worst_beyond = std::max(worst_beyond, std::abs(ratio(sign * 1.5 * range) / at_rest - 1.0));
      }
    }
    EXPECT_GT(worst_beyond, 0.0125) << dimension;
  }
}

}  // namespace
