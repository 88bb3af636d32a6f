/// The block in space against closed forms of incompressible and compressible neo-Hookean solids.

#include "reference_fem/solid_block.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sprung::reference {
namespace {

// Newton's method stops at a correction of 1e-12 of the displacement; round-off of the direct
// solver leaves some digits less. Issue 5 asks for 1e-6.
constexpr double tight = 1e-8;

SolidBlock cube(double youngs_modulus) {
  SolidBlock block;
  block.youngs_modulus = youngs_modulus;
  block.increments = 3;
  return block;
}

TEST(SolidBlock, UniaxialTensionAndCompressionOfTheIncompressibleCube) {
  for (const double stress : {3e4, -3e4}) {
    SolidBlock block = cube(1e5);
    block.stress = {stress, 0.0, 0.0};
    for (const BlockState& s : solve_block(block)) {
      // Nominal stress G (s - s^-2), G = E/3; the sides draw in by s^-1/2.
      EXPECT_NEAR(s.load * stress, uniaxial_stress(1e5, s.stretch[0]), tight * std::abs(stress));
      EXPECT_NEAR(s.nominal[0], s.load * stress, tight * std::abs(stress));
      EXPECT_NEAR(s.stretch[1], 1.0 / std::sqrt(s.stretch[0]), tight);
      EXPECT_NEAR(s.volume_ratio, 1.0, tight);
      EXPECT_NEAR(s.spread[0], 0.0, tight);
    }
  }
}

TEST(SolidBlock, FollowingStressGivesTheTrueOne) {
  SolidBlock block = cube(1e5);
  block.stress = {2e4, 0.0, 0.0};
  block.follows = true;
  // True stress G (s^2 - 1/s): the nominal one over the deformed area 1/s.
  for (const BlockState& s : solve_block(block))
    EXPECT_NEAR(s.load * 2e4, 1e5 / 3.0 * (s.stretch[0] * s.stretch[0] - 1.0 / s.stretch[0]),
                tight * 2e4);
}

TEST(SolidBlock, EquibiaxialTension) {
  SolidBlock block = cube(1e5);
  block.stress = {1e4, 1e4, 0.0};
  // s = s_x = s_y, s_z = 1/s^2: nominal stress G (s - s^-5).
  for (const BlockState& s : solve_block(block))
    EXPECT_NEAR(s.load * 1e4, 1e5 / 3.0 * (s.stretch[0] - std::pow(s.stretch[0], -5.0)),
                tight * 1e4);
}

TEST(SolidBlock, SimpleShear) {
  SolidBlock block = cube(1e5);
  block.shear = 0.4;
  for (const BlockState& s : solve_block(block)) {
    // Energy G gamma^2/2 per volume, shear stress P_01 = G gamma.
    EXPECT_NEAR(s.shear_stress, 1e5 / 3.0 * 0.4 * s.load, tight * 1e5);
    EXPECT_NEAR(s.energy, 0.5 * 1e5 / 3.0 * std::pow(0.4 * s.load, 2) * 1e-3, tight);
    EXPECT_NEAR(s.volume_ratio, 1.0, tight);
  }
}

TEST(SolidBlock, CompressibleUniaxialTension) {
  SolidBlock block = cube(1e5);
  block.poisson_ratio = 0.3;
  block.stress = {3e4, 0.0, 0.0};
  const BlockState s = solve_block(block).back();
  // P_ii = G (s_i - 1/s_i) + lambda (J - 1) J/s_i, none on the sides.
  const double g = 1e5 / 2.6, lambda = 2.0 * g * 0.3 / 0.4, j = s.volume_ratio;
  EXPECT_NEAR(g * (s.stretch[0] - 1.0 / s.stretch[0]) + lambda * (j - 1.0) * j / s.stretch[0], 3e4,
              tight * 3e4);
  EXPECT_NEAR(g * (s.stretch[1] - 1.0 / s.stretch[1]) + lambda * (j - 1.0) * j / s.stretch[1], 0.0,
              tight * 3e4);
  EXPECT_NEAR(s.stretch[1], s.stretch[2], tight);
}

TEST(SolidBlock, GluedFacesConverge) {
  // A field that is not uniform: apparent stiffness of a glued, incompressible cube on three
  // meshes.
  double stretch[3];
  for (int level = 0; level < 3; ++level) {
    SolidBlock block = cube(1e5);
    block.stress = {1e4, 0.0, 0.0};
    block.glued = true;
    block.increments = 1;
    block.cells.fill(1 << level);
    const BlockState s = solve_block(block).back();
    stretch[level] = s.stretch[0];
    EXPECT_NEAR(s.volume_ratio, 1.0, tight);  // discontinuous pressures: cell by cell
  }
  // Glue hinders the sides: stiffer than the free cube at the same stress (stretch 1.1107).
  EXPECT_LT(stretch[2], 1.1);
  // The glued edges are singular, so no more is asked than that refinement changes ever less.
  EXPECT_LT(std::abs(stretch[2] - stretch[1]), 0.7 * std::abs(stretch[1] - stretch[0]));
}

TEST(SolidBlock, RefusesWhatMakesNoSense) {
  EXPECT_THROW(solve_block(cube(0.0)), std::invalid_argument);
  SolidBlock block = cube(1e5);
  block.poisson_ratio = 0.6;
  EXPECT_THROW(solve_block(block), std::invalid_argument);
  block = cube(1e5);
  block.shear = 0.1;
  block.stress = {1.0, 0.0, 0.0};
  EXPECT_THROW(solve_block(block), std::invalid_argument);
}

}  // namespace
}  // namespace sprung::reference
