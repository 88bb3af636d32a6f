/// All pressure solvers on systems with periodic sides, walls and prescribed pressures, large
/// enough for several coarse levels.

#include "sph/pressure/solver.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1;

/// A box of disordered particles, periodic along the first `periodic_axes` axes and between walls
/// along the rest; `pinned`: columns of prescribed pressure beyond the far end of the last axis.
/// h = 0.8 dx keeps pairs short, so that few particles need many coarse cells.
template <int dim>
struct System {
  Particles<dim> particles;
  Images<dim> images;
  Support<dim> support;
  PressureMatrix matrix;
  CellMap map;

  System(int side, int periodic_axes, bool pinned) : images({}) {
    const Kernel<dim> kernel(0.8 * dx);
    std::array<int, dim> count;
    count.fill(side);
    particles = test::particles_at<dim>(test::lattice<dim>(count, dx, 0.15, 3), dx);
    const double length = side * dx;
    std::vector<Wall<dim>> walls;
    std::vector<PeriodicAxis> axes;
    for (int d = 0; d < dim; ++d) {
      if (d < periodic_axes) {
        axes.push_back({d, 0.0, length});
        continue;
      }
      walls.push_back({d, 0.0, 1, true, Vector<dim>::Zero()});
      if (!pinned || d < dim - 1) walls.push_back({d, length, -1, true, Vector<dim>::Zero()});
    }
    if (pinned) {
      count[dim - 1] = 2;
      for (auto x : test::lattice<dim>(count, dx)) {
        x[dim - 1] += length;
        particles.add(x, Vector<dim>::Zero(), 0.7, Role::outflow);
      }
    }
    images = Images<dim>(walls, axes);
    for (auto& x : particles.position) images.wrap(x);
    images.mirror(particles, kernel.support_radius());
    support.build(kernel, images.points(), particles.unknowns, particles.volume);
    matrix.assemble(particles, images, support, kernel);
    for (int d = 0; d < dim; ++d) {
      map.extent[d] = static_cast<int>(length / (1.7 * dx));
      map.periodic[d] = d < periodic_axes;
    }
    const double cell = length / map.extent[0];
    map.assign<dim>({particles.position.data(), particles.unknowns}, Vector<dim>::Zero(),
                    Vector<dim>::Constant(1.0 / cell));
  }

  /// Uneven, and of zero mean where the matrix is singular.
  std::vector<double> right_side() const {
    std::vector<double> b(matrix.rows());
    double mean = 0.0;
    for (std::size_t i = 0; i < b.size(); ++i) {
      b[i] = std::sin(1.0 + 12.9898 * double(i)) + particles.position[i][0];
      mean += b[i] / double(b.size());
    }
    if (matrix.singular())
      for (double& value : b) value -= mean;
    return b;
  }
};

struct NamedSolver {
  const char* name;
  std::unique_ptr<PressureSolver> (*make)();
};

constexpr NamedSolver solvers[] = {
    {"jacobi_cg", make_jacobi_solver},
    {"two_level", make_two_level_solver},
    {"incomplete_cholesky", make_incomplete_cholesky_solver},
    {"boomeramg", make_boomeramg_solver},
    {"cholmod", make_cholmod_solver},
    {"bicgstab", make_bicgstab_solver},
};

/// Solves with each solver and compares with the first, which has no preconditioner to be wrong in.
/// `condition`: an upper bound of the matrix's condition number (constants left out where
/// singular), so that |x - y| <= condition (|r_x| + |r_y|) / |b| |y|.
template <int dim>
void expect_equal_solutions(const System<dim>& system, double condition) {
  const double tolerance = 1e-10;
  const std::size_t n = system.matrix.rows();
  const auto b = system.right_side();
  std::vector<double> first;
  for (const auto& [name, make] : solvers) {
    const auto solver = make();
    std::vector<double> x(n, 0.0), product(n);
    solver->prepare(system.matrix, system.map);
    const auto report = solver->solve(system.matrix, b, x, tolerance);
    EXPECT_TRUE(report.converged) << name;
    if (std::string(name) == "two_level" || std::string(name) == "boomeramg") {
      EXPECT_LT(report.iterations, 60) << name;
    }
    system.matrix.multiply(x, product);
    double residual = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      residual += std::pow(b[i] - product[i], 2);
      mean += x[i] / double(n);
    }
    // The residual is updated from step to step; the true one drifts from it by round-off.
    EXPECT_LT(std::sqrt(residual / dot(b, b)), 1.1 * tolerance) << name;
    if (system.matrix.singular())
      for (double& value : x) value -= mean;
    if (first.empty()) first = x;
    double difference = 0.0;
    for (std::size_t i = 0; i < n; ++i) difference += std::pow(x[i] - first[i], 2);
    EXPECT_LT(std::sqrt(difference / dot(first, first)), 2.0 * condition * tolerance) << name;
  }
}

// Smallest eigenvalue of the Laplacian (pi/L)^2 between walls, (2 pi/L)^2 on a period, (pi/2L)^2
// with one end pinned; the largest at most twice the diagonal.
template <int dim>
double condition(const System<dim>& system, double smallest) {
  const auto& diagonal = system.matrix.diagonal();
  return 2.0 * *std::max_element(diagonal.begin(), diagonal.end()) / (0.8 * smallest);
}

constexpr double pi = std::numbers::pi;

