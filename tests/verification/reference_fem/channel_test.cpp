/// Flow without bodies: Poiseuille's profile and pressure, in steady state and starting from rest.

#include "reference_fem/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sprung::reference {
namespace {

Problem channel() {
  Problem problem;
  problem.channel = {{0, 0, 0}, {0.9, 0.3, 0}};
  problem.density = 1000.0;
  problem.viscosity = Viscosity{1.0};
  problem.walls = Walls{{Side::bottom, Side::top}, {}};
  problem.outflow = PressureSide{};
  return problem;
}

Settings settings(double step, const std::string& scheme) {
  Settings s;
  s.sizes = {0.05, 0.005, 0.005, 0.01, 2.0, 0};
  s.time_step = s.largest_time_step = step;
  s.step_tolerance = 1e-5;
  s.scheme = scheme_named(scheme);
  s.starter = starter_of(s.scheme);
  s.mesh_stiffening = 1.25;
  s.checkpoint_every = 1e9;
  s.newton.tolerance = 1e-10;
  return s;
}

double pressure_at(Simulation& simulation, double x, double y) {
  const Space& space = simulation.system().space();
  const std::vector<double> rest(simulation.state().now.displacement.size(), 0.0);
  const Place place = Locator(space, rest).find({x, y});
  std::vector<double> modes(static_cast<std::size_t>(space.pressures_per_cell()));
  space.pressure_values(place.cell, {x, y}, modes.data());
  double p = 0.0;
  for (std::size_t m = 0; m < modes.size(); ++m)
    p += modes[m] *
         simulation.state().now.pressure[static_cast<std::size_t>(place.cell) * modes.size() + m];
  return p;
}

TEST(Channel, PoiseuilleLeavesUndisturbed) {
  Problem problem = channel();
  problem.end_time = 2000.0;  // twenty viscous times H^2/nu
  problem.inflow = Inflow{Side::left, Inflow::Profile::parabolic, 0.5, 10.0, {}};
  Simulation simulation(problem, settings(20.0, "backward_euler"));
  while (simulation.state().time < problem.end_time) simulation.advance(problem.end_time);
  // A parabola and a linear pressure lie in the spaces, so the solution is exact up to the solver.
  const Space& space = simulation.system().space();
  for (int n = 0; n < space.nodes(); ++n) {
    const double y = space.position(n)[1];
    const auto i = 2 * static_cast<std::size_t>(n);
    EXPECT_NEAR(simulation.state().now.velocity[i], 6.0 * 0.5 * y * (0.3 - y) / 0.09, 1e-8);
    EXPECT_NEAR(simulation.state().now.velocity[i + 1], 0.0, 1e-8);
  }
  // 12 mu u / H^2 = 66.67 Pa/m (method.md, section 3), nought at the outflow.
  EXPECT_NEAR(pressure_at(simulation, 0.45, 0.15), 12.0 * 0.5 / 0.09 * 0.45, 1e-5);
  EXPECT_NEAR(pressure_at(simulation, 0.9, 0.15), 0.0, 1e-5);
  const Balance b =
      balance(simulation.system(), simulation.state().now, simulation.integration().weights());
  EXPECT_NEAR(b.inflow, 0.15, 1e-10);
  EXPECT_NEAR(b.outflow, 0.15, 1e-10);
  // What goes in is dissipated: 12 mu u^2 / H per metre of channel.
  EXPECT_NEAR(b.power, b.dissipation, 1e-8);
  EXPECT_NEAR(b.dissipation, 12.0 * 0.25 / 0.3 * 0.9, 1e-7);
}

/// Centre velocity over its final value in a channel opened to a pressure difference at T = 0
/// (method.md, section 5): 1 - sum (-1)^n 32 / ((2n+1)^3 pi^3) exp(-(2n+1)^2 pi^2 T/4), T = nu
/// t/a^2.
double startup(double t) {
  double sum = 1.0;
  for (int n = 0; n < 50; ++n) {
    const double k = (2.0 * n + 1.0) * std::numbers::pi;
    sum -= (n % 2 == 0 ? 1.0 : -1.0) * 32.0 / (k * k * k) * std::exp(-k * k * t / 4.0);
  }
  return sum;
}

/// Error of the centre velocity at T = 0.5 with `steps` steps.
double startup_error(const std::string& scheme, int steps) {
  Problem problem = channel();
  problem.viscosity->dynamic = 90.0;  // nu/a^2 = 4/s
  problem.end_time = 0.125;
  problem.outflow->pressure = -1000.0;  // the left side is open, too, at zero
  Simulation simulation(problem, settings(problem.end_time / steps, scheme));
  for (int i = 0; i < steps; ++i) simulation.advance(problem.end_time);
  const Space& space = simulation.system().space();
  const std::vector<double> rest(simulation.state().now.displacement.size(), 0.0);
  const Vec2 v =
      evaluate(space, simulation.state().now.velocity, Locator(space, rest).find({0.45, 0.15}));
  const double steady = 1000.0 / 0.9 * 0.15 * 0.15 / (2.0 * 90.0);
  return v[0] / steady - startup(0.5);
}

TEST(Channel, StartUpFlowAgreesWithItsSeries) {
  EXPECT_NEAR(startup(0.5), 0.699455, 1e-6);  // method.md, section 5
  // Space: quadratic elements on 15 mm against a smooth profile; time: second order from 20 steps.
  EXPECT_NEAR(startup_error("tr_bdf2", 20), 0.0, 5e-4);
}

TEST(Channel, SecondOrderInTime) {
  const double coarse = startup_error("tr_bdf2", 2), middle = startup_error("tr_bdf2", 4),
               fine = startup_error("tr_bdf2", 8);
  const double order = std::log2((coarse - middle) / (middle - fine));
  // Asymptotically 2; so few steps leave room on both sides.
  EXPECT_GT(order, 1.6);
  EXPECT_LT(order, 3.0);
}

}  // namespace
}  // namespace sprung::reference
