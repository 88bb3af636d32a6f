#include "sph/effects/contact.hpp"

#include "sph/effects/elastic_solid.hpp"
#include "tests/unit/sph/particle_blocks.hpp"
#include "tests/unit/sph/solid_step.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

constexpr double dx = 0.1, modulus = 1e5;  // m, Pa
constexpr int wide = 8, high = 3;

/// Two blocks in vacuum, one above the other: `gap` between the centres of the rows that face each
/// other, the upper one `aside` along them. Springs a thousand times as stiff as the contact keep
/// the faces flat.
struct Blocks {
  State<2> state;
  ElasticSolid<2> solid;
  std::size_t each = wide * high;

  explicit Blocks(double gap, double aside = 0.0, std::vector<Wall<2>> walls = {})
      : state{test::particles_at<2>(places(gap, aside), dx, Role::solid),
              Images<2>(walls),
              {},
              Kernel<2>(1.3 * dx),
              {}},
        solid(network(state.particles), state.particles, SpringIntegration::implicit_force) {
    solid.add(std::make_unique<Contact<2>>(contact(walls)));
    search();
  }

  static std::vector<Vector<2>> places(double gap, double aside) {
    auto points = test::lattice<2>({wide, high}, dx);
    const auto lower = points;
    for (const auto& x : lower) points.push_back(x + Vector<2>(aside, (high - 1) * dx + gap));
    return points;
  }
  static ElasticNetwork<2> network(const Particles<2>& particles) {
    auto network = network_at_rest(particles);
    const auto numerics = test::preset("recommended");
    const double k_e = 1e3 * modulus;
    for (std::size_t b = 0; b < 2; ++b) {
      Solid shape = test::solid_block<2>({wide, high}, dx);
      const Vector<2> corner = particles.position[b * wide * high] - Vector<2>(0.5 * dx, 0.5 * dx);
      for (int d = 0; d < 2; ++d) {
        shape.body.from[d] += corner[d];
        shape.body.to[d] += corner[d];
      }
      append_body<2>(network, particles, b * wide * high, (b + 1) * wide * high, shape, numerics,
                     {k_e, network_shear_modulus<2>(k_e, numerics.bonds)});
    }
    return network;
  }
  Contact<2> contact(const std::vector<Wall<2>>& walls = {}) const {
    return {{{0, each, modulus, false}, {each, 2 * each, modulus, false}}, state.particles, walls};
  }
  void search() {
    const auto& particles = state.particles;
    state.images.mirror(particles, state.kernel.support_radius());
    state.support.build(state.kernel, state.images.points(), particles.unknowns, particles.volume);
  }
  /// ACTIONs 4 to 9 for the solids alone. `load`: N/m on each particle.
  void step(double dt, const std::vector<Vector<2>>& load) {
    test::step_solid(solid, state, dt, load, true);
    search();
  }
  Vector<2> momentum(std::size_t first, std::size_t last) const {
    Vector<2> sum = Vector<2>::Zero();
    for (std::size_t i = first; i < last; ++i)
      sum += state.particles.mass() * state.particles.velocity[i];
    return sum;
  }
  double energy() const {
    double sum = solid.energy(state.particles) + solid.contact_energy(state);
    for (const auto& u : state.particles.velocity)
      sum += 0.5 * state.particles.mass() * u.squaredNorm();
    return sum;
  }
  /// Mean distance of the rows that face each other.
  double gap() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < wide; ++k)
      sum += state.particles.position[each + k][1] - state.particles.position[each - wide + k][1];
    return sum / wide;
  }
};

const std::vector<Vector<2>> no_load(2 * wide * high, Vector<2>::Zero());

/// Steps without inertia's memory until nothing moves.
void settle(Blocks& blocks, const std::vector<Vector<2>>& load) {
  for (int k = 0; k < 400; ++k) {
    blocks.step(1e-2, load);
    for (auto& u : blocks.state.particles.velocity) u.setZero();
  }
}

// A layer of thickness dx and modulus E under the pressure p: dx (1 - p/E), from one pressure to
// the next within 2 %. Where a row ends, the other's particles lie to one side and the normal
// leans, so that the two ends of either row push from dx (1 + tan^2) on: of 16 particles 4 hold by
// a tenth of dx more, which lifts the block by up to 0.015 dx.
TEST(Contact, TwoBlocksPressedTogetherRestAtTheDerivedGap) {
  double before = 0.0;
  for (const double pressure : {1e4, 3e4}) {
    Blocks blocks(1.02 * dx);
    auto load = no_load;
    for (std::size_t i = 0; i < load.size(); ++i)
      load[i][1] = (i < blocks.each ? 1.0 : -1.0) * pressure * dx / high;
    settle(blocks, load);
    EXPECT_NEAR(blocks.gap(), dx * (1.0 - pressure / modulus), 0.015 * dx);
    if (before > 0.0) {
      EXPECT_NEAR(before - blocks.gap(), dx * 2e4 / modulus, 0.02 * dx * 2e4 / modulus);
    }
    before = blocks.gap();
  }
}

