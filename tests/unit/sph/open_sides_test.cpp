#include "sph/boundary/open_sides.hpp"

#include "sph/effects/gravity.hpp"
#include "sph/simulation.hpp"
#include "sph/time_step.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

Box box(double length, double height, double depth = 0.0) {
  return {{0.0, 0.0, 0.0}, {length, height, depth}};
}

Inflow eq_6(Side side = Side::left) {
  return {side, Inflow::Profile::parabolic, 0.5, 1.0, {}};
}

// Eq. 6: 1.5 u y (H - y)/(H/2)^2 min(t/t*, 1) with u = 0.5 m/s, H = 0.3 m, t* = 1 s.
TEST(InflowSide, HasTheVelocityOfEquation6) {
  const InflowSide<2> side(eq_6(), box(0.9, 0.3), 0.01, 0.026);
  const auto u = [&](double y, double t) { return side.velocity_at({-0.005, y}, t); };
  EXPECT_NEAR(u(0.15, 1.0)[0], 0.75, 1e-15);
  EXPECT_NEAR(u(0.15, 3.0)[0], 0.75, 1e-15);
  EXPECT_NEAR(u(0.15, 0.2)[0], 0.15, 1e-15);
  EXPECT_NEAR(u(0.075, 1.0)[0], 0.5625, 1e-15);
  EXPECT_NEAR(u(0.03, 0.5)[0], 0.135, 1e-15);
  EXPECT_NEAR(u(0.0, 1.0)[0], 0.0, 1e-15);
  EXPECT_NEAR(u(0.3, 1.0)[0], 0.0, 1e-15);
  EXPECT_EQ(u(0.15, 0.0)[0], 0.0);
  EXPECT_EQ(u(0.15, 1.0)[1], 0.0);
  // What 30 rows carry: mean velocity times height, 0.15 m2/s, and 1/(2 n^2) of it more, the
  // midpoint rule's error of a parabola.
  EXPECT_NEAR(side.flux(1.0), 0.15 * (1.0 + 1.0 / 1800.0), 1e-15);
  EXPECT_NEAR(side.flux(0.4), 0.06 * (1.0 + 1.0 / 1800.0), 1e-15);
}

TEST(InflowSide, PointsInwardsOnEverySide) {
  const Vector<2> expected[] = {{0.75, 0.0}, {-0.75, 0.0}, {0.0, 0.75}, {0.0, -0.75}};
  const Vector<2> middle[] = {{0.0, 0.2}, {0.4, 0.2}, {0.2, 0.0}, {0.2, 0.4}};
  int k = 0;
  for (const Side side : {Side::left, Side::right, Side::bottom, Side::top}) {
    const InflowSide<2> inflow(eq_6(side), box(0.4, 0.4), 0.02, 0.052);
    EXPECT_NEAR((inflow.velocity_at(middle[k], 1.0) - expected[k]).norm(), 0.0, 1e-15) << k;
    // Outside by three quarters of the spacing, by a hair (carried in again), and inside.
    EXPECT_TRUE(inflow.upstream(middle[k] - 0.02 * expected[k]));
    EXPECT_FALSE(inflow.upstream(middle[k] - 0.002 * expected[k]));
    EXPECT_FALSE(inflow.upstream(middle[k] + 0.02 * expected[k]));
    ++k;
  }
}

TEST(InflowSide, FillsTheColumnsThatTheSupportReaches) {
  // Reach 2.6 dx: three columns; exactly 2 dx (the paper's 2h at h = dx): two, and no third by
  // rounding.
  for (const auto& [reach, columns] : {std::pair{0.026, 3u}, {2.0 * 0.01, 2u}, {0.0201, 3u}}) {
    Particles<2> particles = test::particles_at<2>({{0.1, 0.1}}, 0.01);
    const InflowSide<2> side(eq_6(), box(0.9, 0.3), 0.01, reach);
    side.fill(particles);
    ASSERT_EQ(particles.size(), 1u + 30u * columns);
    for (std::size_t i = 1; i < particles.size(); ++i) {
      EXPECT_EQ(particles.role[i], Role::inflow);
      EXPECT_LT(particles.position[i][0], 0.0);
      EXPECT_GT(particles.position[i][0], -0.01 * columns);
    }
  }
}

