/// What drives a flow beside inflow: uniform forces and moving walls.

#include "sph/effects/gravity.hpp"
#include "sph/effects/moving_walls.hpp"
#include "sph/effects/viscosity.hpp"
#include "sph/probes.hpp"
#include "sph/simulation.hpp"
#include "sph/time_step.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1;

/// A block of `side` particles a side, periodic along the first `periodic_axes` axes and between
/// walls along the rest, under a uniform force.
template <int dim>
Simulation<dim> block_under_gravity(const Numerics& numerics, int periodic_axes, double jitter,
                                    const Gravity& gravity, bool no_slip, double dt) {
  constexpr int side = dim == 2 ? 10 : 6;
  std::array<int, dim> count;
  count.fill(side);
  auto particles = test::particles_at<dim>(test::lattice<dim>(count, dx, jitter, 6), dx);
  std::vector<Wall<dim>> walls;
  std::vector<PeriodicAxis> periodic;
  for (int d = 0; d < dim; ++d) {
    if (d < periodic_axes) {
      periodic.push_back({d, 0.0, side * dx});
      continue;
    }
    walls.push_back({d, 0.0, 1, no_slip, Vector<dim>::Zero()});
    walls.push_back({d, side * dx, -1, no_slip, Vector<dim>::Zero()});
  }
  Simulation<dim> simulation(numerics, std::move(particles), Images<dim>(walls, periodic));
  auto effect = std::make_unique<GravityEffect<dim>>(gravity, periodic);
  EXPECT_EQ(effect->drives(), periodic_axes > 0);
  simulation.effects().time_dependence.push_back(effect.get());
  simulation.effects().body_forces.push_back(std::move(effect));
  simulation.start(1.0, dt);
  return simulation;
}

template <int dim>
void expect_rest(const Numerics& numerics, double jitter, bool no_slip) {
  Point g{3.0, -9.81, 0.0};
  if (dim == 3) g[2] = 1.5;
  auto simulation = block_under_gravity<dim>(numerics, 0, jitter, {g, Waveform{}}, no_slip, 0.01);
  const auto start = simulation.state().particles.position;
  for (int n = 0; n < 10; ++n) advance(simulation);
  const auto& state = simulation.state();
  const auto& particles = state.particles;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    EXPECT_EQ(particles.velocity[i], Vector<dim>::Zero().eval());
    // grad p = rho g, exactly: rho g . x and a constant.
    const double expected = 1000.0 * as_vector<dim>(g).dot(particles.position[i]);
    EXPECT_NEAR(state.pressure(i) - state.pressure(0),
                expected - 1000.0 * as_vector<dim>(g).dot(particles.position[0]), 1e-9);
  }
  // By the probe as well, between particles and at the wall.
  const std::vector<Vector<dim>> places{Vector<dim>::Constant(0.31), Vector<dim>::Constant(0.0),
                                        Vector<dim>::Constant(0.55)};
  const auto pressure = pressure_at(state, places);
  for (std::size_t k = 1; k < places.size(); ++k)
    EXPECT_NEAR(pressure[k] - pressure[0], 1000.0 * as_vector<dim>(g).dot(places[k] - places[0]),
                1e-8);
}

// The density feedback is off: disorder alone would set the particles in motion, and on the lattice
// the round-off of its own sums.
TEST(Gravity, AFluidAtRestStaysAtRestToTheLastBit) {
  for (const std::string preset : {"recommended", "paper"}) {
    Numerics numerics = test::preset(preset);
    numerics.density_feedback = numerics.void_feedback = 0.0;
    for (const bool no_slip : {true, false})
      for (const double jitter : {0.0, 0.2}) {
        expect_rest<2>(numerics, jitter, no_slip);
        expect_rest<3>(numerics, jitter, no_slip);
      }
  }
}

TEST(Gravity, WithFeedbackTheLatticeStaysUpToRoundOff) {
  auto simulation = block_under_gravity<2>(test::preset("recommended"), 0, 0.0,
                                           {{0.0, -9.81, 0.0}, Waveform{}}, true, 0.01);
  for (int n = 0; n < 20; ++n) advance(simulation);
  for (const auto& u : simulation.state().particles.velocity) EXPECT_LT(u.norm(), 1e-12);
}

TEST(Gravity, TheBalancedPartFollowsItsWaveform) {
  auto simulation =
      block_under_gravity<2>(test::preset("recommended"), 0, 0.0,
                             {{0.0, -8.0, 0.0}, Waveform::from_formula("1 - t")}, true, 0.25);
  EXPECT_EQ(simulation.state().balanced_acceleration, Vector<2>(0.0, -8.0));
  advance(simulation);
  EXPECT_EQ(simulation.state().balanced_acceleration, Vector<2>(0.0, -6.0));
}

