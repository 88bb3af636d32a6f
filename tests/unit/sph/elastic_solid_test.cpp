#include "sph/effects/elastic_solid.hpp"

#include "sph/simulation.hpp"
#include "sph/time_step.hpp"
#include "tests/unit/sph/particle_blocks.hpp"
#include "tests/unit/sph/solid_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sprung::sph {
namespace {

/// g and a as the header of ElasticSolid states them.
constexpr double g = 0.5, a = 0.1;

constexpr double dx = 0.1;
constexpr double stiffness = 2.0e3;  // N/m

/// One node tied to a ghost along x: a linear oscillator of frequency sqrt(k/m), whatever the
/// amplitude.
struct Oscillator {
  State<2> state{
      test::particles_at<2>({{1.0, 0.0}}, dx, Role::solid), Images<2>({}), {}, Kernel<2>(dx), {}};
  double frequency = std::sqrt(stiffness / state.particles.mass());
  ElasticSolid<2> solid;

  explicit Oscillator(SpringIntegration integration)
      : solid({{{1.0, 0.0}, {0.0, 0.0}}, 1, {dx * dx}, {{0, 1, 1.0, stiffness}}, {}, {}},
              state.particles, integration) {}
  double displacement() const { return state.particles.position[0][0] - 1.0; }
};

/// Trace and determinant of the step's matrix from four successive values of a linear oscillation:
/// x2 = T x1 - D x0, x3 = T x2 - D x1.
std::pair<double, double> trace_and_determinant(const std::array<double, 4>& x) {
  const double bottom = x[1] * x[1] - x[0] * x[2];
  return {(x[2] * x[1] - x[0] * x[3]) / bottom, (x[2] * x[2] - x[1] * x[3]) / bottom};
}

std::array<double, 4> four_steps(Oscillator& oscillator, double dt, bool implicit) {
  const std::vector<Vector<2>> none(1, Vector<2>::Zero());
  oscillator.state.particles.position[0][0] += 0.01;
  std::array<double, 4> x;
  for (double& value : x) {
    value = oscillator.displacement();
    test::step_solid(oscillator.solid, oscillator.state, dt, none, implicit);
  }
  return x;
}

/// Heights of the first three crests, each of the parabola through the three highest places.
std::vector<double> three_crests(const Oscillator& oscillator, const auto& step) {
  std::vector<double> crests;
  std::array<double, 3> x{0.0, 0.0, oscillator.displacement()};
  while (crests.size() < 3) {
    step();
    x = {x[1], x[2], oscillator.displacement()};
    if (x[0] == 0.0 || x[1] <= x[0] || x[1] < x[2]) continue;
    const double slope = 0.5 * (x[2] - x[0]), curvature = x[0] - 2.0 * x[1] + x[2];
    crests.push_back(x[1] - 0.5 * slope * slope / curvature);
  }
  return crests;
}

// With z = w dt and s = u dt, one implicit step is s' = s - Z (x + a s), x' = x + s' with
// Z = z^2/(1 + g z^2). Its matrix has trace 2 - (1 + a) Z and determinant 1 - a Z.
TEST(ImplicitSprings, OneModeFollowsTheDerivedRecurrence) {
  for (const double z : {0.05, 0.5, 1.0, 3.0, 30.0, 1000.0}) {
    Oscillator oscillator(SpringIntegration::implicit_force);
    const auto x = four_steps(oscillator, z / oscillator.frequency, true);
    const auto [trace, determinant] = trace_and_determinant(x);
    const double filtered = z * z / (1.0 + g * z * z);
    // Positions of size 1 hold a displacement of 0.01 to 1e-14; dividing by differences of the
    // order of Z costs up to 1/Z more.
    EXPECT_NEAR(trace, 2.0 - (1.0 + a) * filtered, 1e-10 / filtered) << z;
    EXPECT_NEAR(determinant, 1.0 - a * filtered, 1e-10 / filtered) << z;
  }
}

TEST(ImplicitSprings, DampingRatioAndItsLimit) {
  // Amplitude per step: sqrt(1 - a Z). Small z: damping ratio a w dt/2, next term of order z^2.
  Oscillator slow(SpringIntegration::implicit_force);
  const double z = 0.1;
  const auto [trace, determinant] =
      trace_and_determinant(four_steps(slow, z / slow.frequency, true));
  const double modulus = std::sqrt(determinant);
  const double angle = std::acos(0.5 * trace / modulus);
  EXPECT_NEAR(-std::log(modulus) / angle, 0.5 * a * z, 0.01 * 0.5 * a * z);
  EXPECT_NEAR(angle / z, 1.0, 2e-3);  // the frequency itself: error (g/2 - 1/24 + a^2/8) z^2
  // Stiff: sqrt(1 - a/g) = sqrt(0.8).
  Oscillator stiff(SpringIntegration::implicit_force);
  const auto fast = trace_and_determinant(four_steps(stiff, 1e4 / stiff.frequency, true));
  EXPECT_NEAR(std::sqrt(fast.second), std::sqrt(1.0 - a / g), 1e-6);
}

// The energy lost in one period is 1 - (1 - a Z)^(2 pi/theta), cos(theta) = (1 - (1 + a)
// Z/2)/sqrt(1
// - a Z): about 2 pi a z. Measured from the heights of successive crests.
TEST(ImplicitSprings, EnergyLostInAPeriodGrowsWithTheStep) {
  for (const double z : {0.02, 0.05, 0.1, 0.2}) {
    Oscillator oscillator(SpringIntegration::implicit_force);
    const std::vector<Vector<2>> none(1, Vector<2>::Zero());
    oscillator.state.particles.position[0][0] += 0.01;
    const auto crests = three_crests(oscillator, [&] {
      test::step_solid(oscillator.solid, oscillator.state, z / oscillator.frequency, none, true);
    });
    const double filtered = z * z / (1.0 + g * z * z);
    const double determinant = 1.0 - a * filtered;
    const double theta = std::acos((1.0 - 0.5 * (1.0 + a) * filtered) / std::sqrt(determinant));
    const double kept = std::pow(determinant, 2.0 * std::numbers::pi / theta);
    const double measured = crests[2] * crests[2] / (crests[1] * crests[1]);
    // A crest lies up to half a step beside the middle of three places: z^4/100 of its height.
    EXPECT_NEAR(1.0 - measured, 1.0 - kept, 0.05 * std::pow(z, 4) + 1e-9) << z;
    EXPECT_NEAR((1.0 - kept) / (2.0 * std::numbers::pi * a * z), 1.0, 0.6 * z) << z;
  }
}

TEST(ImplicitSprings, CarryALastingLoadExactlyWhateverTheStep) {
  const std::vector<Vector<2>> load{{5.0, 0.0}};
  const double rest = load[0][0] / stiffness;
  for (const double z : {0.01, 1.0, 10.0, 1000.0}) {
    Oscillator oscillator(SpringIntegration::implicit_force);
    const double dt = z / oscillator.frequency;
    oscillator.state.particles.position[0][0] += rest;
    for (int k = 0; k < 50; ++k)
      test::step_solid(oscillator.solid, oscillator.state, dt, load, true);
    EXPECT_NEAR(oscillator.displacement(), rest, 1e-12) << z;
    // What load() says is what was applied.
    EXPECT_NEAR(oscillator.solid.load(oscillator.state)[0][0],
                load[0][0] / oscillator.state.particles.mass(), 1e-9)
        << z;
  }
  for (const double z : {1.0, 10.0, 1000.0}) {
    // From the unloaded place: amplitudes fall by sqrt(1 - a Z) a step, (14/15)^300 = 1e-9 for z
    // = 1.
    Oscillator oscillator(SpringIntegration::implicit_force);
    for (int k = 0; k < 600; ++k)
      test::step_solid(oscillator.solid, oscillator.state, z / oscillator.frequency, load, true);
    EXPECT_NEAR(oscillator.displacement() / rest, 1.0, 1e-8) << z;
  }
}

/// The oscillator with a fluid of `ratio` times its mass that the projection makes move with it.
struct OscillatorInFluid : Oscillator {
  double ratio, fluid_velocity = 0.0;