// At a wall only the body's own half spacing is compressed: dx/2 (1 - p/E).
TEST(Contact, ABlockPressedToAWallRestsAtTheDerivedGap) {
  const double pressure = 1e4;
  Blocks blocks(40.0 * dx, 0.0, {{1, 0.0, 1, true}});  // the upper one is far away
  auto load = no_load;
  for (std::size_t i = 0; i < blocks.each; ++i) load[i][1] = -pressure * dx / high;
  settle(blocks, load);
  double height = 0.0;
  for (std::size_t k = 0; k < wide; ++k) height += blocks.state.particles.position[k][1] / wide;
  EXPECT_NEAR(height, 0.5 * dx * (1.0 - pressure / modulus), 2e-3 * 0.5 * dx * pressure / modulus);
}

// Rows that slide past each other: the force stays normal and of one size, wherever the particles
// of one row stand over the other's. Pairs of particles would make it vary by 13 % of dx, the
// height of the groove between two of them. The kernel's sum leans by up to 0.2 % on the lattice,
// over the 2.4 spacings that it reaches along the row. Ends of the rows are left out.
TEST(Contact, FacesSlideWithoutFriction) {
  for (const double aside : {0.0, 0.15, 0.3, 0.5, 0.75}) {
    Blocks blocks(0.9 * dx, aside * dx);
    blocks.state.clock.time_step = 1e-3;
    int counted = 0;
    for (const auto& touch : blocks.contact().find(blocks.state)) {
      const double x = blocks.state.particles.position[touch.nodes[0].node][0];
      if (x < 3.3 * dx || x > 5.2 * dx) continue;
      ++counted;
      EXPECT_NEAR(touch.overlap, 0.1 * dx, 5e-3 * dx) << aside;
      EXPECT_NEAR(std::abs(touch.nodes[0].gradient[1]), 1.0, 1e-3) << aside;
    }
    EXPECT_GE(counted, 2) << aside;
  }
}

// Forces of a touch add up to zero, and so does their moment where the near row reaches to both
// sides: round-off, and for the moment the 1e-9 that keeps its small system regular.
TEST(Contact, KeepsMomentumAndAngularMomentum) {
  Blocks blocks(0.9 * dx, 0.3 * dx);
  blocks.state.clock.time_step = 1e-3;
  for (const auto& touch : blocks.contact().find(blocks.state)) {
    const auto& position = blocks.state.particles.position;
    Vector<2> force = Vector<2>::Zero();
    double moment = 0.0;
    for (const auto& node : touch.nodes) {
      force += node.gradient;
      const Vector<2> arm = position[node.node] - position[touch.nodes[0].node];
      moment += arm[0] * node.gradient[1] - arm[1] * node.gradient[0];
    }
    EXPECT_NEAR(force.norm(), 0.0, 1e-12);
    const double x = position[touch.nodes[0].node][0];
    if (x > 3.3 * dx && x < 5.2 * dx) {
      EXPECT_NEAR(moment, 0.0, 1e-10 * dx);
    }
  }
}

/// Two blocks `columns` wide, rigid, face to face, `gap` between the rows that face each other.
struct Pressed {
  State<2> state;
  Contact<2> contact;

  Pressed(int columns, double gap, const std::vector<Wall<2>>& walls = {})
      : state{test::particles_at<2>(places(columns, gap), dx, Role::solid),
              Images<2>(walls),
              {},
              Kernel<2>(1.3 * dx),
              {}},
        contact({{0, each(columns), modulus, false},
                 {each(columns), 2 * each(columns), modulus, false}},
                at_rest(columns), walls) {
    const auto& particles = state.particles;
    state.images.mirror(particles, state.kernel.support_radius());
    state.support.build(state.kernel, state.images.points(), particles.unknowns, particles.volume);
  }
  static std::size_t each(int columns) { return static_cast<std::size_t>(columns * high); }
  static std::vector<Vector<2>> places(int columns, double gap) {
    auto points = test::lattice<2>({columns, high}, dx);
    const auto lower = points;
    for (const auto& x : lower) points.push_back(x + Vector<2>(0.0, (high - 1) * dx + gap));
    return points;
  }
  /// Far from each other and from any wall.
  static Particles<2> at_rest(int columns) {
    auto points = places(columns, 2.0 * dx);
    for (auto& x : points) x[1] += 10.0 * dx;
    return test::particles_at<2>(points, dx, Role::solid);
  }
  /// N/m, on the upper block.
  Vector<2> force(int columns) const {
    Vector<2> sum = Vector<2>::Zero();
    for (const auto& touch : contact.find(state))
      for (const auto& node : touch.nodes)
        if (static_cast<std::size_t>(node.node) >= each(columns))
          sum += touch.stiffness * touch.overlap * node.gradient;
    return sum;
  }
};