// Along periodic axes nothing balances the force: u = a t wherever no wall rubs, also on a
// disordered distribution, for a uniform velocity has no divergence.
template <int dim>
void expect_fall(int periodic_axes) {
  Point a{0.5, 0.25, 0.0};
  for (int d = periodic_axes; d < 3; ++d) a[d] = 0.0;
  const double dt = 0.02;
  Numerics numerics = test::preset("recommended");
  numerics.density_feedback = numerics.void_feedback = 0.0;
  auto simulation =
      block_under_gravity<dim>(numerics, periodic_axes, 0.2, {a, Waveform{}}, false, dt);
  const double length = (dim == 2 ? 10 : 6) * dx;
  for (int n = 1; n <= 20; ++n) {
    advance(simulation);
    const auto& particles = simulation.state().particles;
    ASSERT_EQ(particles.unknowns, particles.size());
    for (std::size_t i = 0; i < particles.size(); ++i) {
      ASSERT_LT((particles.velocity[i] - n * dt * as_vector<dim>(a)).norm(), 1e-13) << n;
      for (int d = 0; d < periodic_axes; ++d) {
        ASSERT_GE(particles.position[i][d], 0.0);
        ASSERT_LE(particles.position[i][d], length);
      }
    }
  }
}

TEST(Gravity, DrivesTheFlowAlongAPeriodicAxis) {
  expect_fall<2>(1);
  expect_fall<2>(2);
  expect_fall<3>(2);
}

// The force of a step is that of its middle: exact for a force linear in time, u = a t^2 / 2.
TEST(Gravity, TheDrivingPartFollowsItsWaveform) {
  Numerics numerics = test::preset("recommended");
  numerics.density_feedback = numerics.void_feedback = 0.0;
  auto simulation = block_under_gravity<2>(
      numerics, 1, 0.0, {{0.5, 0.0, 0.0}, Waveform::from_formula("t")}, false, 0.1);
  for (int n = 0; n < 12; ++n) advance(simulation);
  for (const auto& u : simulation.state().particles.velocity)
    EXPECT_NEAR(u[0], 0.5 * 1.2 * 1.2 / 2.0, 1e-13);
}

TEST(MovingWalls, HaveTheirVelocityTimesTheWaveform) {
  State<2> state{test::particles_at<2>({{0.5, 0.95}}, dx),
                 Images<2>(test::walls_of_box<2>({1.0, 1.0}, true)),
                 {},
                 Kernel<2>(1.3 * dx),
                 {},
                 Vector<2>::Zero(),
                 {},
                 {}};
  MovingWalls<2> effect({{Side::top, {2.0, 0.0, 0.0}, Waveform::from_formula("min(t/0.1, 1)")},
                         {Side::left, {0.0, -1.0, 0.0}, Waveform{}}},
                        state.images);
  for (const auto& [time, factor] : {std::pair{0.0, 0.0}, {0.05, 0.5}, {3.0, 1.0}}) {
    state.clock.time = time;
    effect.set(state);
    for (const auto& wall : state.images.walls()) {
      Vector<2> expected = Vector<2>::Zero();
      if (wall.axis == 1 && wall.inward == -1) expected = {2.0 * factor, 0.0};
      if (wall.axis == 0 && wall.inward == 1) expected = {0.0, -1.0};
      EXPECT_NEAR((wall.velocity - expected).norm(), 0.0, 1e-15) << time;
    }
  }
}

// Plane Couette flow is linear: the mirrors continue it, and nothing changes it. The same for a
// frame of reference that moves along.
TEST(MovingWalls, CouetteFlowStays) {
  for (const double frame : {0.0, -3.0}) {
    auto particles = test::particles_at<2>(test::lattice<2>({8, 10}, dx), dx);
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.velocity[i] = {frame + 2.0 * particles.position[i][1], 0.0};
    std::vector<Wall<2>> walls{{1, 0.0, 1, true, Vector<2>::Zero()},
                               {1, 1.0, -1, true, Vector<2>::Zero()}};
    Simulation<2> simulation(test::preset("recommended"), std::move(particles),
                             Images<2>(walls, {{0, 0.0, 0.8}}));
    auto motion = std::make_unique<MovingWalls<2>>(
        std::vector<WallMotion>{{Side::top, {frame + 2.0, 0.0, 0.0}, Waveform{}},
                                {Side::bottom, {frame, 0.0, 0.0}, Waveform{}}},
        simulation.state().images);
    simulation.effects().time_dependence.push_back(motion.get());
    simulation.effects().prescriptions.push_back(std::move(motion));
    auto viscosity =
        std::make_unique<ViscosityEffect<2>>(0.1, simulation.state().particles, nullptr);
    simulation.effects().diffusion.push_back(std::move(viscosity));
    simulation.start(2.0, 1e-3);
    advance(simulation);
    const auto& p = simulation.state().particles;
    for (std::size_t i = 0; i < p.size(); ++i)
      EXPECT_NEAR((p.velocity[i] - Vector<2>(frame + 2.0 * p.position[i][1], 0.0)).norm(), 0.0,
                  1e-11);
  }
}

}  // namespace
}  // namespace sprung::sph