TEST(InflowSide, AParticleThatEntersIsFollowedByANewOne) {
  Particles<2> particles = test::particles_at<2>({{0.005, 0.15}}, 0.01);
  const InflowSide<2> side(eq_6(), box(0.9, 0.3), 0.01, 0.026);
  side.fill(particles);
  const std::size_t before = particles.size();
  ParticleBooks books;
  side.exchange(particles, 1.0, books);
  EXPECT_EQ(particles.size(), before);  // nothing has crossed yet
  std::size_t entering = 0;
  for (std::size_t i = 1; i < before; ++i)
    if (std::abs(particles.position[i][0] + 0.005) < 1e-12 &&
        std::abs(particles.position[i][1] - 0.145) < 1e-12)
      entering = i;
  ASSERT_GT(entering, 0u);
  particles.position[entering][0] = 0.002;
  side.exchange(particles, 1.0, books);
  EXPECT_EQ(books.entered, 1);
  EXPECT_EQ(particles.role[entering], Role::fluid);
  ASSERT_EQ(particles.size(), before + 1);
  // Three columns behind, in its row, so that the spacing of the row is kept.
  EXPECT_NEAR((particles.position.back() - Vector<2>(0.002 - 0.03, 0.145)).norm(), 0.0, 1e-15);
  EXPECT_EQ(particles.role.back(), Role::inflow);
  EXPECT_EQ(particles.identity.back(), static_cast<std::int64_t>(before));
}

TEST(PressureColumns, ExchangesRolesAndKeepsBooks) {
  Particles<2> particles = test::particles_at<2>({{0.88, 0.1}, {0.89, 0.1}}, 0.01);
  const PressureColumns<2> side({Side::right, 40.0, {}}, box(0.9, 0.3), 0.01, 0.026);
  EXPECT_NEAR(side.depth(), 0.03, 1e-15);
  side.fill(particles);
  ASSERT_EQ(particles.size(), 2u + 90u);
  side.prescribe(particles, 0.0, Vector<2>::Zero());
  // psi = -p/rho.
  for (std::size_t i = 2; i < particles.size(); ++i)
    EXPECT_NEAR(particles.pseudo_pressure[i], -0.04, 1e-15);
  particles.position[1][0] = 0.9005;
  for (int k : {5, 6, 7}) particles.position[k][0] -= 0.0055;  // a row moves in
  ParticleBooks books;
  side.exchange(particles, books);
  EXPECT_EQ(particles.role[0], Role::fluid);
  EXPECT_EQ(particles.role[1], Role::outflow);
  EXPECT_EQ(particles.role[5], Role::fluid);
  EXPECT_EQ(books.left, 1);
  EXPECT_EQ(books.returned, 1);
  // The one that became fluid has a follower in the outermost column of its row.
  ASSERT_EQ(particles.size(), 2u + 91u);
  EXPECT_NEAR((particles.position.back() - Vector<2>(0.9295, particles.position[5][1])).norm(), 0.0,
              1e-12);
  EXPECT_FALSE(side.beyond({0.9299, 0.1}));
  EXPECT_TRUE(side.beyond({0.9301, 0.1}));
}

TEST(PressureColumns, ColumnsMoveAsTheMirroredInterior) {
  // A field even about the side, u = 1 + (x - 0.9)^2: the columns must have about the value at
  // their own place. The kernel average of a parabola is high by half the kernel's second moment
  // times its second derivative, about 0.2 h^2 u''; 1.3e-4 here.
  const double dx = 0.01;
  std::vector<Vector<2>> points;
  for (auto x : test::lattice<2>({20, 30}, dx)) points.push_back(x + Vector<2>(0.7, 0.0));
  Particles<2> particles = test::particles_at<2>(points, dx);
  const PressureColumns<2> side({Side::right, 0.0, {}}, box(0.9, 0.3), dx, 0.026);
  side.fill(particles);
  for (std::size_t i = 0; i < particles.unknowns; ++i) {
    const double s = particles.position[i][0] - 0.9;
    particles.velocity[i] = {1.0 + s * s, -0.25};
  }
  side.copy_velocity(particles, Kernel<2>(0.013));
  for (std::size_t i = particles.unknowns; i < particles.size(); ++i) {
    const double s = particles.position[i][0] - 0.9;
    // The column nearest to the side averages over a half-empty support: first order in s there.
    EXPECT_NEAR(particles.velocity[i][0], 1.0 + s * s, 4e-4);
    EXPECT_NEAR(particles.velocity[i][1], -0.25, 1e-14);
  }
}

