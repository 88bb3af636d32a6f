#include "sph/pressure/first_guess.hpp"
#include "sph/pressure/solver.hpp"

#include "tests/unit/sph/dense_matrix.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

namespace sprung::sph {
namespace {

/// A box of disordered particles between walls; columns of an outflow to its right where asked.
template <int dim>
struct Box {
  Particles<dim> particles;
  Images<dim> images;
  Support<dim> support;
  Kernel<dim> kernel;
  PressureMatrix matrix;
  CellMap map;

  Box(const std::array<int, dim>& count, bool outflow, double jitter = 0.2)
      : images({}), kernel(1.3 * dx) {
    particles = test::particles_at<dim>(test::lattice<dim>(count, dx, jitter, 11), dx);
    Vector<dim> high;
    for (int d = 0; d < dim; ++d) high[d] = count[d] * dx;
    auto walls = test::walls_of_box<dim>(high, true);
    if (outflow) {
      walls.erase(walls.begin() + 1);
      auto columns = count;
      columns[0] = 3;
      for (auto x : test::lattice<dim>(columns, dx)) {
        x[0] += high[0];
        particles.add(x, Vector<dim>::Zero(), outflow_psi, Role::outflow);
      }
    }
    images = Images<dim>(walls);
    images.mirror(particles, kernel.support_radius());
    support.build(kernel, images.points(), particles.unknowns, particles.volume);
    matrix.assemble(particles, images, support, kernel);
    // Cells wider than the support, as the two-level solver asks for.
    const double cell = 3.5 * dx;
    for (int d = 0; d < dim; ++d) map.extent[d] = static_cast<std::int32_t>(high[d] / cell) + 1;
    map.assign<dim>({particles.position.data(), particles.unknowns}, Vector<dim>::Zero(),
                    Vector<dim>::Constant(1.0 / cell));
  }

  static constexpr double dx = 0.1;
  static constexpr double outflow_psi = -2.5;
};

/// Eq. 3's left side summed over all pairs, without the code's lists: a_ij = -2 V F_ij.
template <int dim>
Eigen::MatrixXd matrix_from_all_pairs(const Box<dim>& box, Eigen::VectorXd& boundary) {
  const auto n = static_cast<Eigen::Index>(box.particles.unknowns);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  boundary = Eigen::VectorXd::Zero(n);
  const auto& points = box.images.points();
  for (Eigen::Index i = 0; i < n; ++i)
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double r = (points[i] - points[j]).norm();
      if (static_cast<Eigen::Index>(j) == i || r >= box.kernel.support_radius()) continue;
      const double value = -2.0 * box.particles.volume * box.kernel.gradient_factor(r);
      const Eigen::Index s = box.images.source(static_cast<std::int32_t>(j));
      a(i, i) += value;
      if (s < n)
        a(i, s) -= value;
      else
        boundary[i] += value * box.particles.pseudo_pressure[s];
    }
  return a;
}

Eigen::VectorXd uneven_vector(Eigen::Index n) {
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) b[i] = std::sin(1.0 + 12.9898 * double(i));
  return b;
}

template <int dim>
void expect_assembled_rightly(const Box<dim>& box) {
  Eigen::VectorXd boundary;
  const Eigen::MatrixXd expected = matrix_from_all_pairs(box, boundary);
  const Eigen::MatrixXd found = test::dense(box.matrix);
  // Sums of a few dozen terms in another order: round-off of the largest entry.
  const double tolerance = 1e-12 * expected.diagonal().maxCoeff();
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((found - found.transpose()).cwiseAbs().maxCoeff(), tolerance);
  for (Eigen::Index i = 0; i < found.rows(); ++i) {
    EXPECT_NEAR(box.matrix.diagonal()[i], expected(i, i), tolerance);
    EXPECT_NEAR(box.matrix.boundary_source()[i], boundary[i], 3.0 * tolerance);
  }
}

TEST(PressureMatrix, EqualsTheSumOverAllPairsAndIsSymmetric) {
  expect_assembled_rightly(Box<2>({13, 11}, false));
  expect_assembled_rightly(Box<2>({13, 11}, true));
  expect_assembled_rightly(Box<3>({6, 5, 7}, false));
  expect_assembled_rightly(Box<3>({6, 5, 7}, true));
}

TEST(PressureMatrix, RowsOfANeumannProblemSumToZero) {
  const Box<2> box({13, 11}, false);
  EXPECT_TRUE(box.matrix.singular());
  const std::vector<double> ones(box.matrix.rows(), 1.0);
  std::vector<double> sums(ones.size());
  box.matrix.multiply(ones, sums);
  for (std::size_t i = 0; i < sums.size(); ++i)
    EXPECT_NEAR(sums[i], 0.0, 1e-13 * box.matrix.diagonal()[i]);
}

