/// Particle shifting, both kinds.

#include "sph/effects/shifting.hpp"

#include "sph/simulation.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1;

/// A particle far from the sides of the block below: 8 to a side.
template <int dim>
constexpr std::int64_t middle() {
  return dim == 2 ? 3 + 8 * 3 : 3 + 8 * (3 + 8 * 3);
}

/// A periodic block with one speed; `moved`: the middle one is off its site by so much.
template <int dim>
Simulation<dim> block(double jitter, const Vector<dim>& moved, double dt) {
  constexpr int side = 8;
  std::array<int, dim> count;
  count.fill(side);
  auto particles = test::particles_at<dim>(test::lattice<dim>(count, dx, jitter, 8), dx);
  particles.position[middle<dim>()] += moved;
  for (auto& u : particles.velocity) u = Vector<dim>::Constant(2.0 / std::sqrt(double(dim)));
  std::vector<PeriodicAxis> periodic;
  for (int d = 0; d < dim; ++d) periodic.push_back({d, 0.0, side * dx});
  Simulation<dim> simulation(test::preset("recommended"), std::move(particles),
                             Images<dim>({}, periodic));
  simulation.start(2.0, dt);
  simulation.choose_time_step();
  return simulation;
}

template <int dim, typename Direction>
std::vector<Vector<dim>> shifts(Simulation<dim>& simulation) {
  ShiftingEffect<dim, Direction> effect(Direction::default_coefficient);
  std::vector<Vector<dim>> displacement(simulation.state().particles.size(), Vector<dim>::Zero());
  effect.add_displacement(simulation.state(), displacement);
  return displacement;
}

/// The particle that was put off its site, wherever sorting has put it.
template <int dim>
std::size_t middle_now(const Simulation<dim>& simulation) {
  const auto& identity = simulation.state().particles.identity;
  return std::find(identity.begin(), identity.end(), middle<dim>()) - identity.begin();
}

template <int dim, typename Direction>
void expect_nothing_on_the_lattice() {
  auto simulation = block<dim>(0.0, Vector<dim>::Zero(), 0.01);
  const auto before = simulation.state().particles.velocity;
  const auto displacement = shifts<dim, Direction>(simulation);
  for (std::size_t i = 0; i < displacement.size(); ++i) {
    EXPECT_LT(displacement[i].norm(), 1e-14 * dx);
    EXPECT_LT((simulation.state().particles.velocity[i] - before[i]).norm(), 1e-14);
  }
}

TEST(Shifting, LeavesTheLatticeAsItIs) {
  expect_nothing_on_the_lattice<2, XuDirection>();
  expect_nothing_on_the_lattice<3, XuDirection>();
  expect_nothing_on_the_lattice<2, FickianDirection>();
  expect_nothing_on_the_lattice<3, FickianDirection>();
}

template <int dim, typename Direction>
void expect_sent_back() {
  const Vector<dim> moved = 0.1 * dx * Vector<dim>::Unit(dim - 1);
  auto simulation = block<dim>(0.0, moved, 0.001);
  const auto displacement = shifts<dim, Direction>(simulation);
  const Vector<dim> own = displacement[middle_now(simulation)];
  EXPECT_LT(own.dot(moved), 0.0);
  EXPECT_NEAR(own.norm(), std::abs(own[dim - 1]), 1e-12 * dx);  // straight back
}

TEST(Shifting, SendsAParticleBackToItsSite) {
  expect_sent_back<2, XuDirection>();
  expect_sent_back<3, XuDirection>();
  expect_sent_back<2, FickianDirection>();
  expect_sent_back<3, FickianDirection>();
}

// Fickian shifting with max(h |grad u|, u_max / 10) in the place of u_max: in a shear u = (g y, 0),
// of which corrected gradients are exact, |grad u| = g; where nothing slides u_max / 10 remains.
TEST(Shifting, FollowsTheSliding) {
  auto simulation = block<2>(0.2, Vector<2>::Zero(), 0.001);
  auto& state = simulation.state();
  const auto uniform = state.particles.velocity;
  const auto slow = shifts<2, SlidingDirection>(simulation);
  state.particles.velocity = uniform;
  const auto fast = shifts<2, FickianDirection>(simulation);
  for (std::size_t k = 0; k < slow.size(); ++k)
    EXPECT_LT((slow[k] - 6.0 / 10.0 / 0.5 * fast[k]).norm(), 1e-12 * dx);
  const double rate = 3.0;
  for (std::size_t i = 0; i < state.particles.size(); ++i)
    state.particles.velocity[i] = {rate * state.particles.position[i][1], 0.0};
  double fastest = 0.0;
  for (const auto& u : state.particles.velocity) fastest = std::max(fastest, u.norm());
  const auto velocity = state.particles.velocity;
  const std::size_t i = middle_now(simulation);
  const Vector<2> sliding = shifts<2, SlidingDirection>(simulation)[i];
  state.particles.velocity = velocity;
  const Vector<2> fickian = shifts<2, FickianDirection>(simulation)[i];
  const double ratio = SlidingDirection::default_coefficient * state.kernel.smoothing_length() *
                       rate / (FickianDirection::default_coefficient * fastest);
  EXPECT_GT(fickian.norm(), 1e-6 * dx);
  EXPECT_LT((sliding - ratio * fickian).norm(), 1e-10 * fickian.norm());
}

