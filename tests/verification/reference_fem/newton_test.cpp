/// The line search of Newton's method in the time stepping: a load far beyond what one undamped
/// iteration can follow, put on at once.

#include "body_problem.hpp"

#include "reference_fem/settings.hpp"
#include "reference_fem/time_integration.hpp"

#include <gtest/gtest.h>

namespace sprung::reference {
namespace {

// The paper's beam without fluid, of St. Venant-Kirchhoff's material, under a force across its top
// that lays it over: by 82 % of its length.
constexpr double length = 0.1, thickness = 0.015, youngs = 0.7e6, force = 200.0;  // m, m, Pa, N/m

struct Loaded : testing::Body {
  static Problem problem() {
    Problem problem = testing::body_problem(thickness, length, youngs);
    problem.solids[0].clamped = Side::bottom;
    return problem;
  }
  Loaded()
      : Body(problem(), testing::sizes_of(0.02, 0.004, 0.008, 0),
             Material::from_youngs(MaterialLaw::st_venant_kirchhoff, youngs, 0.4, 1000.0)),
        load(traction_load(*space, Side::top, {force / thickness, 0.0})) {}
  double tip(const Fields& fields) const {
    return displacement_at(fields, {thickness / 2, length})[0];
  }
  std::vector<double> load;
};

/// One implicit step so long (s) that inertia, rho u/dt^2, is below 1e-7 of the load per volume:
/// what it solves for is equilibrium.
constexpr double long_step = 100.0;

TEST(LineSearch, TakesAStepThatNewtonsMethodAloneCannot) {
  Loaded beam;
  const MeshMotion motion(*beam.space, length, 1.25);
  beam.system->set_load(beam.load);
  NewtonSettings newton;
  newton.tolerance = 1e-8;
  newton.max_halvings = 0;
  {
    TimeIntegration alone(*beam.system, motion, newton);
    State state = alone.initial_state();
    EXPECT_THROW(alone.step(state, scheme_named("backward_euler"), long_step), InvertedCell);
    EXPECT_EQ(beam.tip(state.now), 0.0);  // left as it was
  }
  newton.max_halvings = NewtonSettings().max_halvings;
  TimeIntegration searching(*beam.system, motion, newton);
  State state = searching.initial_state();
  searching.step(state, scheme_named("backward_euler"), long_step);
  EXPECT_GT(searching.effort().halvings, 0);
  // The same elements' equilibrium, reached in forty increments of the load.
  Loaded same;
  const StaticSolution expected = solve_static(*same.system, same.load, 40, 1e-10);
  const double tip = same.tip(expected.fields);
  EXPECT_GT(tip, 0.8 * length);
  EXPECT_NEAR(beam.tip(state.now), tip, 1e-6 * tip);
}

TEST(LineSearch, CostsNothingWhereNothingGoesWrong) {
  Loaded beam;
  const MeshMotion motion(*beam.space, length, 1.25);
  std::vector<double> small = beam.load;
  for (double& x : small) x *= 1e-3;
  beam.system->set_load(small);
  long iterations[2];
  for (const int halvings : {0, 6}) {
    NewtonSettings newton;
    newton.max_halvings = halvings;
    TimeIntegration integration(*beam.system, motion, newton);
    State state = integration.initial_state();
    integration.step(state, scheme_named("backward_euler"), long_step);
    iterations[halvings / 6] = integration.effort().iterations;
    EXPECT_EQ(integration.effort().halvings, 0);
  }
  EXPECT_EQ(iterations[0], iterations[1]);
}

}  // namespace
}  // namespace sprung::reference
