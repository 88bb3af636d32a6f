/// The viscosity of Carreau and Yasuda: the law by hand, and the viscous term it gives.

#include "sph/effects/viscosity.hpp"
#include "sph/simulation.hpp"

#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace sprung::sph {
namespace {

constexpr double tau = 2.0 * std::numbers::pi;

TEST(CarreauYasuda, IsTheLawByHand) {
  const CarreauYasuda law{0.1, 2.0, 0.5, 2.0};
  EXPECT_DOUBLE_EQ(viscosity_ratio(law, 1.0, 0.0), 1.0);
  // rate sqrt(15)/2: (1 + 15)^(-1/4) = 1/2, so 0.1 + 0.9/2.
  EXPECT_NEAR(viscosity_ratio(law, 1.0, 0.5 * std::sqrt(15.0)), 0.55, 1e-15);
  EXPECT_NEAR(viscosity_ratio(law, 1.0, 1e12), 0.1, 1e-5);
  EXPECT_DOUBLE_EQ(viscosity_ratio({0.1, 2.0, 1.0, 2.0}, 1.0, 7.0), 1.0);
}

/// div(2 nu D) of that field at (x, y). D has only the shear s = (u_y + v_x)/2 off its diagonal, so
/// the components are d/dy and d/dx of nu (u_y + v_x): here by central differences of the formula.
Vector<2> exact_term(double x, double y, double b, const CarreauYasuda& law) {
  const auto stress = [&](double at_x, double at_y) {
    const double shear = tau * (std::cos(tau * at_y) + b * std::cos(tau * at_x));
    return viscosity_ratio(law, 1.0, std::abs(shear)) * shear;
  };
  const double h = 1e-5;
  return {(stress(x, y + h) - stress(x, y - h)) / (2.0 * h),
          (stress(x + h, y) - stress(x - h, y)) / (2.0 * h)};
}

/// Relative rms error of the viscous term of the fluid `law` at unit density, n particles a side of
/// the periodic unit square, for u = (sin 2 pi y, b sin 2 pi x).
double rms_error(int n, double b, const CarreauYasuda& law) {
  const double dx = 1.0 / n;
  auto particles = test::particles_at<2>(test::lattice<2>({n, n}, dx), dx);
  Simulation<2> simulation(test::preset("recommended"), std::move(particles),
                           Images<2>({}, {{0, 0.0, 1.0}, {1, 0.0, 1.0}}));
  simulation.start(1.0, 0.01);
  simulation.choose_time_step();
  auto& p = simulation.state().particles;
  for (std::size_t i = 0; i < p.size(); ++i)
    p.velocity[i] = {std::sin(tau * p.position[i][1]), b * std::sin(tau * p.position[i][0])};
  std::vector<Vector<2>> found(p.size(), Vector<2>::Zero());
  ViscosityEffect<2, CarreauYasudaLaw<2>> effect(1.0, p, nullptr, {law, 1.0});
  effect.add_acceleration(simulation.state(), found);
  p.carried.pop_back();  // the effect ends here
  double error = 0.0, size = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector<2> wanted = exact_term(p.position[i][0], p.position[i][1], b, law);
    error += (found[i] - wanted).squaredNorm();
    size += wanted.squaredNorm();
  }
  return std::sqrt(error / size);
}

TEST(CarreauYasuda, ViscousTermConvergesToTheDivergenceOfTheStress) {
  // b = 0 is a shear flow; with b = 1/2 the term (grad u)^T grad nu counts, too.
  const CarreauYasuda law{0.1, 0.2, 0.5, 2.0};
  for (const double b : {0.0, 0.5}) {
    const double coarse = rms_error(20, b, law), fine = rms_error(40, b, law);
    // Second order on the lattice; a missing or wrong term would leave an error that stays.
    EXPECT_GT(coarse / fine, 3.4) << "b = " << b << ", errors " << coarse << ", " << fine;
    EXPECT_LT(fine, 0.02) << "b = "
                          << b;  // (2 pi h)^2 / 12 with the widest part of the stencil, twice
  }
}

}  // namespace
}  // namespace sprung::sph