// The published formulas, summed over all particles and their periodic copies.
TEST(Shifting, HasTheSizeOfTheFormulas) {
  const double dt = 0.001, speed = 2.0;
  auto simulation = block<2>(0.2, Vector<2>::Zero(), dt);
  const auto& state = simulation.state();
  const auto points = state.particles.position;
  const Kernel<2>& kernel = state.kernel;
  const auto xu = shifts<2, XuDirection>(simulation);
  const auto fick = shifts<2, FickianDirection>(simulation);
  double largest = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Vector<2> sum = Vector<2>::Zero(), concentration = Vector<2>::Zero();
    double mean = 0.0;
    int count = 0;
    for (std::size_t j = 0; j < points.size(); ++j) {
      Vector<2> r = points[i] - points[j];
      for (int d = 0; d < 2; ++d) r[d] -= 0.8 * std::round(r[d] / 0.8);
      const double d = r.norm();
      if (j == i || d >= kernel.support_radius()) continue;
      sum += r / (d * d * d);
      mean += d;
      ++count;
      concentration += dx * dx * kernel.gradient_factor(d) * r;
    }
    mean /= count;
    const Vector<2> expected_xu = 0.04 * speed * dt * mean * mean * sum;
    const Vector<2> expected_fick = -0.5 * kernel.smoothing_length() * speed * dt * concentration;
    largest = std::max(largest, expected_xu.norm());
    EXPECT_LT((xu[i] - expected_xu).norm(), 1e-12 * dx);
    EXPECT_LT((fick[i] - expected_fick).norm(), 1e-12 * dx);
  }
  EXPECT_GT(largest, 1e-5 * dx);
  EXPECT_LT(largest, 0.1 * dx);
}

TEST(Shifting, IsCappedAtATenthOfTheSpacing) {
  for (const bool xu : {true, false}) {
    auto simulation = block<2>(0.3, Vector<2>::Zero(), 1.0);  // u dt = 20 dx
    const auto displacement =
        xu ? shifts<2, XuDirection>(simulation) : shifts<2, FickianDirection>(simulation);
    int capped = 0;
    for (const auto& d : displacement) {
      EXPECT_LE(d.norm(), 0.1 * dx * (1.0 + 1e-14));
      capped += d.norm() > 0.0999 * dx;
    }
    EXPECT_GT(capped, 20);
  }
}

// A linear velocity is taken to the new place exactly, with the corrected gradient: u changes by
// (grad u) x shift. Columns around the block are prescribed and keep what they have.
TEST(Shifting, TakesALinearVelocityToTheNewPlace) {
  std::vector<Vector<2>> inner, frame;
  const auto sites = test::lattice<2>({12, 12}, dx), moved = test::lattice<2>({12, 12}, dx, 0.2, 5);
  for (std::size_t k = 0; k < sites.size(); ++k)
    (sites[k].minCoeff() > 0.3 && sites[k].maxCoeff() < 0.9 ? inner : frame).push_back(moved[k]);
  auto particles = test::particles_at<2>(inner, dx);
  for (const auto& x : frame) particles.add(x, Vector<2>::Zero(), 0.0, Role::outflow);
  Simulation<2> simulation(test::preset("recommended"), std::move(particles), Images<2>({}));
  simulation.start(1.0, 0.005);
  simulation.choose_time_step();
  Eigen::Matrix2d gradient;
  gradient << 0.3, -1.2, 0.7, 0.4;
  auto& p = simulation.state().particles;
  for (std::size_t i = 0; i < p.size(); ++i) p.velocity[i] = gradient * p.position[i];
  for (const bool xu : {true, false}) {
    const auto before = p.velocity;
    const auto displacement =
        xu ? shifts<2, XuDirection>(simulation) : shifts<2, FickianDirection>(simulation);
    for (std::size_t i = 0; i < p.unknowns; ++i)
      EXPECT_LT((p.velocity[i] - before[i] - gradient * displacement[i]).norm(), 1e-14);
    for (std::size_t i = p.unknowns; i < p.size(); ++i) {
      EXPECT_EQ(p.velocity[i], before[i]);
      EXPECT_EQ(displacement[i], Vector<2>(0.0, 0.0));
    }
    p.velocity = before;
  }
}

}  // namespace
}  // namespace sprung::sph
