#include "sph/probes.hpp"

#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

namespace sprung::sph {
namespace {

template <int dim>
State<dim> state_of(const std::array<int, dim>& count, double dx, double jitter,
                    std::vector<Wall<dim>> walls) {
  State<dim> state{test::particles_at<dim>(test::lattice<dim>(count, dx, jitter, 9), dx),
                   Images<dim>(std::move(walls)),
                   {},
                   Kernel<dim>(1.3 * dx),
                   {}};
  state.images.mirror(state.particles, state.kernel.support_radius());
  return state;
}

TEST(VelocityAt, IsExactForQuadraticFields) {
  auto plane = state_of<2>({20, 20}, 0.05, 0.3, {});
  const auto u = [](const Vector<2>& x) {
    return Vector<2>(1.0 - 2.0 * x[0] + 0.5 * x[1] + 3.0 * x[0] * x[0] - x[0] * x[1] + x[1] * x[1],
                     0.2 + x[0] - 4.0 * x[1] * x[1]);
  };
  for (std::size_t i = 0; i < plane.particles.size(); ++i)
    plane.particles.velocity[i] = u(plane.particles.position[i]);
  // A particle's own place, a cell corner, a place between, and the edge of the cloud.
  const std::vector<Vector<2>> places{
      plane.particles.position[210], {0.5, 0.5}, {0.333, 0.61}, {0.03, 0.97}};
  const auto found = velocity_at<2>(plane, places);
  ASSERT_EQ(found.size(), places.size());
  for (std::size_t k = 0; k < places.size(); ++k)
    EXPECT_NEAR((found[k] - u(places[k])).norm(), 0.0, 1e-11) << k;

  auto space = state_of<3>({8, 8, 8}, 0.1, 0.3, {});
  const auto v = [](const Vector<3>& x) {
    return Vector<3>(x[0] * x[1] - x[2], 1.0 + x[2] * x[2], x[0] * x[0] - 2.0 * x[1] * x[2]);
  };
  for (std::size_t i = 0; i < space.particles.size(); ++i)
    space.particles.velocity[i] = v(space.particles.position[i]);
  const Vector<3> middle(0.41, 0.37, 0.4);
  EXPECT_NEAR((velocity_at<3>(space, {middle})[0] - v(middle)).norm(), 0.0, 1e-11);
}

TEST(VelocityAt, VanishesOnANoSlipWall) {
  // Particles and images have opposite velocities at mirrored places, so the fit is odd about the
  // wall, but for the last quarter of the probe's support, where there are no images: weights below
  // 1e-3 of the whole.
  auto state = state_of<2>({20, 20}, 0.05, 0.3, {{1, 0.0, 1, true, Vector<2>::Zero()}});
  for (std::size_t i = 0; i < state.particles.size(); ++i) {
    const double y = state.particles.position[i][1];
    state.particles.velocity[i] = {y * (1.0 - y), 0.3 * y};
  }
  const double one_spacing_away = 0.05;
  EXPECT_NEAR(velocity_at<2>(state, {{0.5, 0.0}})[0].norm(), 0.0, 1e-3 * one_spacing_away);
}

TEST(DisplacementOf, IsExactForLinearFields) {
  const double dx = 0.02;
  auto particles = test::particles_at<2>(test::lattice<2>({4, 9}, dx), dx, Role::solid);
  const ElasticSolid<2> solid(
      test::network_of<2>(particles, {4, 9}, test::preset("recommended"), 1e4, Side::bottom),
      particles, SpringIntegration::implicit_force);
  Eigen::Matrix2d gradient;
  gradient << 0.02, -0.11, 0.13, 0.04;
  const Vector<2> shift(0.3, -0.1);
  for (std::size_t i = 0; i < particles.size(); ++i)
    particles.position[i] += shift + gradient * solid.network().reference[i];
  // Inside, on a face, at the corners of the body (half a spacing outside the outer centres).
  const std::vector<Vector<2>> points{
      {0.037, 0.09}, {0.08, 0.1}, {0.0, 0.18}, {0.08, 0.18}, {0.04, 0.18}};
  const auto found = displacement_of(solid, particles, 0, particles.size(), points);
  ASSERT_EQ(found.size(), points.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    EXPECT_NEAR((found[k] - shift - gradient * points[k]).norm(), 0.0, 1e-13) << k;
}

TEST(DisplacementOf, LooksAtOneBodyOnly) {
  const double dx = 0.02;
  auto points = test::lattice<2>({3, 3}, dx);
  for (const auto& x : test::lattice<2>({3, 3}, dx)) points.push_back(x + Vector<2>(3 * dx, 0.0));
  auto particles = test::particles_at<2>(points, dx, Role::solid);
  const ElasticSolid<2> solid(test::network_of<2>(particles, {6, 3}, test::preset("paper"), 1e4),
                              particles, SpringIntegration::explicit_force);
  for (std::size_t i = 9; i < 18; ++i) particles.position[i] += Vector<2>(0.5, 0.0);
  EXPECT_NEAR(displacement_of(solid, particles, 0, 9, {{3 * dx, 0.03}})[0].norm(), 0.0, 1e-15);
  EXPECT_NEAR(displacement_of(solid, particles, 9, 18, {{3 * dx, 0.03}})[0][0], 0.5, 1e-14);
}

}  // namespace
}  // namespace sprung::sph
