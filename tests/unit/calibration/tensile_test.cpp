// Blocks pulled through sph/: by the particle solver and by the network alone.
#include "calibration/bulk_modulus.hpp"
#include "calibration/equilibrium.hpp"
#include "calibration/finite_strain.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace sprung;
using namespace sprung::calibration;
using enum sph::Bonds;

double extrapolated(const Material& material, const std::vector<int>& sizes) {
  std::vector<double> value;
  for (const int n : sizes) {
    Pull pull;
    pull.layers = n;
    pull.load = 1e-4;
    pull.smoothing_length_ratio = 1.0;
    value.push_back(pull_block(material, pull).lambda_ends);
  }
  return extrapolate(sizes, value, 2).value;
}

TEST(PulledBlock, ByThePressureEquationHasTheIncompressibleModulus) {
  // Small blocks: the cubic term of 1/n is left out and amounts to some 0.5 %.
  EXPECT_NEAR(extrapolated({2, equal, 0.0}, {12, 16, 20, 28}), 1.5, 0.01);
  EXPECT_NEAR(extrapolated({2, isotropic, 0.0}, {12, 16, 20, 28}), 1.5, 0.01);
}

TEST(PulledBlock, ByThePressureEquationKeepsItsVolume) {
  Pull pull;
  pull.layers = 28;
  pull.load = 1e-3;
  const PulledBlock pulled = pull_by_particle_solver<2>({2, equal, 0.0}, pull);
  EXPECT_NEAR(pulled.core_lateral / pulled.core_axial, -1.0, 5e-3);  // the feedback's own tolerance
  EXPECT_LT(pulled.unbalanced, 1e-4);
}

TEST(PulledBlock, ByAreaSpringsHasTheModulusOfTheNearlyIncompressibleSolid) {
  for (const double kappa : {30.0, 300.0})
    EXPECT_NEAR(extrapolated({2, isotropic, kappa}, {12, 16, 20, 28}),
                1.5 * (2.0 + kappa) / (3.0 + kappa), 1.5e-3)
        << kappa;
}

TEST(PulledBlock, PushedAndPulledAgreeForSmallLoads) {
  Pull pull, push;
  pull.layers = push.layers = 12;
  pull.load = 1e-4;
  push.load = -1e-4;
  const Material material{2, isotropic, 30.0};
  // The quadratic term is of the order of the strain, 5e-5.
  EXPECT_NEAR(
      pull_network<2>(material, pull).strain_ends / pull_network<2>(material, push).strain_ends,
      -1.0, 1e-3);
}

TEST(PulledBar, BeginsToStretchAsTheLattice) {
  const Material lattice{2, isotropic, 0.0}, material{2, isotropic, 300.0};
  for (const double s : {1.004, 0.996}) {
    const double stress = lattice_stress(lattice, Deformation::uniaxial, s) / spring_stiffness;
    // 0.4 % of a plate (plate_test.cpp), and the strain, of which the next term is.
    EXPECT_NEAR((pull_bar<2>(material, 4, {stress}).back() - 1.0) / (s - 1.0), 1.0, 8e-3) << s;
  }
}

TEST(PulledBar, PushedDoesNotTurnOver) {
  // A free body under forces that push keeps its equilibrium only where nothing turns it; let, it
  // came to rest head over heels, with a "stretch" of -1.09.
  const auto stretch = pull_bar<2>({2, isotropic, 300.0}, 4, {-0.1, -0.2, -0.3});
  for (const double s : stretch) EXPECT_GT(s, 0.8);
  EXPECT_LT(stretch[2], stretch[1]);
}

TEST(PoissonRatio, OfTheSolidThatKeepsItsVolumeIsOneHalf) {
  const double s = 1.3;
  EXPECT_NEAR(poisson_ratio(3, s - 1.0, 1.0 / std::sqrt(s) - 1.0), 0.5, 1e-12);
  EXPECT_NEAR(poisson_ratio(2, s - 1.0, 1.0 / s - 1.0), 0.5, 1e-12);
}

TEST(PoissonRatio, OfVolumeSpringsDoesNotDependOnTheBlocksSize) {
  // Lame's first constant (1 + kappa) G: nu = (1 + kappa)/(2 (2 + kappa)) = 0.49834. Every cell
  // keeps its volume to 1/kappa, and the mean over cells adds up their volumes, however unevenly
  // they strain; 5e-4 is what the strain of 4 % adds to second order in its unevenness. The
  // least-squares gradient of the particles says 0.473 for 6 layers and 0.491 for 8.
  for (const int layers : {6, 8}) {
    Pull pull;
    pull.layers = layers;
    pull.load = 0.1;
    pull.load_steps = 2;
    const PulledBlock b = pull_network<3>({3, isotropic, 300.0}, pull);
    EXPECT_NEAR(poisson_ratio(3, b.mean_axial, b.mean_lateral), 301.0 / 604.0, 5e-4) << layers;
  }
}

// Sums of the Wendland kernel over the stretched lattice written down independently (NumPy, all
// sites within four spacings, bisection for the lateral stretch); four digits.
TEST(PoissonRatio, ThatTheKernelsSumKeeps) {
  EXPECT_NEAR(kernel_sum_poisson_ratio<3>(1.0, 0.068), 0.4887, 1e-4);
  EXPECT_NEAR(kernel_sum_poisson_ratio<3>(1.0, -0.06), 0.5074, 1e-4);
  EXPECT_NEAR(kernel_sum_poisson_ratio<3>(1.3, 0.068), 0.4974, 1e-4);
  EXPECT_NEAR(kernel_sum_poisson_ratio<2>(1.3, 0.043), 0.4977, 1e-4);
  EXPECT_NEAR(kernel_sum_poisson_ratio<3>(1.0, 1e-4), 0.5, 1e-4);  // first order keeps the volume
}

TEST(Equilibrium, StretchesAChainByForceOverStiffness) {
  // Two rows of n particles: per period two bonds along and one square of diagonals; here only the
  // resultant counts.
  const std::array<int, 2> count{6, 2};
  auto particles = block<2>(count, 1e-3);
  const auto network = network_of<2>(particles, shape_of<2>(count, 1e-3), {2, equal, 0.0});
  std::vector<Vector<2>> load(particles.size(), Vector<2>::Zero());
  for (const std::size_t i : {0, 6}) load[i][0] = -1e-3, load[i + 5][0] = 1e-3;
  EXPECT_LT(find_equilibrium<2>(network, particles, load), 1e-5);
  std::vector<Vector<2>> force;
  sph::elastic_forces<2>(network, particles.position, force);
  // Cut between columns 2 and 3: the bonds carry the two loads.
  EXPECT_NEAR(force[0][0], 1e-3, 1e-8);
  EXPECT_NEAR(force[6][0], 1e-3, 1e-8);
  EXPECT_GT(particles.position[5][0] - particles.position[0][0], 5e-3);
}

TEST(Equilibrium, RefusesALoadThatTheSpringsCannotCarry) {
  const std::array<int, 2> count{6, 2};
  auto particles = block<2>(count, 1e-3);
  const auto network = network_of<2>(particles, shape_of<2>(count, 1e-3), {2, equal, 0.0});
  std::vector<Vector<2>> load(particles.size(), Vector<2>::Zero());
  load[0][0] = 1.0;  // no counterforce: a free body has no equilibrium
  EXPECT_THROW(find_equilibrium<2>(network, particles, load), std::runtime_error);
}

}  // namespace
