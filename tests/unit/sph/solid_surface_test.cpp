/// Where a body's surface lies for the fluid: no-slip carried on beyond it, and the fluid's pull at
/// it. Expected values are closed forms.

#include "sph/effects/solid_surface.hpp"

#include "sph/effects/viscosity.hpp"
#include "sph/simulation.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1, nu = 0.3;
constexpr int columns = 24, rows = 4, fluid_rows = 10;
constexpr double face = rows * dx;

/// A body at rest under a fluid with the speed a y + b y^2 / 2 along it, y above the face.
struct Sheared {
  explicit Sheared(double a, double b, SolidNoSlip no_slip = SolidNoSlip::face)
      : simulation(test::preset("recommended"), laid(a, b), Images<2>({})) {
    simulation.start(1.0, 1e-3);
    auto& particles = simulation.state().particles;
    std::shared_ptr<SolidSurface<2>> surface;
    if (no_slip == SolidNoSlip::face)
      surface = std::make_shared<SolidSurface<2>>(
          std::vector<SolidSurface<2>::Body>{
              {test::solid_block<2>({columns, rows}, dx), 0, particles.solids}},
          particles);
    viscosity = std::make_unique<ViscosityEffect<2>>(nu, particles, surface);
    // The bend needs the Laplacian of the step before: until it has settled.
    for (int step = 0; step < 60; ++step) {
      acceleration.assign(particles.unknowns, Vector<2>::Zero());
      viscosity->add_acceleration(simulation.state(), acceleration);
    }
  }

  static Particles<2> laid(double a, double b) {
    auto particles = test::particles_at<2>(test::lattice<2>({columns, rows + fluid_rows}, dx), dx);
    particles.solids = columns * rows;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const bool solid = i < particles.solids;
      particles.role[i] = solid ? Role::solid : Role::fluid;
      const double y = particles.position[i][1] - face;
      if (!solid) particles.velocity[i] = {a * y + 0.5 * b * y * y, 0.0};
    }
    return particles;
  }

  /// The acceleration along the face in a row of the middle columns.
  double in_row(int row) const {  // simulations order fluid particles by their places
    const Vector<2> place{(columns / 2 + 0.5) * dx, (row + 0.5) * dx};
    const auto& position = simulation.state().particles.position;
    for (std::size_t i = 0; i < acceleration.size(); ++i)
      if ((position[i] - place).norm() < 0.1 * dx) return acceleration[i][0];
    throw std::logic_error("no particle there");
  }

  Simulation<2> simulation;
  std::unique_ptr<ViscosityEffect<2>> viscosity;
  std::vector<Vector<2>> acceleration;
};

TEST(SolidSurface, AParabolaOverItFeelsItsOwnLaplacian) {
  const Sheared flow(2.0, 5.0);
  // nu u'' = 1.5 in every row that the free surface above does not reach.
  for (int row = rows; row < rows + 5; ++row) EXPECT_NEAR(flow.in_row(row), 1.5, 1e-9) << row;
}

TEST(SolidSurface, AStraightProfileFeelsNothing) {
  const Sheared flow(2.0, 0.0);
  for (int row = rows; row < rows + 5; ++row) EXPECT_NEAR(flow.in_row(row), 0.0, 1e-9) << row;
}

TEST(SolidSurface, TheFluidPullsAtTheFace) {
  const Sheared flow(2.0, 0.0);
  double force = 0.0, moment = 0.0;
  for (int row = 0; row < rows; ++row) {
    force += flow.in_row(row);
    moment += flow.in_row(row) * (row + 0.5) * dx;
  }
  // mu u' per length of the face, at its height; a particle has the mass rho dx^2.
  EXPECT_NEAR(force * dx, nu * 2.0, 1e-9);
  EXPECT_NEAR(moment / force, face, 1e-9);
  // Without the surface the pull lies where the kernel reaches.
  const Sheared centres(2.0, 0.0, SolidNoSlip::centres);
  double centres_force = 0.0, centres_moment = 0.0;
  for (int row = 0; row < rows; ++row) {
    centres_force += centres.in_row(row);
    centres_moment += centres.in_row(row) * (row + 0.5) * dx;
  }
  EXPECT_LT(centres_moment / centres_force, face - 0.5 * dx);
}

TEST(SolidSurface, ForcesThatAreCarriedOutKeepTheirSum) {
  Sheared flow(0.0, 0.0);
  auto& particles = flow.simulation.state().particles;
  const SolidSurface<2> surface({{test::solid_block<2>({columns, rows}, dx), 0, particles.solids}},
                                particles);
  std::vector<Eigen::Matrix2d> moment(particles.solids, Eigen::Matrix2d::Zero());
  // A corner, a row below the face, and the middle of the body.
  for (const std::size_t i :
       {std::size_t{0}, std::size_t{columns * 3 + 7}, std::size_t{columns + 9}})
    moment[i] << 0.3, -0.7, 1.1, 0.2;
  std::vector<Vector<2>> force;
  surface.carry_out(moment, force);
  Vector<2> sum = Vector<2>::Zero();
  Eigen::Matrix2d first = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < force.size(); ++i) {
    sum += force[i];
    first += force[i] * particles.position[i].transpose();
  }
  EXPECT_LT(sum.norm(), 1e-12);
  EXPECT_LT((first - 3.0 * moment[0]).norm(), 1e-12);
}

}  // namespace
}  // namespace sprung::sph
