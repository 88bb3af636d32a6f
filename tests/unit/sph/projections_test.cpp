/// What a projection leaves of a divergence, and of an inflow's change.

#include "sph/simulation.hpp"
#include "sph/time_step.hpp"
#include "tests/unit/scene/temporary_folder.hpp"
#include "tests/unit/sph/channel_scene.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1;

/// The part of u_x = sin k x, all divergence, that is there after a step; `waves` in 24 spacings.
double left_of_wave(Role role, int projections, int waves) {
  constexpr int side = 24;
  Numerics numerics = test::preset("recommended");
  numerics.shifting = Shifting::none;
  numerics.volume_along_step = false;
  numerics.density_feedback = numerics.void_feedback = 0.0;
  numerics.pressure_tolerance = 1e-12;
  numerics.body_projections = projections;
  auto particles = test::particles_at<2>(test::lattice<2>({side, side}, dx), dx, role);
  const double k = 2.0 * std::numbers::pi * waves / (side * dx);
  // So slow that the lattice stays where it is.
  constexpr double speed = 1e-9;
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.velocity[i][0] = speed * std::sin(k * particles.position[i][0]);
  Simulation<2> simulation(numerics, std::move(particles),
                           Images<2>({}, {{0, 0.0, side * dx}, {1, 0.0, side * dx}}));
  simulation.start(1.0, 1e-3);
  advance(simulation);
  const auto& after = simulation.state().particles;
  double sum = 0.0;
  for (std::size_t i = 0; i < after.size(); ++i)
    sum += after.velocity[i][0] * std::sin(k * after.position[i][0]);
  return sum / (0.5 * side * side * speed);
}

/// R = 1 - D G / A on the infinite lattice: D and G take u to the sum of V F r sin(k r_x), A is the
/// sum of 2 V F (cos(k r_x) - 1) r-free, Eq. 3's.
double left_in_theory(int waves) {
  const double k = 2.0 * std::numbers::pi * waves / (24 * dx);
  const double h = 1.3 * dx;
  Kernel<2> kernel(h);
  kernel.normalise_gradient(lattice_sums(kernel, dx).gradient);
  double first = 0.0, second = 0.0;
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) {
      const double r = dx * std::hypot(i, j);
      if ((i == 0 && j == 0) || r >= kernel.support_radius()) continue;
      const double weight = dx * dx * kernel.gradient_factor(r);
      first += weight * i * dx * std::sin(k * i * dx);
      second += 2.0 * weight * (1.0 - std::cos(k * i * dx));
    }
  return 1.0 - first * first / -second;
}

// Eq. 3's Laplacian is the compact one, so a projection leaves the part R of a wave, n of them R^n.
TEST(Projections, EachLeavesTheSamePartOfAWave) {
  for (const int waves : {1, 3, 6}) {
    const double part = left_in_theory(waves);
    for (const int projections : {1, 2, 3})
      EXPECT_NEAR(left_of_wave(Role::solid, projections, waves), std::pow(part, projections), 2e-4)
          << waves << ' ' << projections;
  }
  EXPECT_GT(left_in_theory(6), 0.5);  // 4 dx long: what springs make beside a face
}

// Without a body one projection is all that a scene pays for.
TEST(Projections, AFluidAloneIsProjectedOnce) {
  EXPECT_EQ(left_of_wave(Role::fluid, 3, 3), left_of_wave(Role::fluid, 1, 3));
}

// A plug between free-slip walls follows an inflow whose speed grows evenly. With the columns' plain
// new velocity it has half of it after the first step and comes to be one step late (0.88 after
// five). What is left is the average's: within the kernel's reach the fluid is not yet as fast as
// behind.
TEST(Projections, APlugFollowsAnInflowThatGrows) {
  test::ChannelScene scene;
  scene.beam = false;
  scene.walls = "free_slip";
  scene.profile = "uniform";
  scene.spacing = 0.03;
  scene.numerics = "pressure_tolerance = 1e-10";
  scene.sph = "time_step = \"1 ms\"";
  const sprung::test::TemporaryFolder folder;
  Document document = scene.document();
  auto made = set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
  auto& simulation = *made.simulation;
  for (int n = 1; n <= 5; ++n) {
    advance(simulation);
    const auto& particles = simulation.state().particles;
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < particles.unknowns; ++i)
      if (std::abs(particles.position[i][0] - 0.45) < 0.2) {
        sum += particles.velocity[i][0];
        ++count;
      }
    constexpr double change = 0.5 * 1e-3;  // of the inflow's velocity in a step, m/s
    EXPECT_NEAR(sum / count / change, n, 0.25) << n;
  }
}

}  // namespace
}  // namespace sprung::sph