/// A plug of fluid between free-slip walls that moves with the inflow's uniform velocity.
template <int dim>
Simulation<dim> plug(const Numerics& numerics, double speed, double dt) {
  const double dx = 0.1;
  std::array<int, dim> count;
  count.fill(6);
  count[0] = 12;
  const Box channel = box(1.2, 0.6, dim == 3 ? 0.6 : 0.0);
  auto particles = test::particles_at<dim>(test::lattice<dim>(count, dx), dx);
  for (auto& u : particles.velocity) u[0] = speed;
  auto walls = test::walls_of_box<dim>(Vector<dim>::Constant(0.6), false);
  walls.erase(walls.begin(), walls.begin() + 2);
  Simulation<dim> simulation(numerics, std::move(particles), Images<dim>(walls));
  const double reach = simulation.state().kernel.support_radius();
  simulation.add_inflow(
      {{Side::left, Inflow::Profile::uniform, speed, 0.0, {}}, channel, dx, reach});
  simulation.add_pressure_side({{Side::right, 0.0, {}}, channel, dx, reach});
  simulation.start(speed, dt);
  return simulation;
}

// A uniform stream has no divergence, no pressure and no reason to change: the lattice goes in at
// one end and out at the other. 80 steps of 0.137 dx: eleven columns enter and eleven leave.
template <int dim>
void expect_undisturbed(const Numerics& numerics) {
  const double dx = 0.1, speed = 0.7, dt = 0.137 * dx / speed;
  auto simulation = plug<dim>(numerics, speed, dt);
  const auto& particles = simulation.state().particles;
  const std::size_t count = particles.unknowns;
  for (int n = 1; n <= 80; ++n) {
    advance(simulation);
    ASSERT_EQ(particles.unknowns, count) << "step " << n;
  }
  const double travelled = 80 * 0.137 * dx;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    // Round-off grows by some ulp a step; the pressure's tolerance does not matter, its source is
    // zero.
    ASSERT_NEAR((particles.velocity[i] - speed * Vector<dim>::Unit(0)).norm(), 0.0, 1e-9 * speed);
    for (int d = 0; d < dim; ++d) {
      const double site = (particles.position[i][d] - (d == 0 ? travelled : 0.0)) / dx - 0.5;
      ASSERT_NEAR(site, std::round(site), 1e-9);
    }
  }
  const auto& books = simulation.books();
  const std::int64_t row = static_cast<std::int64_t>(count) / 12;
  EXPECT_EQ(books.entered, 11 * row);
  EXPECT_EQ(books.left, 11 * row);
  EXPECT_EQ(books.returned + books.upstream + books.lost, 0);
  EXPECT_NEAR(simulation.remaining_divergence(), 0.0, 1e-8 * speed / dx);
}

// Outwards (u_n, -u_t), which is free of divergence where the mirrored flow is; inwards, and all
// other particles, as they are.
TEST(PressureColumns, MoveOutwardsWithoutPilingUp) {
  const PressureColumns<2> side({Side::right, 0.0, {}}, box(0.9, 0.3), 0.1, 0.2);
  auto particles = test::particles_at<2>({{0.85, 0.1}}, 0.1);
  particles.add({0.95, 0.1}, Vector<2>::Zero(), 0.0, Role::outflow);
  particles.add({0.95, 0.2}, Vector<2>::Zero(), 0.0, Role::outflow);
  particles.add({-0.05, 0.2}, Vector<2>::Zero(), 0.0, Role::outflow);  // another side's
  std::vector<Vector<2>> displacement{{3.0, 2.0}, {3.0, 2.0}, {-3.0, 2.0}, {3.0, 2.0}};
  side.keep_volume(particles, displacement);
  EXPECT_EQ(displacement[0], Vector<2>(3.0, 2.0));
  EXPECT_EQ(displacement[1], Vector<2>(3.0, -2.0));
  EXPECT_EQ(displacement[2], Vector<2>(-3.0, 2.0));
  EXPECT_EQ(displacement[3], Vector<2>(3.0, 2.0));
}

