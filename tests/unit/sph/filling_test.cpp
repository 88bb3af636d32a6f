/// What the grid of nodes says of the filling, and what a step makes of a particle's volume.

#include "sph/filling.hpp"
#include "sph/simulation.hpp"
#include "sph/time_step.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <omp.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace sprung::sph {
namespace {

constexpr double dx = 0.05, pi = std::numbers::pi;

/// A lattice, jittered and moved, with three more rows all round: the box itself is `side` wide.
template <int dim>
std::vector<Vector<dim>> surrounded(int side, double jitter, const Vector<dim>& moved) {
  std::array<int, dim> count;
  count.fill(side + 6);
  auto points = test::lattice<dim>(count, dx, jitter, 3);
  for (auto& x : points) x += moved - Vector<dim>::Constant(3.0 * dx);
  return points;
}

template <int dim>
FillingGrid<dim> grid(int side) {
  return {Vector<dim>::Zero(), Vector<dim>::Constant(side * dx), dx};
}

// Quadratic B-splines add up to 1 over points one spacing apart, wherever the points are.
template <int dim>
void expect_a_lattice_fills_every_node() {
  for (const double part : {0.0, 0.17, 0.5}) {
    const auto points = surrounded<dim>(6, 0.0, Vector<dim>::Constant(part * dx));
    const std::vector<double> volume(points.size(), std::pow(dx, dim));
    std::vector<double> lacking(points.size());
    auto nodes = grid<dim>(6);
    nodes.lacking(points, volume, lacking);
    for (const double filling : nodes.filling()) EXPECT_NEAR(filling, 1.0, 1e-12) << part;
    for (const double rate : lacking) EXPECT_NEAR(rate, 0.0, 1e-12) << part;
  }
}

TEST(FillingGrid, ALatticeFillsEveryNode) {
  expect_a_lattice_fills_every_node<2>();
  expect_a_lattice_fills_every_node<3>();
}

// The points' growth, weighted with their volumes, is what all nodes lack: to rounding, on any
// distribution.
template <int dim>
void expect_balance() {
  const auto points = surrounded<dim>(6, 0.3, Vector<dim>::Zero());
  std::vector<double> volume(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    volume[i] = std::pow(dx, dim) * (0.9 + 0.01 * (i % 17));
  std::vector<double> lacking(points.size());
  auto nodes = grid<dim>(6);
  nodes.lacking(points, volume, lacking);
  const double grown = std::inner_product(lacking.begin(), lacking.end(), volume.begin(), 0.0);
  double missing = 0.0;
  for (const double filling : nodes.filling()) missing += std::pow(dx, dim) * (1.0 - filling);
  EXPECT_GT(std::abs(missing), 1e-3 * std::pow(dx, dim));
  EXPECT_NEAR(grown, missing, 1e-10 * volume[0] * static_cast<double>(points.size()));
}

TEST(FillingGrid, GivesBackWhatTheNodesLack) {
  expect_balance<2>();
  expect_balance<3>();
}

TEST(FillingGrid, IsTheSameForAnyNumberOfThreads) {
  const auto points = surrounded<2>(20, 0.3, Vector<2>::Zero());
  const std::vector<double> volume(points.size(), dx * dx);
  const int before = omp_get_max_threads();
  std::array<std::vector<double>, 3> lacking;
  for (const int k : {0, 1, 2}) {
    omp_set_num_threads(k + 1);
    auto nodes = grid<2>(20);
    lacking[k].resize(points.size());
    nodes.lacking(points, volume, lacking[k]);
  }
  omp_set_num_threads(before);
  EXPECT_EQ(lacking[0], lacking[1]);
  EXPECT_EQ(lacking[0], lacking[2]);
}

/// How far the fluid about a centre of Taylor-Green's vortices has thinned out after ten steps,
/// relative, with nothing that corrects it.
double thinning(bool along_step, double dt) {
  constexpr int side = 40;
  constexpr double spacing = 1.0 / side;
  Numerics numerics = test::preset("recommended");
  numerics.volume_along_step = along_step;
  numerics.density_feedback = numerics.void_feedback = 0.0;
  numerics.pressure_tolerance = 1e-8;
  auto particles = test::particles_at<2>(test::lattice<2>({side, side}, spacing), spacing);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vector<2> x = 2.0 * pi * particles.position[i];
    particles.velocity[i] = {std::sin(x[0]) * std::cos(x[1]), -std::cos(x[0]) * std::sin(x[1])};
  }
  Simulation<2> simulation(numerics, std::move(particles),
                           Images<2>({}, {{0, 0.0, 1.0}, {1, 0.0, 1.0}}));
  simulation.start(1.0, dt);
  for (int n = 0; n < 10; ++n) advance(simulation);
  const auto& points = simulation.state().images.points();
  const std::vector<double> volume(points.size(), spacing * spacing);
  std::vector<double> lacking(points.size());
  FillingGrid<2> nodes({0.0, 0.0}, {1.0, 1.0}, spacing);
  nodes.lacking(points, volume, lacking);
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < simulation.state().particles.size(); ++i)
    if ((points[i] - Vector<2>(0.25, 0.25)).norm() < 0.06) {
      sum += lacking[i];
      ++count;
    }
  return -sum / count;
}

// Fluid that turns at the rate W thins out at the rate W^2 dt when the new velocity has no
// divergence where the step begins; W = 2 pi at the centre, and 4 % less in the mean over the disc.
// A tenth of it may remain: the lattice is 40 wide and the step's own error of third order.
TEST(VolumeAlongStep, TurningFluidKeepsItsVolume) {
  constexpr double dt = 0.005, steps = 10;
  const double expected = steps * std::pow(2.0 * pi * dt, 2);
  EXPECT_NEAR(thinning(false, dt), -expected, 0.1 * expected);
  EXPECT_NEAR(thinning(true, dt), 0.0, 0.1 * expected);
}

}  // namespace
}  // namespace sprung::sph
