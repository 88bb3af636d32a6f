/// Scenes with curved walls: how the lattice is cut and relaxed, and what is refused.

#include "sph/scene_setup.hpp"
#include "sph/time_step.hpp"
#include "sph/wall_force.hpp"
#include "tests/unit/scene/beam_scene.hpp"
#include "tests/unit/scene/temporary_folder.hpp"
#include "tests/unit/sph/channel_scene.hpp"
#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sprung::sph {
namespace {

using sprung::test::scene_error;
using sprung::test::TemporaryFolder;

constexpr double pi = std::numbers::pi;

template <int dim>
ParticleScene<dim> set_up(const std::string& text) {
  const TemporaryFolder folder;
  Document document = Document::from_text(text, "s.toml");
  return sph::set_up<dim>(document, test::plane_modulus_table(folder.path() / "table.csv"));
}

/// A periodic box of one metre about the origin, the fluid at rest; `more`: the wall and the rest.
std::string box_scene(const std::string& spacing, const std::string& more) {
  return "title = \"t\"\n[domain]\nchannel = { from = [\"-0.5 m\", \"-0.5 m\"], to = [\"0.5 m\", "
         "\"0.5 m\"] }\n[time]\nend = \"1 s\"\n[fluid]\ndensity = \"1000 kg/m3\"\n[periodic]\naxes "
         "= "
         "[\"x\", \"y\"]\n[sph]\nspacing = \"" +
         spacing + "\"\nvelocity_scale = \"1 m/s\"\n" + more;
}

std::string circle(const std::string& radius, const std::string& fluid) {
  return "[curved_wall.w]\ncircle = { centre = [\"0 m\", \"0 m\"], radius = \"" + radius +
         "\" }\nfluid = \"" + fluid + "\"\nslip = \"no_slip\"\n";
}

struct Spread {
  double lowest, highest;
};

template <int dim>
Spread spread(const Simulation<dim>& simulation) {
  const auto& partition = simulation.state().support.partition();
  const auto [low, high] = std::minmax_element(partition.begin(), partition.end());
  return {*low, *high};
}

// As many particles as the fluid's volume holds, to the eight of the lattice that stand or fall
// together, a half, and what the linear share of a cut cell misses: up to 0.04 of some 25
// independent cells, eight times each, so about 1; three times that.
TEST(CurvedScene, HoldsTheFluidsVolume) {
  for (const auto& [spacing, dx] : {std::pair{"25 mm", 0.025}, {"12.5 mm", 0.0125}}) {
    const auto around = set_up<2>(box_scene(spacing, circle("0.25 m", "outside")));
    const auto within = set_up<2>(box_scene(spacing, circle("0.4 m", "inside")));
    EXPECT_NEAR(double(around.simulation->state().particles.unknowns),
                (1.0 - pi * 0.0625) / (dx * dx), 11.5);
    EXPECT_NEAR(double(within.simulation->state().particles.unknowns), pi * 0.16 / (dx * dx), 11.5);
    for (const auto& x : around.simulation->state().particles.position) EXPECT_GT(x.norm(), 0.25);
    for (const auto& x : within.simulation->state().particles.position) EXPECT_LT(x.norm(), 0.4);
  }
}

TEST(CurvedScene, APolygonAlongTheLatticeHoldsExactlyItsCells) {
  const auto scene = set_up<2>(box_scene(
      "25 mm",
      "[curved_wall.w]\npolygon = [[\"-0.2 m\", \"-0.2 m\"], [\"0.2 m\", \"-0.2 m\"], [\"0.2 m\", "
      "\"0.1 m\"], [\"-0.2 m\", \"0.1 m\"]]\nfluid = \"outside\"\nslip = \"no_slip\"\n"));
  EXPECT_EQ(scene.simulation->state().particles.unknowns, 40u * 40u - 16u * 12u);
}

TEST(CurvedScene, APipeInSpace) {
  const auto scene = set_up<3>(
      "title = \"t\"\n[domain]\nchannel = { from = [\"0 m\", \"-0.6 m\", \"-0.6 m\"], to = [\"0.5 "
      "m\", \"0.6 m\", \"0.6 m\"] }\n[time]\nend = \"1 s\"\n[fluid]\ndensity = \"1000 "
      "kg/m3\"\n[periodic]\naxes = [\"x\"]\n[sph]\nspacing = \"0.1 m\"\nvelocity_scale = \"1 "
      "m/s\"\n[curved_wall.pipe]\ncylinder = { axis = \"x\", centre = [\"0 m\", \"0 m\"], radius = "
      "\"0.5 m\" }\nfluid = \"inside\"\nslip = \"no_slip\"\n");
  const auto& particles = scene.simulation->state().particles;
  // Five layers, each with up to eight particles more or less.
  EXPECT_NEAR(double(particles.unknowns), pi * 0.25 * 0.5 / 1e-3, 5 * 8.5);
  for (const auto& x : particles.position) EXPECT_LT(x.tail<2>().norm(), 0.5);
}

/// A lattice cut by a round wall, periodic, as it is before it is relaxed.
Simulation<2> cut_lattice(bool inside, double gap = 0.25) {
  const double dx = 0.025;
  CurvedWall wall;
  wall.radius = inside ? 0.4 : 0.25;
  wall.fluid_inside = inside;
  const ShapedWall<2> shaped{wall_shape<2>(wall), true};
  std::vector<Vector<2>> points;
  for (auto x : test::lattice<2>({40, 40}, dx)) {
    x -= Vector<2>(0.5, 0.5);
    if (shaped.shape->view(x).distance > gap * dx) points.push_back(x);
  }
  Simulation<2> simulation(test::preset("recommended"), test::particles_at<2>(points, dx),
                           Images<2>({}, {{0, -0.5, 0.5}, {1, -0.5, 0.5}}, {shaped}));
  simulation.start(1.0, 0.01);
  return simulation;
}

TEST(CurvedScene, RelaxingEvensTheFilling) {
  for (const bool inside : {false, true}) {
    auto simulation = cut_lattice(inside);
    const Spread before = spread(simulation);
    simulation.relax(200);
    const Spread after = spread(simulation);
    EXPECT_GT(before.highest - before.lowest, 0.1);
    EXPECT_LT(after.highest - after.lowest, 0.4 * (before.highest - before.lowest));
    const auto& state = simulation.state();
    for (const auto& x : state.particles.position) {
      EXPECT_FALSE(state.images.outside_a_wall(x));
      EXPECT_LE(x.cwiseAbs().maxCoeff(), 0.5);
    }
  }
}

// A force that pressure alone balances: the fluid between circle and box stays at rest, and the
// force on the circle is the weight of the fluid that it displaces (Archimedes): patches, chords
// replaced by arcs, add up to the area, and the fluid adds no force of its own.
TEST(CurvedScene, HydrostaticForceIsTheBuoyancy) {
  const auto text = box_scene("25 mm", circle("0.25 m", "outside"));
  const std::string periodic = "[periodic]\naxes = [\"x\", \"y\"]\n";
  std::string closed = text;
  closed.replace(
      closed.find(periodic), periodic.size(),
      "[walls]\nno_slip = [\"left\", \"right\", \"bottom\", \"top\"]\n[viscosity]\ndynamic "
      "= \"1 Pa s\"\n[gravity]\nacceleration = [\"0 m/s2\", \"-9.81 m/s2\"]\n");
  closed += "[numerics]\ndensity_feedback = 0\n";
  const auto scene = set_up<2>(closed);
  auto& simulation = *scene.simulation;
  for (int n = 0; n < 5; ++n) advance(simulation);
  const auto& state = simulation.state();
  for (const auto& u : state.particles.velocity) EXPECT_EQ(u, Vector<2>(0.0, 0.0));
  const Vector<2> force = WallForce<2>(state, state.images.shaped()[0])(state, 1.0);
  const double buoyancy = 1000.0 * 9.81 * pi * 0.0625;
  EXPECT_NEAR(force[0], 0.0, 1e-7 * buoyancy);
  // The patch centres lie on the circle: the sum of n n over its arcs is exact for 16 and more.
  EXPECT_NEAR(force[1], buoyancy, 1e-7 * buoyancy);
}

// rho a = div sigma with p = -rho a . x and u = (y^2, 0) smooth across the circle, too, so the
// force on it is the integral of div sigma over the disc: rho a pi R^2 of the pressure and 2 mu pi
// R^2 along x of the shear. The lattice holds the circle's area, 314 cells, to about five.
TEST(CurvedScene, ForceFollowsFromTheMomentumAboutTheWall) {
  auto simulation = cut_lattice(false, 0.0);
  auto& state = simulation.state();
  auto& particles = state.particles;
  const double mu = 0.7, density = particles.density;
  const Vector<2> pushed(0.3, -0.8);
  state.clock.step = 1;
  state.clock.time_step = 0.01;
  for (std::size_t i = 0; i < particles.unknowns; ++i) {
    const Vector<2>& x = particles.position[i];
    particles.pseudo_pressure[i] = pushed.dot(x);
    particles.velocity[i] = {x[1] * x[1], 0.0};
    particles.predicted_velocity[i] =
        particles.velocity[i] - 0.01 * (pushed + Vector<2>(2.0 * mu / density, 0.0));
  }
  const double area = pi * 0.0625;
  const Vector<2> expected = density * area * pushed + Vector<2>(2.0 * mu * area, 0.0);
  const WallForce<2> measure(state, state.images.shaped()[0]);
  EXPECT_EQ(measure.obstacle(), "");
  EXPECT_LT((measure(state, mu) - expected).norm(), 0.03 * expected.norm());
}

void expect_refusal(const std::string& message, const std::vector<std::string>& words) {
  EXPECT_TRUE(message.starts_with("s.toml:")) << message;
  for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
}

TEST(CurvedScene, RefusesAForceOnAWallWithAnotherBesideIt) {
  std::string text = box_scene("25 mm", circle("0.25 m", "outside")) +
                     "[curved_wall.v]\ncircle = { centre = [\"0.29 m\", \"0.29 m\"], radius = "
                     "\"0.1 m\" }\nfluid = \"outside\"\nslip = \"no_slip\"\n"
                     "[probes.f]\nforce_on = \"w\"\n";
  expect_refusal(scene_error([&] { set_up<2>(text); }),
                 {"[probes.f] force_on", "0.09 m", "another curved wall", "smaller spacing"});
}

TEST(CurvedScene, RefusesAWallTighterThanTheKernel) {
  expect_refusal(scene_error([] { set_up<2>(box_scene("50 mm", circle("0.1 m", "outside"))); }),
                 {"s.toml:13: [curved_wall.w]", "0.1 m", "0.13 m", "smaller spacing"});
}

TEST(CurvedScene, RefusesAWallThatLeavesNoFluid) {
  expect_refusal(scene_error([] { set_up<2>(box_scene("50 mm", circle("2 m", "outside"))); }),
                 {"s.toml:13: [curved_wall.w]", "no room for fluid", "inside"});
}

TEST(CurvedScene, RefusesAnOpenSurfaceAndNamesTheFile) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "open.stl";
  std::ofstream(file) << "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 "
                         "0\nvertex 0 1 0\nendloop\nendfacet\nendsolid t\n";
  const std::string text =
      "title = \"t\"\n[domain]\nchannel = { from = [\"0 m\", \"0 m\", \"0 m\"], to = [\"1 m\", \"1 "
      "m\", \"1 m\"] }\n[time]\nend = \"1 s\"\n[fluid]\ndensity = \"1000 kg/m3\"\n[sph]\nspacing = "
      "\"0.1 m\"\nvelocity_scale = \"1 m/s\"\n[curved_wall.pipe]\nsurface = { file = \"" +
      file.string() + "\" }\nfluid = \"inside\"\nslip = \"no_slip\"\n";
  expect_refusal(scene_error([&] { set_up<3>(text); }),
                 {"s.toml:12: [curved_wall.pipe] surface", file.string(), "not closed"});
}

TEST(CurvedScene, RefusesASceneThatShowsNoSpeed) {
  std::string text = box_scene("50 mm", "");
  text.replace(text.find("velocity_scale = \"1 m/s\"\n"), 25, "");
  expect_refusal(scene_error([&] { set_up<2>(text); }), {"velocity_scale", "must be given"});
}

TEST(CurvedScene, RefusesAVelocityThatIsNotFinite) {
  expect_refusal(scene_error([] {
                   set_up<2>(box_scene("50 mm", "[initial]\nvelocity = [\"0\", \"log(x)\"]\n"));
                 }),
                 {"[initial] velocity", "not finite", "(-0.475, -0.475, 0) m"});
}

}  // namespace
}  // namespace sprung::sph