TEST(OpenSides, AUniformStreamPassesUndisturbed) {
  expect_undisturbed<2>(test::preset("recommended"));
  expect_undisturbed<3>(test::preset("recommended"));
}

// As printed h = dx: four lattice neighbours lie at exactly 2h, where the kernel vanishes but the
// sum of the shifting does not; rounding decides which of them count. Without shifting nothing is
// disturbed.
TEST(OpenSides, AUniformStreamPassesUndisturbedAsPrintedWithoutShifting) {
  Numerics numerics = test::preset("paper");
  numerics.shifting = Shifting::none;
  expect_undisturbed<2>(numerics);
}

// --- a pressure at both ends
// ------------------------------------------------------------------------

/// A plug between free-slip walls, open at both ends, 12 particles long.
template <int dim>
Simulation<dim> open_plug(const Numerics& numerics, double speed, const PressureSide& left,
                          const PressureSide& right, double dt) {
  const double dx = 0.1;
  std::array<int, dim> count;
  count.fill(6);
  count[0] = 12;
  const Box channel = box(1.2, 0.6, dim == 3 ? 0.6 : 0.0);
  auto particles = test::particles_at<dim>(test::lattice<dim>(count, dx), dx);
  for (auto& u : particles.velocity) u[0] = speed;
  auto walls = test::walls_of_box<dim>(Vector<dim>::Constant(0.6), false);
  walls.erase(walls.begin(), walls.begin() + 2);
  Simulation<dim> simulation(numerics, std::move(particles), Images<dim>(walls));
  const double reach = simulation.state().kernel.support_radius();
  simulation.add_pressure_side({left, channel, dx, reach});
  simulation.add_pressure_side({right, channel, dx, reach});
  simulation.start(std::abs(speed) > 0.0 ? std::abs(speed) : 1.0, dt);
  return simulation;
}

// Equal pressures at both ends change nothing: whole columns come in at one end and leave at the
// other, either way; those that come in are replaced for as long as one looks.
template <int dim>
void expect_stream_between_pressures(double speed) {
  const double dx = 0.1, dt = 0.137 * dx / std::abs(speed);
  const double pressure = 70.0;
  auto simulation = open_plug<dim>(test::preset("recommended"), speed, {Side::left, pressure, {}},
                                   {Side::right, pressure, {}}, dt);
  const auto& particles = simulation.state().particles;
  const std::size_t count = particles.unknowns, columns = particles.size() - count;
  EXPECT_EQ(columns, 6u * count / 12u);
  for (int n = 1; n <= 80; ++n) {
    advance(simulation);
    ASSERT_EQ(particles.unknowns, count) << "step " << n;
    // Between two replacements the last column downstream may stand just outside or be gone.
    ASSERT_NEAR(double(particles.size() - count), double(columns), double(count) / 12) << n;
  }
  const double travelled = std::copysign(80 * 0.137 * dx, speed);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    ASSERT_NEAR((particles.velocity[i] - speed * Vector<dim>::Unit(0)).norm(), 0.0, 1e-9);
    const double site = (particles.position[i][0] - travelled) / dx - 0.5;
    ASSERT_NEAR(site, std::round(site), 1e-9);
    EXPECT_NEAR(simulation.state().pressure(i), pressure, 1e-7);
  }
  const auto row = static_cast<std::int64_t>(count) / 12;
  EXPECT_EQ(simulation.books().left, 11 * row);
  EXPECT_EQ(simulation.books().returned, 11 * row);
  EXPECT_EQ(simulation.books().lost + simulation.books().upstream, 0);
}

TEST(PressureColumns, AStreamBetweenEqualPressuresPassesEitherWay) {
  expect_stream_between_pressures<2>(0.7);
  expect_stream_between_pressures<2>(-0.7);
  expect_stream_between_pressures<3>(0.7);
  expect_stream_between_pressures<3>(-0.7);
}