TEST(PressureSolvers, AgreeOnAPeriodicPlane) {
  const System<2> system(112, 2, false);
  ASSERT_GT(system.map.cells(), 4000);
  EXPECT_TRUE(system.matrix.singular());
  expect_equal_solutions(system, condition(system, std::pow(2.0 * pi / 11.2, 2)));
}

TEST(PressureSolvers, AgreeOnAPlaneBetweenWalls) {
  const System<2> system(112, 0, false);
  ASSERT_GT(system.map.cells(), 4000);
  EXPECT_TRUE(system.matrix.singular());
  expect_equal_solutions(system, condition(system, std::pow(pi / 11.2, 2)));
}

TEST(PressureSolvers, AgreeOnAPlaneWithAPressurePrescribed) {
  const System<2> system(112, 1, true);
  EXPECT_FALSE(system.matrix.singular());
  expect_equal_solutions(system, condition(system, std::pow(pi / 22.4, 2)));
}

TEST(PressureSolvers, AgreeInSpace) {
  // Small enough for the direct solver; 8 cells a side are one level.
  expect_equal_solutions<3>(System<3>(14, 3, false), 1e4);
  expect_equal_solutions<3>(System<3>(14, 1, true), 1e4);
}

TEST(PressureSolvers, CoarseLevelsInSpaceEqualTheDiagonal) {
  const System<3> system(28, 1, false);
  ASSERT_GT(system.map.cells(), 4000);
  const std::size_t n = system.matrix.rows();
  const auto b = system.right_side();
  std::array<std::vector<double>, 2> x{std::vector<double>(n), std::vector<double>(n)};
  std::array<int, 2> iterations{};
  for (const int k : {0, 1}) {
    const auto solver = k == 0 ? make_two_level_solver() : make_jacobi_solver();
    solver->prepare(system.matrix, system.map);
    const auto report = solver->solve(system.matrix, b, x[k], 1e-8);
    EXPECT_TRUE(report.converged);
    iterations[k] = report.iterations;
    double mean = 0.0;
    for (const double value : x[k]) mean += value / double(n);
    for (double& value : x[k]) value -= mean;
  }
  EXPECT_LT(iterations[0], 40);
  EXPECT_LT(2 * iterations[0], iterations[1]);
  double difference = 0.0;
  for (std::size_t i = 0; i < n; ++i) difference += std::pow(x[0][i] - x[1][i], 2);
  EXPECT_LT(std::sqrt(difference / dot(x[1], x[1])),
            2e-8 * condition(system, std::pow(pi / 2.8, 2)));
}

// --- the coarse levels themselves
// -------------------------------------------------------------------

std::vector<double> uneven(std::size_t n, double phase) {
  std::vector<double> v(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = std::sin(phase + 78.233 * double(i));
  return v;
}

/// One V-cycle M: x . M y = y . M x and x . M x > 0, as conjugate gradients ask for.
template <int dim>
void expect_symmetric_positive(CellLevels& levels, const System<dim>& system) {
  levels.build(system.matrix, system.map);
  const auto n = static_cast<std::size_t>(system.map.cells());
  std::vector<double> mx, my;
  for (int k = 0; k < 4; ++k) {
    auto x = uneven(n, 0.1 + k), y = uneven(n, 2.7 * k);
    if (k == 3)  // smooth ones as well
      for (std::size_t i = 0; i < n; ++i) x[i] = std::cos(pi * double(i) / double(n));
    levels.solve(x, mx);
    levels.solve(y, my);
    const double size = std::sqrt(dot(x, mx) * dot(y, my));
    EXPECT_GT(dot(x, mx), 0.0);
    EXPECT_GT(dot(y, my), 0.0);
    // Round-off, and in a singular problem the shift of the last level: 1e-6 of it multiplies the
    // constants that x and y hold.
    EXPECT_NEAR(dot(x, my), dot(y, mx), 1e-9 * size) << k;
  }
}

TEST(CellLevels, AreSymmetricAndPositive) {
  CellLevels levels;  // one after the other, the same extent with other periodic axes too
  for (const bool pinned : {false, true})
    for (const int periodic : {0, 1, 2})
      if (!(pinned && periodic == 2))
        expect_symmetric_positive<2>(levels, System<2>(112, periodic, pinned));
  for (const int periodic : {0, 2})
    expect_symmetric_positive<3>(levels, System<3>(28, periodic, false));
}

// Few enough cells for one level: then the V-cycle is the inverse of the Galerkin matrix P^T A P,
// so that A P c, summed over each cell, is the residual that c was found for.
TEST(CellLevels, OneLevelIsTheGalerkinInverse) {
  for (const int periodic : {0, 1}) {
    const System<2> system(40, periodic, true);
    CellLevels levels;
    levels.build(system.matrix, system.map);
    const auto cells = static_cast<std::size_t>(system.map.cells());
    const auto residual = uneven(cells, 0.5);
    std::vector<double> correction;
    levels.solve(residual, correction);
    const std::size_t n = system.matrix.rows();
    std::vector<double> spread(n), product(n), sum(cells, 0.0);
    for (std::size_t i = 0; i < n; ++i) spread[i] = correction[system.map.cell_of[i]];
    system.matrix.multiply(spread, product);
    for (std::size_t i = 0; i < n; ++i) sum[system.map.cell_of[i]] += product[i];
    for (std::size_t c = 0; c < cells; ++c) EXPECT_NEAR(sum[c], residual[c], 1e-9);
  }
}

}  // namespace
}  // namespace sprung::sph