TEST(PressureMatrix, AnOutflowPinsThePressure) {
  const Box<2> box({13, 11}, true);
  EXPECT_FALSE(box.matrix.singular());
  // The pressure of the outflow everywhere solves the equation without a source.
  const std::vector<double> constant(box.matrix.rows(), Box<2>::outflow_psi);
  std::vector<double> product(constant.size());
  box.matrix.multiply(constant, product);
  for (std::size_t i = 0; i < product.size(); ++i)
    EXPECT_NEAR(product[i], box.matrix.boundary_source()[i], 1e-12 * box.matrix.diagonal()[i]);
}

/// A lattice without walls; each particle's psi is value(x).
template <typename Value>
Particles<2> block_with_psi(const std::array<int, 2>& count, Support<2>& support, Value&& value) {
  const double dx = 0.1;
  auto particles = test::particles_at<2>(test::lattice<2>(count, dx), dx);
  support.build(Kernel<2>(1.3 * dx), particles.position, particles.unknowns, particles.volume);
  for (std::size_t i = 0; i < particles.unknowns; ++i)
    particles.pseudo_pressure[i] = value(particles.position[i]);
  return particles;
}

// On a lattice the neighbours lie opposite each other with equal coefficients: a linear field's
// mean is its value at the middle.
TEST(FirstGuess, OfANewcomerAmongALinearPressureIsItsValue) {
  Support<2> support;
  auto particles = block_with_psi(
      {9, 9}, support, [](const Vector<2>& x) { return -40.0 + 3.0 * x[0] + 7.0 * x[1]; });
  const auto before = particles.pseudo_pressure;
  constexpr std::size_t middle = 40;
  particles.pseudo_pressure[middle] = 0.0;
  guess_newcomers(particles, support);
  for (std::size_t i = 0; i < before.size(); ++i)
    if (i == middle)
      EXPECT_NEAR(particles.pseudo_pressure[i], before[i], 1e-13 * 40.0);
    else
      EXPECT_EQ(particles.pseudo_pressure[i], before[i]);
}

// A column of newcomers, as a plug flow lets them in: they say nothing about each other.
TEST(FirstGuess, OfAColumnOfNewcomersComesFromTheOthers) {
  Support<2> support;
  auto particles =
      block_with_psi({8, 6}, support, [](const Vector<2>& x) { return x[0] < 0.1 ? 0.0 : -40.0; });
  guess_newcomers(particles, support);
  for (const double psi : particles.pseudo_pressure) EXPECT_NEAR(psi, -40.0, 1e-13 * 40.0);
}

TEST(FirstGuess, WithoutAnyPressureStaysZero) {
  Support<2> support;
  auto particles = block_with_psi({4, 4}, support, [](const Vector<2>&) { return 0.0; });
  guess_newcomers(particles, support);
  for (const double psi : particles.pseudo_pressure) EXPECT_EQ(psi, 0.0);
}

TEST(PressureMatrix, InflowColumnsHaveNoSay) {
  const double dx = 0.1;
  auto particles = test::particles_at<2>(test::lattice<2>({6, 6}, dx), dx);
  for (int j = 0; j < 6; ++j)
    particles.add({-0.5 * dx, (j + 0.5) * dx}, Vector<2>::Zero(), 7.0, Role::inflow);
  Images<2> images({});
  images.mirror(particles, 0.26);
  Support<2> support;
  support.build(Kernel<2>(0.13), images.points(), particles.unknowns, particles.volume);
  PressureMatrix matrix;
  matrix.assemble(particles, images, support, Kernel<2>(0.13));
  EXPECT_TRUE(matrix.singular());
  for (const double s : matrix.boundary_source()) EXPECT_EQ(s, 0.0);
}

template <int dim>
void expect_dense_solution(const Box<dim>& box, PressureSolver& solver) {
  const Eigen::MatrixXd a = test::dense(box.matrix);
  const Eigen::Index n = a.rows();
  Eigen::VectorXd b = uneven_vector(n);
  Eigen::VectorXd expected;
  if (box.matrix.singular()) {
    // Only a right side of zero mean has a solution; of the solutions, the one of zero mean.
    b.array() -= b.mean();
    const Eigen::MatrixXd pinned = a + Eigen::MatrixXd::Constant(n, n, a.diagonal().mean() / n);
    expected = pinned.ldlt().solve(b);
  } else {
    expected = a.ldlt().solve(b);
  }
  std::vector<double> x(n, 0.0);
  solver.prepare(box.matrix, box.map);
  const auto report = solver.solve(box.matrix, {b.data(), std::size_t(n)}, x, 1e-12);
  EXPECT_TRUE(report.converged);
  EXPECT_GT(report.iterations, 0);
  EXPECT_LE(report.relative_residual, 1e-12);
  Eigen::VectorXd found = Eigen::Map<Eigen::VectorXd>(x.data(), n);
  if (box.matrix.singular()) found.array() -= found.mean();
  // Error of the solution <= condition number (about (L/dx)^2 = 200) x residual.
  EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
}

