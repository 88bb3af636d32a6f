/// Corrected gradients: exact for linear fields on any distribution (Bonet & Lok 1999), through the
/// ACTIONs that use them.

#include "sph/simulation.hpp"

#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1;

/// A disordered block whose inner particles have equations and whose frame, three deep, is
/// prescribed: no mirror that would bend a linear field.
template <int dim>
Simulation<dim> framed_block(int side, double jitter, Numerics numerics) {
  std::array<int, dim> count;
  count.fill(side);
  std::vector<Vector<dim>> inner, frame;
  const auto sites = test::lattice<dim>(count, dx),
             moved = test::lattice<dim>(count, dx, jitter, 4);
  for (std::size_t k = 0; k < sites.size(); ++k) {
    const bool inside = sites[k].minCoeff() > 3.0 * dx && sites[k].maxCoeff() < (side - 3.0) * dx;
    (inside ? inner : frame).push_back(moved[k]);
  }
  auto particles = test::particles_at<dim>(inner, dx);
  for (const auto& x : frame) particles.add(x, Vector<dim>::Zero(), 0.0, Role::outflow);
  numerics.gradient_correction = true;
  Simulation<dim> simulation(numerics, std::move(particles), Images<dim>({}));
  simulation.start(1.0, 0.01);
  simulation.choose_time_step();
  return simulation;
}

template <int dim>
Eigen::Matrix<double, dim, dim> some_matrix() {
  Eigen::Matrix<double, dim, dim> a;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) a(i, j) = std::sin(1.0 + 3.0 * i + 7.0 * j);
  return a;
}

template <int dim>
void expect_exact_for_linear_fields() {
  for (const std::string preset : {"recommended", "paper"}) {
    auto simulation = framed_block<dim>(dim == 2 ? 16 : 10, 0.25, test::preset(preset));
    auto& particles = simulation.state().particles;
    auto gradient = some_matrix<dim>();
    // Root mean square of the divergence, at each particle the trace: |trace| only if all have it.
    for (auto& u : particles.velocity) u.setZero();
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.velocity[i] = gradient * particles.position[i] + Vector<dim>::Constant(3.0);
    EXPECT_NEAR(simulation.remaining_divergence(), std::abs(gradient.trace()), 1e-12) << preset;
    gradient -= gradient.trace() / dim * Eigen::Matrix<double, dim, dim>::Identity();
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.velocity[i] = gradient * particles.position[i];
    EXPECT_NEAR(simulation.remaining_divergence(), 0.0, 1e-12) << preset;
    // u = u* + dt grad psi.
    const Vector<dim> slope = some_matrix<dim>().col(0);
    for (std::size_t i = 0; i < particles.size(); ++i) {
      particles.pseudo_pressure[i] = slope.dot(particles.position[i]) + 5.0;
      particles.predicted_velocity[i].setZero();
    }
    simulation.correct_velocity();
    const double dt = simulation.state().clock.time_step;
    double worst = 0.0;
    for (std::size_t i = 0; i < particles.unknowns; ++i)
      worst = std::max(worst, (particles.velocity[i] / dt - slope).norm());
    EXPECT_LT(worst, 1e-11) << preset;
  }
}

TEST(GradientCorrection, IsExactForLinearFieldsInThePlane) {
  expect_exact_for_linear_fields<2>();
}

TEST(GradientCorrection, IsExactForLinearFieldsInSpace) {
  expect_exact_for_linear_fields<3>();
}

// Without it the same disorder leaves errors of several per cent: the test above can fail.
TEST(GradientCorrection, MattersOnADisorderedBlock) {
  auto simulation = framed_block<2>(16, 0.25, test::preset("recommended"));
  auto& state = simulation.state();
  state.gradient_correction.clear();
  auto& particles = state.particles;
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.velocity[i] = {particles.position[i][0], -particles.position[i][1]};
  EXPECT_GT(simulation.remaining_divergence(), 0.03);
}

template <int dim>
void expect_factors_of_the_lattice() {
  const auto simulation = framed_block<dim>(9, 0.0, test::preset("recommended"));
  const auto& state = simulation.state();
  ASSERT_EQ(state.gradient_correction.size(), state.particles.unknowns);
  ASSERT_EQ(state.laplacian_correction.size(), state.particles.size());
  const Eigen::Matrix<double, dim, dim> one = Eigen::Matrix<double, dim, dim>::Identity();
  for (std::size_t i = 0; i < state.particles.unknowns; ++i) {
    EXPECT_NEAR((state.gradient_correction[i].full() - one).norm(), 0.0, 1e-12);
    EXPECT_NEAR((state.laplacian_correction[i].full() - one).norm(), 0.0, 1e-11);
  }
}

// The normalised gradient is exact for linear fields on the lattice: nothing to correct.
TEST(GradientCorrection, IsTheIdentityOnTheLattice) {
  expect_factors_of_the_lattice<2>();
  expect_factors_of_the_lattice<3>();
}

template <int dim>
void expect_laplacian_correction() {
  const auto simulation = framed_block<dim>(dim == 2 ? 14 : 9, 0.25, test::preset("recommended"));
  const auto& state = simulation.state();
  const auto& particles = state.particles;
  const Eigen::Matrix<double, dim, dim> one = Eigen::Matrix<double, dim, dim>::Identity();
  double spread = 0.0;
  for (std::size_t i = 0; i < particles.unknowns; ++i) {
    // sum V |F| (e . A e) (u_j - u_i) of u = |x - x_i|^2; twice that is its Laplacian, 2 dim.
    double sum = 0.0;
    for (std::size_t j = 0; j < particles.size(); ++j) {
      const Vector<dim> r = particles.position[i] - particles.position[j];
      if (j == i || r.norm() >= state.kernel.support_radius()) continue;
      sum -= particles.volume * state.kernel.gradient_factor(r.norm()) *
             r.dot(state.laplacian_correction[i] * r);
    }
    EXPECT_NEAR(sum, dim, 1e-12);
    spread = std::max(spread, (state.laplacian_correction[i].full() - one).norm());
  }
  EXPECT_GT(spread, 0.02);
  for (std::size_t i = particles.unknowns; i < particles.size(); ++i)
    EXPECT_EQ(state.laplacian_correction[i].full(), one);
}

TEST(GradientCorrection, ViscousSumIsTheLaplacianOfTheSquaredDistance) {
  expect_laplacian_correction<2>();
  expect_laplacian_correction<3>();
}

TEST(GradientCorrection, OneSidedParticlesKeepTheirGradient) {
  // Two particles: the matrix has no inverse.
  Simulation<2> simulation(test::preset("recommended"),
                           test::particles_at<2>({{0.0, 0.0}, {0.1, 0.0}}, dx), Images<2>({}));
  simulation.start(1.0, 0.01);
  for (const auto& correction : simulation.state().gradient_correction)
    EXPECT_EQ(correction.full(), Eigen::Matrix2d::Identity());
  for (const auto& correction : simulation.state().laplacian_correction)
    EXPECT_EQ(correction.full(), Eigen::Matrix2d::Identity());
}

TEST(GradientCorrection, IsEmptyWhereItIsNotChosen) {
  Numerics numerics = test::preset("recommended");
  numerics.gradient_correction = false;
  Simulation<2> simulation(numerics, test::particles_at<2>(test::lattice<2>({6, 6}, dx), dx),
                           Images<2>({}));
  simulation.start(1.0, 0.01);
  EXPECT_TRUE(simulation.state().gradient_correction.empty());
  EXPECT_TRUE(simulation.state().laplacian_correction.empty());
}

}  // namespace
}  // namespace sprung::sph
