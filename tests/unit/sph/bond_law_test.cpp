// Strain stiffening, viscoelastic branch and fibres against closed forms.
#include "sph/effects/elastic_solid.hpp"
#include "sph/effects/fibre.hpp"
#include "sph/effects/stiffening.hpp"
#include "sph/effects/viscoelastic.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

constexpr double stiffness = 2.0e3;  // N/m
constexpr double rest = 0.5;         // m

struct Response {
  double tension, slope;
};

Response response(const BondLaw& law, double extension) {
  const std::vector<double> e{extension};
  std::vector<double> tension{0.0}, slope{0.0};
  law.add_tension(e, tension, slope);
  return {tension[0], slope[0]};
}

TEST(Stiffening, SlopeGrowsLinearlyThroughTheToe) {
  const Stiffening law(0, {stiffness}, {rest}, {5.0, 0.1});
  // Beside the linear spring: slope 4 k e/toe up to 4 k; tension its integral.
  const double toe = 0.1 * rest;
  EXPECT_DOUBLE_EQ(response(law, 0.5 * toe).slope, 2.0 * stiffness);
  EXPECT_DOUBLE_EQ(response(law, 0.5 * toe).tension, 4.0 * stiffness * 0.125 * toe);
  EXPECT_DOUBLE_EQ(response(law, 3.0 * toe).slope, 4.0 * stiffness);
  EXPECT_DOUBLE_EQ(response(law, 3.0 * toe).tension, 4.0 * stiffness * 2.5 * toe);
  EXPECT_EQ(response(law, -toe).tension, 0.0);
  EXPECT_EQ(law.steepest(0), 4.0 * stiffness);
}

TEST(Stiffening, EnergyIsTheIntegralOfTheTension) {
  const Stiffening law(0, {stiffness}, {rest}, {3.0, 0.2});
  for (const double e : {-0.05, 0.02, 0.0999, 0.13, 0.4}) {
    const std::vector<double> after{e + 1e-6}, before{e - 1e-6};
    EXPECT_NEAR((law.energy(after) - law.energy(before)) / 2e-6, response(law, e).tension,
                1e-6 * stiffness)
        << e;
  }
}

/// A branch of one bond whose owner is one particle.
struct Branch {
  Particles<2> particles = test::particles_at<2>({{0.0, 0.0}}, 0.1, Role::solid);
  Viscoelastic<2> law;
  explicit Branch(double relaxation_time)
      : law(0, {stiffness}, {0}, 0.6, relaxation_time, particles, "test") {}
  void move(double before, double now, double dt) {
    law.advance(std::vector{before}, std::vector{now}, dt);
  }
};

// A sudden stretch relaxes as exp(-t/tau), whatever the step.
TEST(Viscoelastic, RelaxesExponentially) {
  for (const double dt : {0.01, 0.1, 1.0}) {
    Branch branch(0.5);
    branch.move(0.0, 0.02, 1e-9);
    for (int k = 0; k < std::lround(1.0 / dt); ++k) branch.move(0.02, 0.02, dt);
    // The stretch took 1e-9 s of 0.5 s.
    EXPECT_NEAR(response(branch.law, 0.02).tension / (0.6 * stiffness * 0.02), std::exp(-2.0), 1e-8)
        << dt;
  }
}

// Stretched at a steady rate the branch pulls k r v tau (1 - exp(-t/tau)): a dashpot in the end.
TEST(Viscoelastic, BecomesADashpotAtASteadyRate) {
  Branch branch(0.5);
  const double rate = 0.3, dt = 0.07;
  double e = 0.0;
  for (int k = 0; k < 10; ++k, e += rate * dt) branch.move(e, e + rate * dt, dt);
  EXPECT_NEAR(response(branch.law, e).tension,
              0.6 * stiffness * rate * 0.5 * (1.0 - std::exp(-0.7 / 0.5)), 1e-9 * stiffness);
}

TEST(Viscoelastic, ItsMemoryIsCarriedWithTheParticles) {
  Branch branch(0.5);
  branch.move(0.0, 0.02, 1e-9);
  ASSERT_EQ(branch.particles.carried.size(), 1u);
  EXPECT_EQ(branch.particles.carried[0].name, "viscoelastic_test_0");
  EXPECT_NEAR((*branch.particles.carried[0].values)[0][0], 0.02, 1e-9);
}

template <int dim>
double energy_under(const ElasticNetwork<dim>& network,
                    const Eigen::Matrix<double, dim, dim>& strain) {
  auto position = network.reference;
  for (auto& x : position) x += (strain * x).eval();
  return elastic_energy<dim>(network, position);
}

template <int dim>
void expect_fibre_energy(const std::array<int, dim>& count, double angle, double elevation) {
  constexpr double dx = 0.02, k_e = 3.0e4, modulus = 5.0e5, small = 1e-6;
  const auto particles = test::particles_at<dim>(test::lattice<dim>(count, dx), dx, Role::solid);
  auto network = test::network_of<dim>(particles, count, test::preset("recommended"), k_e);
  const auto plain = network;
  Solid solid = test::solid_block<dim>(count, dx);
  solid.fibre = Fibre{angle, elevation, modulus};
  add_fibres<dim>(network, particles, 0, particles.solids, solid);
  Vector<dim> along = Vector<dim>::Zero();
  along[0] = std::cos(angle) * std::cos(elevation);
  along[1] = std::sin(angle) * std::cos(elevation);
  if constexpr (dim == 3) along[2] = std::sin(elevation);
  Eigen::Matrix<double, dim, dim> strain;
  for (int a = 0; a < dim; ++a)
    for (int b = 0; b < dim; ++b) strain(a, b) = small * std::cos(1.0 + a + b + a * b);
  const double part = along.dot(strain * along);
  const double volume = static_cast<double>(particles.size()) * particles.volume;
  EXPECT_NEAR((energy_under<dim>(network, strain) - energy_under<dim>(plain, strain)) /
                  (0.5 * modulus * part * part * volume),
              1.0, 1e-4);  // strains of 1e-6 differ from those of the bonds by as much, over part
}

TEST(Fibre, AddsItsModulusAlongAnyDirection) {
  for (const double angle : {0.0, 0.4, 1.2, 2.5}) {
    expect_fibre_energy<2>({4, 5}, angle, 0.0);
    expect_fibre_energy<3>({3, 4, 3}, angle, 0.7);
  }
}

}  // namespace
}  // namespace sprung::sph