  explicit OscillatorInFluid(double mass_ratio)
      : Oscillator(SpringIntegration::implicit_force), ratio(mass_ratio) {}
  void step(double dt) {
    auto& particles = state.particles;
    state.clock.time_step = dt;
    std::vector<Vector<2>> acceleration(1, Vector<2>::Zero());
    solid.add_acceleration(state, acceleration);
    const auto old = particles.velocity;
    // Both leave the projection with their common momentum's velocity, as after an inelastic shock.
    const double predicted = old[0][0] + dt * acceleration[0][0];
    fluid_velocity = (predicted + ratio * fluid_velocity) / (1.0 + ratio);
    particles.velocity[0] = {fluid_velocity, 0.0};
    solid.constrain(state, old);
    particles.position[0] += dt * particles.velocity[0];
    ++state.clock.step;
  }
};

// Together they are an oscillator of frequency w/sqrt(1 + ratio), so the implicit step should damp
// them by a w dt/(2 sqrt(1 + ratio)), the next term being of order (w dt)^2. Without the last
// step's withheld part in the prediction that is 1.2, 2.8 and 9 times as much at w dt = 0.3.
TEST(ImplicitSprings, AVibrationInAFluidIsDampedNoMoreThanOneWithout) {
  for (const double ratio : {1.0, 5.0, 20.0}) {
    OscillatorInFluid oscillator(ratio);
    const double z = 0.3, dt = z / oscillator.frequency;
    oscillator.state.particles.position[0][0] += 0.01;
    const auto crests = three_crests(oscillator, [&] { oscillator.step(dt); });
    const double damping = std::log(crests[1] / crests[2]) / (2.0 * std::numbers::pi);
    const double expected = 0.5 * a * z / std::sqrt(1.0 + ratio);
    EXPECT_NEAR(damping / expected, 1.0, z * z) << ratio;
  }
}

// Where the spring is stiff beyond all measure the roots of the step are those of l^2 - 2 c l + c,
// c = ratio/(1 + ratio) (and 0.8^(1/2) of the spring itself): they settle for any ratio.
TEST(ImplicitSprings, AStiffSpringInAHeavyFluidSettles) {
  for (const double ratio : {0.1, 1.0, 10.0, 100.0}) {
    OscillatorInFluid oscillator(ratio);
    const double dt = 1e3 / oscillator.frequency;
    oscillator.fluid_velocity = 1.0;
    const double shrink = std::max(std::sqrt(ratio / (1.0 + ratio)), std::sqrt(1.0 - a / g));
    const int steps = static_cast<int>(std::ceil(std::log(1e-4) / std::log(shrink)));
    for (int k = 0; k < steps; ++k) oscillator.step(dt);
    EXPECT_LT(std::abs(oscillator.fluid_velocity), 1e-2) << ratio;
  }
}

TEST(ImplicitSprings, ABentBodyRestsWhereForcesBalance) {
  const std::array<int, 2> count{4, 10};
  const double k_e = 3e4;
  std::array<Vector<2>, 2> tip;
  // First bending frequency about 3 rad/s here: z = 2 and 8, and 1000 steps damp it by 1e-20. Each
  // step is linearised, so the load is one that turns the beam by a few thousandths.
  for (const int k : {0, 1}) {
    const double dt = k == 0 ? 0.6 : 2.4;
    State<2> state{test::particles_at<2>(test::lattice<2>(count, dx), dx, Role::solid),
                   Images<2>({}),
                   {},
                   Kernel<2>(dx),
                   {}};
    ElasticSolid<2> solid(
        test::network_of<2>(state.particles, count, test::preset("recommended"), k_e, Side::bottom),
        state.particles, SpringIntegration::implicit_force);
    std::vector<Vector<2>> load(40, Vector<2>::Zero());
    for (std::size_t i = 36; i < 40; ++i) load[i] = {0.4, 0.1};
    for (int n = 0; n < 1000; ++n) test::step_solid(solid, state, dt, load, true);
    std::vector<Vector<2>> force;
    elastic_forces<2>(solid.network(), {state.particles.position.data(), 40}, force);
    for (std::size_t i = 0; i < 40; ++i)
      EXPECT_NEAR((force[i] + load[i]).norm(), 0.0, 1e-6 * load[39].norm()) << dt << ' ' << i;
    tip[k] = state.particles.position[39] - solid.network().reference[39];
  }
  EXPECT_GT(tip[0].norm(), 0.01 * dx);  // it did bend
  EXPECT_NEAR((tip[0] - tip[1]).norm(), 0.0, 1e-6 * tip[0].norm());
}

/// Two particles too far apart to be neighbours, joined by a spring, through the real time step.
Simulation<2> dumbbell(PositionUpdate update, double z) {
  Numerics numerics = test::preset("paper");
  numerics.position_update = update;
  numerics.shifting = Shifting::none;
  auto particles = test::particles_at<2>({{0.0, 0.0}, {3.0 * dx, 0.0}}, dx, Role::solid);
  const double dt = z / std::sqrt(2.0 * stiffness / particles.mass());
  ElasticNetwork<2> network = network_at_rest(particles);
  network.bonds = {{0, 1, 3.0 * dx, stiffness}};
  Simulation<2> simulation(numerics, std::move(particles), Images<2>({}));
  simulation.effects().body_forces.push_back(std::make_unique<ElasticSolid<2>>(
      network, simulation.state().particles, SpringIntegration::explicit_force));
  simulation.stand_in_vacuum();
  simulation.start(1.0, dt);
  simulation.state().particles.position[0][0] -= 0.01 * dx;
  simulation.state().particles.position[1][0] += 0.01 * dx;
  return simulation;
}

double extension(const Simulation<2>& simulation) {
  const auto& x = simulation.state().particles.position;
  return x[1][0] - x[0][0] - 3.0 * dx;
}

std::pair<double, double> measured(PositionUpdate update, double z) {
  auto simulation = dumbbell(update, z);
  std::array<double, 4> x;
  for (double& value : x) {
    value = extension(simulation);
    advance(simulation);
  }
  return trace_and_determinant(x);
}

// ACTION 8 with the mean velocity: s' = s - z^2 x, x' = x + (s + s')/2 = (1 - z^2/2) x + s. Trace
// 2 - z^2/2, determinant 1 + z^2/2: a complex pair of modulus sqrt(1 + z^2/2) (method.md section
// 2).
TEST(ExplicitSprings, MeanVelocityUpdateGrows) {
  for (const double z : {0.1, 0.5, 1.0}) {
    const auto [trace, determinant] = measured(PositionUpdate::mean_velocity, z);
    EXPECT_NEAR(trace, 2.0 - 0.5 * z * z, 1e-9) << z;
    EXPECT_NEAR(std::sqrt(determinant), std::sqrt(1.0 + 0.5 * z * z), 1e-9) << z;
  }
}

// With the new velocity: x' = x + s', trace 2 - z^2, determinant 1: neutral for z < 2.
TEST(ExplicitSprings, NewVelocityUpdateIsNeutral) {
  for (const double z : {0.1, 0.5, 1.0, 1.9}) {
    const auto [trace, determinant] = measured(PositionUpdate::new_velocity, z);
    EXPECT_NEAR(trace, 2.0 - z * z, 1e-9) << z;
    EXPECT_NEAR(determinant, 1.0, 1e-9) << z;
  }
}

TEST(ExplicitSprings, StableJustBelowTheLimitAndUnstableJustAbove) {
  auto below = dumbbell(PositionUpdate::new_velocity, 1.98);
  double largest = 0.0;
  for (int n = 0; n < 1000; ++n) {
    advance(below);
    largest = std::max(largest, std::abs(extension(below)));
  }
  // Amplitude of a leapfrog started at rest: x0/cos(theta/2) <= x0/sqrt(1 - z^2/4) = 7.1 x0.
  EXPECT_LT(largest, 7.2 * 0.02 * dx);
  auto above = dumbbell(PositionUpdate::new_velocity, 2.02);
  // Roots of r^2 + 2.0804 r + 1: 1.326 per step, so 12 steps give more than 10.
  for (int n = 0; n < 12; ++n) advance(above);
  EXPECT_GT(std::abs(extension(above)), 10.0 * 0.02 * dx);
}

TEST(ExplicitSprings, ABlockIsStableBelowTwoOverItsHighestFrequency) {
  const std::array<int, 2> count{5, 6};
  for (const auto& [factor, steps] : {std::pair{0.99, 2000}, {1.02, 60}}) {
    State<2> state{test::particles_at<2>(test::lattice<2>(count, dx), dx, Role::solid),
                   Images<2>({}),
                   {},
                   Kernel<2>(dx),
                   {}};
    ElasticSolid<2> solid(
        test::network_of<2>(state.particles, count, test::preset("paper"), 3e4, Side::bottom),
        state.particles, SpringIntegration::explicit_force);
    const double limit = 2.0 / highest_frequency(solid.network(), state.particles.density);
    EXPECT_NEAR(stable_time_step(solid.fastest_mode(state)), limit, 1e-12 * limit);
    const double small = 1e-7 * dx;
    for (std::size_t i = 0; i < 30; ++i)
      state.particles.position[i] += small * Vector<2>(std::sin(7.3 * i), std::cos(3.1 * i));
    const std::vector<Vector<2>> none(30, Vector<2>::Zero());
    double largest = 0.0;
    for (int n = 0; n < steps; ++n) test::step_solid(solid, state, factor * limit, none, false);
    for (std::size_t i = 0; i < 30; ++i)
      largest =
          std::max(largest, (state.particles.position[i] - solid.network().reference[i]).norm());
    // Below: each of 60 modes by 1/sqrt(1 - 0.99^2) = 7.1 at most, and their sum by its root.
    // Above: the highest mode grows by 1.49 a step, 2e10 in 60 steps.
    if (factor < 1.0) {
      EXPECT_LT(largest, 7.1 * std::sqrt(60.0) * small);
    } else {
      EXPECT_GT(largest, 1e4 * small);
    }
  }
}

}  // namespace
}  // namespace sprung::sph