// Bernoulli without losses: du/dt = (p_left - p_right)/(rho L), everywhere alike, for the pressures
// act at the sides themselves and a line between them is continued by the columns exactly.
TEST(PressureColumns, ADifferenceOfPressureSetsThePlugInMotion) {
  Numerics numerics = test::preset("recommended");
  numerics.pressure_tolerance = 1e-12;
  const double dt = 1e-3, slope = 60.0 / 1000.0 / 1.2;
  for (const double sign : {1.0, -1.0}) {
    auto simulation = open_plug<2>(numerics, 0.0, {Side::left, sign > 0 ? 60.0 : 0.0, {}},
                                   {Side::right, sign > 0 ? 0.0 : 60.0, {}}, dt);
    advance(simulation);
    const auto& p = simulation.state().particles;
    for (std::size_t i = 0; i < p.unknowns; ++i) {
      EXPECT_NEAR(p.velocity[i][1], 0.0, 1e-12);
      EXPECT_NEAR(p.velocity[i][0] / dt, sign * slope, 1e-8 * slope);
    }
  }
}

// Under a force along the side's normal the fluid at rest has the prescribed pressure at the side
// and rho g depth below it, and nothing moves.
TEST(PressureColumns, ABasinUnderAPrescribedPressureStaysAtRest) {
  const double dx = 0.1, pressure = 500.0, g = 9.81;
  const Box channel = box(0.8, 1.0);
  auto walls = test::walls_of_box<2>({0.8, 1.0}, true);
  walls.pop_back();
  Simulation<2> simulation(test::preset("recommended"),
                           test::particles_at<2>(test::lattice<2>({8, 10}, dx), dx),
                           Images<2>(walls));
  simulation.add_pressure_side(
      {{Side::top, pressure, {}}, channel, dx, simulation.state().kernel.support_radius()});
  auto gravity =
      std::make_unique<GravityEffect<2>>(Gravity{{0.0, -g, 0.0}, {}}, std::vector<PeriodicAxis>{});
  simulation.effects().time_dependence.push_back(gravity.get());
  simulation.effects().body_forces.push_back(std::move(gravity));
  simulation.start(1.0, 0.01);
  for (int n = 0; n < 10; ++n) advance(simulation);
  const auto& state = simulation.state();
  for (std::size_t i = 0; i < state.particles.unknowns; ++i) {
    // Round-off of the feedback's sums and of psi, some 10 m2/s2, over the spacing.
    EXPECT_LT(state.particles.velocity[i].norm(), 1e-10);
    EXPECT_NEAR(state.pressure(i), pressure + 1000.0 * g * (1.0 - state.particles.position[i][1]),
                1e-6);
  }
}

TEST(PressureColumns, FollowTheirWaveform) {
  auto simulation = open_plug<2>(test::preset("recommended"), 0.0,
                                 {Side::left, 60.0, Waveform::from_formula("1 + 10*t")},
                                 {Side::right, -20.0, Waveform::from_formula("cos(pi*t)")}, 0.01);
  const auto expect_pressures = [&](double left, double right) {
    const auto& state = simulation.state();
    for (std::size_t i = state.particles.unknowns; i < state.particles.size(); ++i)
      EXPECT_NEAR(state.pressure(i), state.particles.position[i][0] < 0.6 ? left : right, 1e-12);
  };
  expect_pressures(60.0, -20.0);
  advance(simulation);
  advance(simulation);
  ASSERT_NEAR(simulation.state().clock.time, 0.02, 1e-15);
  expect_pressures(72.0, -20.0 * std::cos(0.02 * std::acos(-1.0)));
}

// Only differences of pressure drive: at an absolute pressure of 1 bar the same flow to round-off,
// also with the tolerance of every day. p/rho = 100 m2/s2 carries errors of 1e-14, which a gradient
// over 0.1 m and ten steps of 1 ms make 1e-15 m/s.
TEST(PressureColumns, APressureOffsetChangesNothing) {
  std::array<std::vector<Vector<2>>, 2> velocity;
  for (const int k : {0, 1}) {
    const double offset = k * 1e5;
    auto simulation =
        open_plug<2>(test::preset("recommended"), 0.0, {Side::left, offset + 60.0, {}},
                     {Side::right, offset, {}}, 1e-3);
    for (int n = 0; n < 10; ++n) advance(simulation);
    velocity[k] = simulation.state().particles.velocity;
    EXPECT_GT(velocity[k][0][0], 4e-4);
  }
  ASSERT_EQ(velocity[0].size(), velocity[1].size());
  for (std::size_t i = 0; i < velocity[0].size(); ++i)
    EXPECT_LT((velocity[0][i] - velocity[1][i]).norm(), 1e-11);
}

}  // namespace
}  // namespace sprung::sph