TEST(PressureSolver, TwoLevelEqualsTheDenseSolution) {
  const auto solver = make_two_level_solver();
  expect_dense_solution(Box<2>({14, 12}, true), *solver);
  expect_dense_solution(Box<3>({6, 5, 7}, true), *solver);
}

TEST(PressureSolver, BicgstabEqualsTheDenseSolution) {
  const auto solver = make_bicgstab_solver();
  expect_dense_solution(Box<2>({14, 12}, true), *solver);
  expect_dense_solution(Box<3>({6, 5, 7}, true), *solver);
}

TEST(PressureSolver, SingularProblemsAreSolvedUpToAConstant) {
  const auto two_level = make_two_level_solver(), bicgstab = make_bicgstab_solver();
  expect_dense_solution(Box<2>({14, 12}, false), *two_level);
  expect_dense_solution(Box<3>({6, 5, 7}, false), *two_level);
  expect_dense_solution(Box<2>({14, 12}, false), *bicgstab);
}

TEST(PressureSolver, ZeroRightSideGivesZero) {
  const Box<2> box({8, 8}, true);
  for (const auto& solver : {make_two_level_solver(), make_bicgstab_solver()}) {
    std::vector<double> x(box.matrix.rows(), 3.0);
    const std::vector<double> b(x.size(), 0.0);
    solver->prepare(box.matrix, box.map);
    EXPECT_TRUE(solver->solve(box.matrix, b, x, 1e-6).converged);
    for (const double value : x) EXPECT_EQ(value, 0.0);
  }
}

// More than one block of the Gauss-Seidel sweep (2048 rows): the residual that is reported is
// checked against one computed here, and the count of iterations must not grow with the size as it
// does for the diagonal alone (about in proportion to the number of particles along a side).
TEST(PressureSolver, ManyParticles) {
  const Box<2> box({75, 60}, true);
  const auto n = box.matrix.rows();
  const Eigen::VectorXd b = uneven_vector(static_cast<Eigen::Index>(n));
  std::array<std::vector<double>, 2> x{std::vector<double>(n, 0.0), std::vector<double>(n, 0.0)};
  std::array<int, 2> iterations{};
  const auto two_level = make_two_level_solver(), bicgstab = make_bicgstab_solver();
  int k = 0;
  for (PressureSolver* solver : {two_level.get(), bicgstab.get()}) {
    solver->prepare(box.matrix, box.map);
    const auto report = solver->solve(box.matrix, {b.data(), n}, x[k], 1e-10);
    std::vector<double> product(n);
    box.matrix.multiply(x[k], product);
    const double residual =
        (Eigen::Map<Eigen::VectorXd>(product.data(), Eigen::Index(n)) - b).norm() / b.norm();
    EXPECT_LE(residual, 1.01e-10);
    EXPECT_NEAR(residual, report.relative_residual, 1e-12);
    iterations[k++] = report.iterations;
  }
  EXPECT_LT(iterations[0], 40);
  EXPECT_LT(2 * iterations[0], iterations[1]);
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    difference = std::max(difference, std::abs(x[0][i] - x[1][i]));
    size = std::max(size, std::abs(x[0][i]));
  }
  EXPECT_LT(difference, 1e-6 * size);  // condition number about 4000 x the tolerance
}

TEST(PressureSolver, StartsFromTheGuessItIsGiven) {
  const Box<2> box({14, 12}, true);
  const auto n = box.matrix.rows();
  const Eigen::VectorXd b = uneven_vector(static_cast<Eigen::Index>(n));
  for (const auto& solver : {make_two_level_solver(), make_bicgstab_solver()}) {
    std::vector<double> x(n, 0.0);
    solver->prepare(box.matrix, box.map);
    solver->solve(box.matrix, {b.data(), n}, x, 1e-8);
    EXPECT_EQ(solver->solve(box.matrix, {b.data(), n}, x, 1.001e-8).iterations, 0);
  }
}

TEST(Dot, SumsInBlocks) {
  std::vector<double> a(5000), b(5000);
  long double exact = 0.0L;
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = std::sin(double(i));
    b[i] = std::cos(3.0 * double(i));
    exact += static_cast<long double>(a[i]) * b[i];
  }
  EXPECT_NEAR(dot(a, b), static_cast<double>(exact), 1e-12);
}

}  // namespace
}  // namespace sprung::sph
