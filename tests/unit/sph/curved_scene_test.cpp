/// Scenes with curved walls: how the lattice is cut and relaxed, and what is refused.

#include "sph/probes.hpp"
#include "sph/scene_setup.hpp"
#include "sph/time_step.hpp"
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

// Sites nearer to the wall than a quarter of the spacing are left out: what stays is the area that
// lies deeper. Counts of lattice points in a circle scatter by about eight (one orbit) and a half.
TEST(CurvedScene, LeavesOutAQuarterOfTheSpacing) {
  for (const auto& [spacing, dx] : {std::pair{"25 mm", 0.025}, {"12.5 mm", 0.0125}}) {
    const auto around = set_up<2>(box_scene(spacing, circle("0.25 m", "outside")));
    const auto within = set_up<2>(box_scene(spacing, circle("0.4 m", "inside")));
    const double outer = 0.25 + 0.25 * dx, inner = 0.4 - 0.25 * dx;
    EXPECT_NEAR(double(around.simulation->state().particles.unknowns),
                (1.0 - pi * outer * outer) / (dx * dx), 12.0);
    EXPECT_NEAR(double(within.simulation->state().particles.unknowns),
                pi * inner * inner / (dx * dx), 12.0);
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
Simulation<2> cut_lattice(bool inside) {
  const double dx = 0.025;
  CurvedWall wall;
  wall.radius = inside ? 0.4 : 0.25;
  wall.fluid_inside = inside;
  const ShapedWall<2> shaped{wall_shape<2>(wall), true};
  std::vector<Vector<2>> points;
  for (auto x : test::lattice<2>({40, 40}, dx)) {
    x -= Vector<2>(0.5, 0.5);
    if (shaped.shape->view(x).distance > 0.25 * dx) points.push_back(x);
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
// force on the circle is the weight of the fluid that it displaces (Archimedes). The pressure at
// the wall is fitted to a linear one exactly; the patches, chords replaced by arcs, add up to the
// area.
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
  const auto& wall = state.images.shaped()[0];
  const auto patches = wall.shape->patches(0.025);
  const Vector<2> force = force_on_surface(state, wall, patches, 1.0);
  const double buoyancy = 1000.0 * 9.81 * pi * 0.0625;
  EXPECT_NEAR(force[0], 0.0, 1e-7 * buoyancy);
  // The patch centres lie on the circle: the sum of n n over its arcs is exact for 16 and more.
  EXPECT_NEAR(force[1], buoyancy, 1e-7 * buoyancy);
}

void expect_refusal(const std::string& message, const std::vector<std::string>& words) {
  EXPECT_TRUE(message.starts_with("s.toml:")) << message;
  for (const auto& word : words) EXPECT_NE(message.find(word), std::string::npos) << message;
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