// A layer of thickness dx and modulus E: E/2 (1 - gap/dx)^2 dx per area, which is what pressing the
// blocks together costs against the force on the upper one. Blocks of 12 and of 8 columns have the
// same ends, so their difference is that of four columns between them. The force is linear in the
// gap: the trapezoidal sum of its work is exact, as the faces meet at one of its places.
TEST(Contact, StoresTheWorkDoneAgainstIt) {
  const double most = 0.5 * modulus * 0.3 * 0.3 * dx * 4.0 * dx;
  double work = 0.0, force_before = 0.0, gap_before = 1.05 * dx;
  for (const double part : {1.05, 1.0, 0.95, 0.9, 0.8, 0.7}) {
    const double gap = part * dx, strain = std::max(0.0, 1.0 - part);
    const Pressed wider(12, gap), narrower(8, gap);
    const double stored =
        wider.contact.energy(wider.state) - narrower.contact.energy(narrower.state);
    const double force = wider.force(12)[1] - narrower.force(8)[1];
    work += 0.5 * (force_before + force) * (gap_before - gap);
    force_before = force;
    gap_before = gap;
    EXPECT_NEAR(stored, 0.5 * modulus * strain * strain * dx * 4.0 * dx, 1e-9 * most) << part;
    EXPECT_NEAR(stored, work, 1e-9 * most) << part;
  }
}

// At a wall a layer of dx/2: E/2 (1 - 2 gap/dx)^2 dx/2 per area, over the lower block's columns,
// whatever their speed.
TEST(Contact, StoresTheWorkDoneAgainstAWall) {
  for (const double part : {0.55, 0.5, 0.45, 0.3}) {
    Pressed pressed(8, 40.0 * dx, {{1, (0.5 - part) * dx, 1, true}});
    for (auto& u : pressed.state.particles.velocity) u = {0.0, -1.0};
    pressed.state.clock.time_step = 1e-2;
    const double strain = std::max(0.0, 1.0 - 2.0 * part);
    EXPECT_NEAR(pressed.contact.energy(pressed.state),
                0.5 * modulus * strain * strain * 0.5 * dx * 8.0 * dx, 1e-9 * modulus * dx * dx)
        << part;
  }
}

// Two blocks meet at 2 U and part: their momenta stay opposite, no step of the meeting adds energy
// beyond what it started with, they part no faster than they met, and not stuck together either.
// Momenta to the round-off of a solution whose matrix spans dt^2 k/m = 1e6. Steps from a twentieth
// of the contact's period (2 pi sqrt(3 rho/E) dx / sqrt 2 = 77 ms) to four times it.
TEST(Contact, ARebound) {
  constexpr double speed = 0.1;
  for (const double dt : {4e-3, 2e-2, 0.3}) {
    Blocks blocks(1.0 * dx + 2.0 * speed * 2e-2);
    for (std::size_t i = 0; i < blocks.state.particles.size(); ++i)
      blocks.state.particles.velocity[i][1] = i < blocks.each ? speed : -speed;
    const double before = blocks.energy(), size = blocks.momentum(0, blocks.each).norm();
    for (int k = 0; k < static_cast<int>(0.5 / dt) + 3; ++k) {
      blocks.step(dt, no_load);
      EXPECT_LE(blocks.energy(), before * (1.0 + 1e-9)) << dt;
      EXPECT_LE(blocks.momentum(0, 2 * blocks.each).norm(), 1e-8 * size) << dt;
      EXPECT_GT(blocks.gap(), 0.5 * dx) << dt;
    }
    const double parting = -blocks.momentum(0, blocks.each)[1] / size;
    EXPECT_LE(parting, 1.0) << dt;
    EXPECT_GE(parting, dt < 1e-2 ? 0.5 : -1e-9) << dt;
  }
}

}  // namespace
}  // namespace sprung::sph
