#include "sph/boundary/open_sides.hpp"

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
  // Mean velocity times height, 0.15 m2/s; the midpoint sum of 2000 is off by 1/(2 . 2000^2).
  EXPECT_NEAR(side.flux(1.0), 0.15, 2e-7 * 0.15);
  EXPECT_NEAR(side.flux(0.4), 0.06, 2e-7 * 0.15);
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

}  // namespace
}  // namespace sprung::sph
