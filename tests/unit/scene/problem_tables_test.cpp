/// The tables beside the beam's: periodic axes, moving and curved walls, uniform forces, velocity
/// at the start, pressures at open sides, waveforms, and the probes of pressure and wall force.

#include "scene/problem.hpp"

#include "tests/unit/scene/beam_scene.hpp"
#include "tests/unit/scene/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <array>

namespace sprung {
namespace {

using test::scene_error;
using test::TemporaryFolder;

/// Seven lines, a channel of 2 m x 1 m (x 1 m); the tables of the test begin at line 8.
std::string scene(const std::string& tables, bool space = false) {
  return std::string("title = \"t\"\n[domain]\nchannel = { from = [\"0 m\", \"0 m\"") +
         (space ? ", \"0 m\"], to = [\"2 m\", \"1 m\", \"1 m\"] }"
                : "], to = [\"2 m\", \"1 m\"] }") +
         "\n[time]\nend = \"1 s\"\n[fluid]\ndensity = \"1000 kg/m3\"\n" + tables;
}

Problem read(const std::string& tables, bool space = false) {
  const auto document = Document::from_text(scene(tables, space), "s.toml");
  auto problem = read_problem(document);
  document.refuse_unread();
  return problem;
}

std::string refusal(const std::string& tables, bool space = false) {
  return scene_error([&] { read(tables, space); });
}

// --- viscosity
// ------------------------------------------------------------------------------------

const std::string thinning =
    "[viscosity]\ndynamic = \"1 Pa s\"\n[viscosity.carreau_yasuda]\nhigh_shear = \"10 mPa s\"\n"
    "relaxation_time = \"2 s\"\npower = 0.5\n";

TEST(CarreauYasudaTable, IsRead) {
  const auto viscosity = read(thinning + "transition = 2.0\n").viscosity.value();
  EXPECT_DOUBLE_EQ(viscosity.dynamic, 1.0);
  const auto& law = viscosity.carreau_yasuda.value();
  EXPECT_DOUBLE_EQ(law.high_shear, 0.01);
  EXPECT_DOUBLE_EQ(law.relaxation_time, 2.0);
  EXPECT_DOUBLE_EQ(law.power, 0.5);
  EXPECT_DOUBLE_EQ(law.transition, 2.0);
  EXPECT_FALSE(read("[viscosity]\ndynamic = \"1 Pa s\"\n").viscosity->carreau_yasuda);
}

TEST(CarreauYasudaTable, Refusals) {
  EXPECT_EQ(refusal(thinning + "transition = 0.0\n"),
            "s.toml:14: [viscosity.carreau_yasuda] transition = 0.0: must be positive");
  EXPECT_NE(refusal(thinning).find("transition"), std::string::npos);
}

// --- periodic
// -------------------------------------------------------------------------------------

TEST(PeriodicTable, NamesAxes) {
  EXPECT_FALSE(read("").periodic);
  EXPECT_EQ(read("[periodic]\naxes = [\"x\"]\n").periodic.value().axis,
            (std::array{true, false, false}));
  EXPECT_EQ(read("[periodic]\naxes = [\"z\", \"x\"]\n", true).periodic.value().axis,
            (std::array{true, false, true}));
}

TEST(PeriodicTable, Refusals) {
  EXPECT_EQ(
      refusal("[periodic]\naxes = []\n"),
      "s.toml:9: [periodic] axes = []: names no axis; write axes = [\"x\"] or remove the table");
  EXPECT_EQ(
      refusal("[periodic]\naxes = [\"z\"]\n"),
      "s.toml:9: [periodic] axes = [\"z\"]: \"z\" is not a choice here; the nearest is \"x\"; "
      "write one of \"x\" or \"y\"");
  EXPECT_EQ(refusal("[periodic]\naxes = [\"x\", \"x\"]\n"),
            "s.toml:9: [periodic] axes = [\"x\", \"x\"]: the side \"left\" has a condition already "
            "([periodic]); give every side one condition");
  EXPECT_EQ(
      refusal("[walls]\nno_slip = [\"top\"]\n[periodic]\naxes = [\"y\"]\n"),
      "s.toml:11: [periodic] axes = [\"y\"]: the side \"top\" has a condition already (no_slip "
      "in [walls]); give every side one condition");
  EXPECT_EQ(
      refusal("[periodic]\naxes = [\"x\"]\n[outflow]\nside = \"right\"\npressure = \"0 Pa\"\n"),
      "s.toml:11: [outflow] side = \"right\": the side \"right\" has a condition already "
      "([periodic]); give every side one condition");
  EXPECT_EQ(refusal("[periodic]\n"),
            "s.toml:8: [periodic] axes is missing; write a list of \"x\" or \"y\", such as "
            "[\"x\"]");
}

// --- moving walls
// -----------------------------------------------------------------------------------

const std::string cavity = "[walls]\nno_slip = [\"top\", \"bottom\"]\nfree_slip = [\"left\"]\n";

TEST(WallMotionTable, MovesANoSlipWall) {
  const auto problem = read(cavity +
                            "[wall_motion.top]\nvelocity = [\"1 m/s\", \"0 m/s\"]\nwaveform = { "
                            "formula = \"min(t/0.1, 1)\" }\n[wall_motion.bottom]\nvelocity = "
                            "[\"-20 cm/s\", \"0 m/s\"]\n");
  ASSERT_EQ(problem.wall_motion.size(), 2u);
  EXPECT_EQ(problem.wall_motion[0].side, Side::top);
  EXPECT_EQ(problem.wall_motion[0].velocity, (Point{1, 0, 0}));
  EXPECT_DOUBLE_EQ(problem.wall_motion[0].waveform.value(0.05), 0.5);
  EXPECT_EQ(problem.wall_motion[1].side, Side::bottom);
  EXPECT_EQ(problem.wall_motion[1].velocity, (Point{-0.2, 0, 0}));
  EXPECT_TRUE(problem.wall_motion[1].waveform.constant());
}

TEST(WallMotionTable, Refusals) {
  const std::string velocity = "velocity = [\"1 m/s\", \"0 m/s\"]\n";
  EXPECT_EQ(refusal(cavity + "[wall_motion.left]\n" + velocity),
            "s.toml:11: [wall_motion.left]: \"left\" is no no-slip wall; name it in no_slip of "
            "[walls]");
  EXPECT_EQ(refusal(cavity + "[wall_motion.lid]\n" + velocity),
            "s.toml:11: [wall_motion.lid]: \"lid\" is no no-slip wall; name it in no_slip of "
            "[walls]");
  EXPECT_EQ(
      refusal("[wall_motion.top]\n" + velocity),
      "s.toml:8: [wall_motion.top]: \"top\" is no no-slip wall; name it in no_slip of [walls]");
  EXPECT_EQ(refusal(cavity + "[wall_motion.top]\nvelocity = [\"1 m/s\", \"0.1 m/s\"]\n"),
            "s.toml:12: [wall_motion.top] velocity = [\"1 m/s\", \"0.1 m/s\"]: leads out of the "
            "wall's own plane; its part along the normal must be \"0 m/s\"");
  EXPECT_EQ(refusal(cavity + "[wall_motion.top]\nvelocity = [\"1 m/s\"]\n"),
            "s.toml:12: [wall_motion.top] velocity = [\"1 m/s\"]: 1 coordinates where the channel "
            "has 2; write [\"x m/s\", \"y m/s\"]");
  EXPECT_EQ(
      refusal(cavity + "[wall_motion]\n" + velocity),
      "s.toml:12: [wall_motion] velocity = [\"1 m/s\", \"0 m/s\"]: [wall_motion] holds a table "
      "for each name, such as [wall_motion.top]; put this key into one");
  EXPECT_EQ(
      refusal(cavity + "[wall_motion.top]\n" + velocity + "waveforms = { formula = \"t\" }\n"),
      "s.toml:13: [wall_motion.top] waveforms = { formula = \"t\" }: unknown table; the nearest "
      "known word is waveform");
}

// --- uniform force, velocity at the start
// -----------------------------------------------------------

TEST(GravityTable, HasAnAccelerationAndAWaveform) {
  const auto plane = read("[gravity]\nacceleration = [\"0 m/s2\", \"-9.81 m/s2\"]\n");
  EXPECT_EQ(plane.gravity.value().acceleration, (Point{0, -9.81, 0}));
  EXPECT_TRUE(plane.gravity.value().waveform.constant());
  const auto space = read(
      "[gravity]\nacceleration = [\"1 m/s2\", \"2 m/s2\", \"3 m/s2\"]\nwaveform = { formula = "
      "\"cos(2*pi*t)\" }\n",
      true);
  EXPECT_EQ(space.gravity.value().acceleration, (Point{1, 2, 3}));
  EXPECT_DOUBLE_EQ(space.gravity.value().waveform.value(0.5), -1.0);
}

TEST(GravityTable, Refusals) {
  EXPECT_EQ(
      refusal("[gravity]\nacceleration = [\"0 m/s2\", \"-9.81 m/s\"]\n"),
      "s.toml:9: [gravity] acceleration = [\"0 m/s2\", \"-9.81 m/s\"]: \"-9.81 m/s\": a "
      "velocity where an acceleration is needed; write an acceleration, such as \"9.81 m/s2\"");
  EXPECT_EQ(
      refusal("[gravity]\nacceleration = [\"0 m/s2\"]\n"),
      "s.toml:9: [gravity] acceleration = [\"0 m/s2\"]: 1 coordinates where the channel has 2; "
      "write [\"x m/s2\", \"y m/s2\"]");
}

TEST(InitialTable, HasAFormulaForEachComponent) {
  EXPECT_TRUE(read("").initial_velocity.empty());
  const auto problem = read("[initial]\nvelocity = [\"x + 10*y\", \"-2*y\"]\n");
  ASSERT_EQ(problem.initial_velocity.size(), 2u);
  const std::array place{3.0, 4.0, 0.0};
  EXPECT_EQ(problem.initial_velocity[0].value(place), 43.0);
  EXPECT_EQ(problem.initial_velocity[1].value(place), -8.0);
}

TEST(InitialTable, Refusals) {
  EXPECT_EQ(
      refusal("[initial]\nvelocity = [\"x\"]\n"),
      "s.toml:9: [initial] velocity = [\"x\"]: 1 formulas where the velocity has 2 components; "
      "write one for each, in m/s, of x, y and z in m");
  const auto unknown = refusal("[initial]\nvelocity = [\"x\", \"r*y\"]\n");
  EXPECT_TRUE(unknown.starts_with("s.toml:9: [initial] velocity = [\"x\", \"r*y\"]: \"r*y\": "))
      << unknown;
  EXPECT_TRUE(unknown.ends_with("it may use pi and the variables x, y and z")) << unknown;
  EXPECT_EQ(refusal("[initial]\nvelocity = [1, 2]\n"),
            "s.toml:9: [initial] velocity = [1, 2]: a bare number where a text is needed; write a "
            "list of texts in brackets, each in quotes");
  EXPECT_EQ(refusal("[initial]\nvelocity = \"x\"\n"),
            "s.toml:9: [initial] velocity = \"x\": a text where a list is needed; write a list of "
            "texts in brackets, each in quotes");
}

// --- waveforms
// --------------------------------------------------------------------------------------

TEST(WaveformTable, FileIsLookedForBesideTheScene) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "beat.csv") << "t,f\n0,0\n1,4\n";
  const auto file = folder.path() / "s.toml";
  const std::string tables =
      "[gravity]\nacceleration = [\"1 m/s2\", \"0 m/s2\"]\nwaveform = { file = \"beat.csv\" }\n";
  std::ofstream(file) << scene(tables);
  EXPECT_DOUBLE_EQ(read_problem(Document(file)).gravity.value().waveform.value(0.25), 1.0);

  std::ofstream(folder.path() / "beat.csv") << "t,f\n0,0\n1;4\n";
  EXPECT_EQ(scene_error([&] { read_problem(Document(file)); }),
            file.string() + ":10: [gravity.waveform] file = \"beat.csv\": " +
                (folder.path() / "beat.csv").string() +
                ":3: \"1;4\": not a time in s and a factor; write two numbers");
  std::filesystem::remove(folder.path() / "beat.csv");
  EXPECT_EQ(scene_error([&] { read_problem(Document(file)); }),
            file.string() +
                ":10: [gravity.waveform] file = \"beat.csv\": there is no such file; it "
                "is looked for as " +
                (folder.path() / "beat.csv").string());
}

TEST(WaveformTable, Refusals) {
  const std::string gravity = "[gravity]\nacceleration = [\"1 m/s2\", \"0 m/s2\"]\n";
  const auto of = [&](const std::string& waveform) {
    return refusal(gravity + "waveform = " + waveform + "\n");
  };
  const std::string either =
      "takes one of { formula = \"sin(2*pi*t)\" } and { file = \"beat.csv\" }";
  EXPECT_EQ(of("{ }"), "s.toml:10: [gravity.waveform]: " + either);
  EXPECT_EQ(of("{ formula = \"t\", file = \"t.csv\" }"),
            "s.toml:10: [gravity.waveform]: " + either);
  EXPECT_EQ(
      of("{ formula = \"1/t\" }"),
      "s.toml:10: [gravity.waveform] formula = \"1/t\": the formula has no finite value at t = "
      "0; write one that has");
  const auto unknown = of("{ formula = \"sin(2*pi*x)\" }");
  EXPECT_TRUE(unknown.starts_with("s.toml:10: [gravity.waveform] formula = \"sin(2*pi*x)\": "))
      << unknown;
  EXPECT_TRUE(unknown.ends_with("it may use pi and the variables t")) << unknown;
}

// --- open sides
// -------------------------------------------------------------------------------------

TEST(OpenSideTables, InflowByVelocityWithAWaveform) {
  const auto problem = read(
      "[inflow]\nside = \"top\"\nprofile = \"uniform\"\nmean_velocity = \"2 m/s\"\nwaveform = { "
      "formula = \"1 - t\" }\n");
  EXPECT_FALSE(problem.pressure_inflow);
  const Inflow& inflow = problem.inflow.value();
  EXPECT_EQ(inflow.side, Side::top);
  EXPECT_EQ(inflow.ramp, 0.0);
  EXPECT_DOUBLE_EQ(inflow.speed(0.3, 1.0, 0.0), 2.0);
  EXPECT_DOUBLE_EQ(inflow.speed(0.3, 1.0, 0.75), 0.5);
  Inflow ramped = inflow;
  ramped.ramp = 0.5;  // the ramp and the waveform multiply
  EXPECT_DOUBLE_EQ(ramped.speed(0.3, 1.0, 0.25), 2.0 * 0.5 * 0.75);
}

TEST(OpenSideTables, BothEndsByPressure) {
  const auto problem = read(
      "[inflow]\nside = \"left\"\npressure = \"0.1 bar\"\nwaveform = { formula = \"sin(2*pi*t)\" "
      "}\n[outflow]\nside = \"right\"\npressure = \"-3 Pa\"\nwaveform = { formula = \"1 + t\" }\n");
  EXPECT_FALSE(problem.inflow);
  EXPECT_EQ(problem.pressure_inflow.value().side, Side::left);
  EXPECT_DOUBLE_EQ(problem.pressure_inflow.value().pressure_at(1.0 / 12), 5000.0);
  EXPECT_EQ(problem.outflow.value().side, Side::right);
  EXPECT_DOUBLE_EQ(problem.outflow.value().pressure_at(0.0), -3.0);
  EXPECT_DOUBLE_EQ(problem.outflow.value().pressure_at(1.0), -6.0);
}

TEST(OpenSideTables, Refusals) {
  EXPECT_EQ(refusal("[inflow]\nside = \"left\"\npressure = \"1 m\"\n"),
            "s.toml:10: [inflow] pressure = \"1 m\": a length where a pressure is needed; write a "
            "pressure, such as \"0.7 MPa\"");
  EXPECT_EQ(refusal("[inflow]\nside = \"left\"\npressure = \"1 Pa\"\n[outflow]\nside = "
                    "\"left\"\npressure = \"0 Pa\"\n"),
            "s.toml:12: [outflow] side = \"left\": the side \"left\" has a condition already "
            "([inflow]); give every side one condition");
  for (const std::string key :
       {"profile = \"uniform\"", "mean_velocity = \"1 m/s\"", "ramp = \"1 s\""}) {
    EXPECT_EQ(refusal("[inflow]\nside = \"left\"\npressure = \"1 Pa\"\n" + key + "\n"),
              "s.toml:11: [inflow] " + key +
                  ": belongs to an inflow of prescribed velocity, and this one has a pressure; "
                  "remove one of them");
  }
}

// --- curved walls
// -----------------------------------------------------------------------------------

const std::string rest = "fluid = \"outside\"\nslip = \"no_slip\"\n";

TEST(CurvedWallTable, Circle) {
  const auto problem = read(
      "[curved_wall.cylinder]\ncircle = { centre = [\"20 cm\", \"0.3 m\"], radius = \"5 cm\" }\n" +
      rest);
  ASSERT_EQ(problem.curved_walls.size(), 1u);
  const CurvedWall& wall = problem.curved_walls[0];
  EXPECT_EQ(wall.name, "cylinder");
  EXPECT_EQ(wall.shape, CurvedWall::Shape::circle);
  EXPECT_EQ(wall.centre, (Point{0.2, 0.3, 0}));
  EXPECT_EQ(wall.radius, 0.05);
  EXPECT_FALSE(wall.fluid_inside);
  EXPECT_TRUE(wall.no_slip);
}

TEST(CurvedWallTable, Polygon) {
  const auto problem = read(
      "[curved_wall.step]\npolygon = [[\"0 m\", \"0 m\"], [\"1 m\", \"0 m\"], [\"1 m\", \"50 "
      "cm\"]]\nfluid = \"inside\"\nslip = \"free_slip\"\n");
  const CurvedWall& wall = problem.curved_walls.at(0);
  EXPECT_EQ(wall.shape, CurvedWall::Shape::polygon);
  EXPECT_EQ(wall.corners, (std::vector<Point>{{0, 0, 0}, {1, 0, 0}, {1, 0.5, 0}}));
  EXPECT_TRUE(wall.fluid_inside);
  EXPECT_FALSE(wall.no_slip);
}

TEST(CurvedWallTable, CylinderHasItsCentreInThePlaneAcrossTheAxis) {
  const auto wall = [](const std::string& axis) {
    return read("[curved_wall.pipe]\ncylinder = { axis = \"" + axis +
                    "\", centre = [\"1 m\", \"2 m\"], radius = \"3 m\" }\n" + rest,
                true)
        .curved_walls.at(0);
  };
  EXPECT_EQ(wall("x").shape, CurvedWall::Shape::cylinder);
  EXPECT_EQ(wall("x").axis, 0);
  EXPECT_EQ(wall("x").centre, (Point{0, 1, 2}));
  EXPECT_EQ(wall("y").centre, (Point{1, 0, 2}));
  EXPECT_EQ(wall("z").centre, (Point{1, 2, 0}));
  EXPECT_EQ(wall("z").radius, 3.0);
}

TEST(CurvedWallTable, SurfaceFileIsLookedForBesideTheScene) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "pipe.stl") << "solid\nendsolid\n";
  const auto file = folder.path() / "s.toml";
  std::ofstream(file) << scene("[curved_wall.pipe]\nsurface = { file = \"pipe.stl\" }\n" + rest,
                               true);
  const auto wall = read_problem(Document(file)).curved_walls.at(0);
  EXPECT_EQ(wall.shape, CurvedWall::Shape::surface);
  EXPECT_EQ(wall.file, folder.path() / "pipe.stl");
  std::filesystem::remove(wall.file);
  EXPECT_EQ(scene_error([&] { read_problem(Document(file)); }),
            file.string() +
                ":9: [curved_wall.pipe.surface] file = \"pipe.stl\": there is no such "
                "file; it is looked for as " +
                wall.file.string());
}

TEST(CurvedWallTable, TakesExactlyOneShapeOfItsDimension) {
  const std::string circle = "circle = { centre = [\"1 m\", \"0.5 m\"], radius = \"0.1 m\" }\n";
  const std::string polygon =
      "polygon = [[\"0 m\", \"0 m\"], [\"1 m\", \"0 m\"], [\"1 m\", \"1 m\"]]\n";
  const std::string plane =
      "s.toml:8: [curved_wall.w]: its shape is circle or polygon; write exactly one";
  EXPECT_EQ(refusal("[curved_wall.w]\n" + rest), plane);
  EXPECT_EQ(refusal("[curved_wall.w]\n" + circle + polygon + rest), plane);
  const std::string cylinder =
      "cylinder = { axis = \"x\", centre = [\"0 m\", \"0 m\"], radius = \"1 m\" }\n";
  EXPECT_EQ(refusal("[curved_wall.w]\n" + cylinder + rest), plane);
  EXPECT_EQ(refusal("[curved_wall.w]\n" + circle + rest, true),
            "s.toml:8: [curved_wall.w]: its shape is cylinder or surface; write exactly one");
}

TEST(CurvedWallTable, Refusals) {
  const auto circle = [](const std::string& content, const std::string& more = rest) {
    return refusal("[curved_wall.w]\ncircle = { " + content + " }\n" + more);
  };
  EXPECT_EQ(circle("centre = [\"1 m\", \"1 m\"], radius = \"0 m\""),
            "s.toml:9: [curved_wall.w.circle] radius = \"0 m\": must be greater than zero; write a "
            "length, such as \"3.75 mm\"");
  EXPECT_EQ(circle("centre = [\"1 m\"], radius = \"1 m\""),
            "s.toml:9: [curved_wall.w.circle] centre = [\"1 m\"]: 1 coordinates where the channel "
            "has 2; write [\"x m\", \"y m\"]");
  EXPECT_EQ(circle("centre = [\"1 m\", \"1 m\"], diameter = \"1 m\""),
            "s.toml:9: [curved_wall.w.circle] radius is missing; write a length, such as \"3.75 "
            "mm\"");
  const std::string good = "centre = [\"1 m\", \"0.5 m\"], radius = \"0.1 m\"";
  EXPECT_EQ(
      circle(good, "fluid = \"out\"\nslip = \"no_slip\"\n"),
      "s.toml:10: [curved_wall.w] fluid = \"out\": \"out\" is not a choice here; write one of "
      "\"inside\" or \"outside\"");
  EXPECT_EQ(circle(good, "fluid = \"outside\"\nslip = \"noslip\"\n"),
            "s.toml:11: [curved_wall.w] slip = \"noslip\": \"noslip\" is not a choice here; the "
            "nearest is \"no_slip\"; write one of \"no_slip\" or \"free_slip\"");
  EXPECT_EQ(circle(good, "slip = \"no_slip\"\n"),
            "s.toml:8: [curved_wall.w] fluid is missing; write one of \"inside\" or \"outside\"");
  const auto polygon = [](const std::string& corners) {
    return refusal("[curved_wall.w]\npolygon = " + corners + "\n" + rest);
  };
  const std::string two = "[[\"0 m\", \"0 m\"], [\"1 m\", \"0 m\"]]";
  EXPECT_EQ(polygon(two), "s.toml:9: [curved_wall.w] polygon = " + two +
                              ": a polygon has three corners at least");
  const std::string space = "[[\"0 m\", \"0 m\", \"0 m\"]]";
  EXPECT_EQ(polygon(space), "s.toml:9: [curved_wall.w] polygon = " + space +
                                ": its corners have two coordinates each");
  const std::string flat = "[\"0 m\", \"0 m\"]";
  EXPECT_EQ(polygon(flat),
            "s.toml:9: [curved_wall.w] polygon = [\"0 m\", \"0 m\"]: a text where a list is "
            "needed; write a list of lists in brackets, each element of the inner ones a length, "
            "such as \"3.75 mm\"");
  const std::string closed =
      "[[\"0 m\", \"0 m\"], [\"1 m\", \"0 m\"], [\"1 m\", \"1 m\"], [\"0 m\", \"0 m\"]]";
  EXPECT_EQ(polygon(closed), "s.toml:9: [curved_wall.w] polygon = " + closed +
                                 ": names the corner (0, 0) m twice in a row; name each once, the "
                                 "last is joined to the first");
  const std::string line = "[[\"0 m\", \"0 m\"], [\"1 m\", \"1 m\"], [\"0.5 m\", \"0.5 m\"]]";
  EXPECT_EQ(polygon(line), "s.toml:9: [curved_wall.w] polygon = " + line +
                               ": encloses no area; write its corners in order round it");
  EXPECT_EQ(refusal("[curved_wall.w]\ncylinder = { axis = \"x\", centre = [\"0 m\", \"0 m\", \"0 "
                    "m\"], radius = \"1 m\" }\n" +
                        rest,
                    true),
            "s.toml:9: [curved_wall.w.cylinder] centre = [\"0 m\", \"0 m\", \"0 m\"]: has two "
            "coordinates, in the plane across the axis");
  EXPECT_EQ(
      refusal("[curved_wall]\n" + rest),
      "s.toml:9: [curved_wall] fluid = \"outside\": [curved_wall] holds a table for each name, "
      "such as [curved_wall.cylinder]; put this key into one");
  EXPECT_EQ(
      refusal("[curved_wall.\"a b\"]\ncircle = { " + good + " }\n" + rest),
      "s.toml:8: [curved_wall.a b]: \"a b\" cannot name a curved wall; use letters, digits and "
      "_, a letter first");
}

// --- probes
// -----------------------------------------------------------------------------------------

const std::string cylinder =
    "[curved_wall.cylinder]\ncircle = { centre = [\"1 m\", \"0.5 m\"], radius = \"0.1 m\" }\n" +
    rest;

TEST(ProbeTables, PressureAtPlaces) {
  const auto problem = read(
      "[probes.dp]\npressure_at = [[\"15 cm\", \"0.2 m\"], [\"0.25 m\", \"0.2 m\"], [\"2 m\", \"1 "
      "m\"]]\n");
  ASSERT_EQ(problem.probes.pressure.size(), 1u);
  EXPECT_EQ(problem.probes.pressure[0].name, "dp");
  EXPECT_EQ(problem.probes.pressure[0].places,
            (std::vector<Point>{{0.15, 0.2, 0}, {0.25, 0.2, 0}, {2, 1, 0}}));
}

TEST(ProbeTables, PressureRefusals) {
  const auto of = [](const std::string& places) {
    return refusal("[probes.dp]\npressure_at = " + places + "\n");
  };
  EXPECT_EQ(of("[[\"0.1 m\", \"1.5 m\"]]"),
            "s.toml:9: [probes.dp] pressure_at = [[\"0.1 m\", \"1.5 m\"]]: the point (0.1, 1.5) m "
            "lies outside the channel, which reaches from (0, 0) m to (2, 1) m; move it inside");
  EXPECT_EQ(of("[[\"0.1 m\"]]"),
            "s.toml:9: [probes.dp] pressure_at = [[\"0.1 m\"]]: each place has 2 coordinates, such "
            "as [[\"0 m\", \"0 m\"]]");
  EXPECT_EQ(of("[\"0.1 m\", \"0.1 m\"]"),
            "s.toml:9: [probes.dp] pressure_at = [\"0.1 m\", \"0.1 m\"]: a text where a "
            "list is needed; write a list of lists in brackets, each element of the inner ones a "
            "length, such as \"3.75 mm\"");
  EXPECT_TRUE(of("[]").starts_with("s.toml:9: [probes.dp] pressure_at = []: names no place"));
}

TEST(ProbeTables, ForceOnACurvedWall) {
  const auto problem = read(cylinder + "[probes.drag]\nforce_on = \"cylinder\"\n");
  ASSERT_EQ(problem.probes.force.size(), 1u);
  EXPECT_EQ(problem.probes.force[0].curved_wall, "cylinder");
  EXPECT_EQ(problem.probes.force[0].solid, "");
}

TEST(ProbeTables, ForceRefusals) {
  EXPECT_EQ(refusal(cylinder + "[probes.drag]\nforce_on = \"cylindre\"\n"),
            "s.toml:13: [probes.drag] force_on = \"cylindre\": \"cylindre\" is not a choice here; "
            "the nearest is \"cylinder\"; write \"cylinder\"");
  EXPECT_EQ(refusal("[probes.drag]\nforce_on = \"cylinder\"\n"),
            "s.toml:9: [probes.drag] force_on = \"cylinder\": the scene has no solid and no curved "
            "wall; add one, such as [solid.beam], or remove this probe");
}

TEST(ProbeTables, ABodyMayNotHaveACurvedWallsName) {
  EXPECT_EQ(refusal(cylinder +
                    "[solid.cylinder]\nbody = { from = [\"0 m\", \"0 m\"], to = [\"0.1 m\", \"0.1 "
                    "m\"] }\nyoungs_modulus = \"1 Pa\"\n"),
            "s.toml:12: [solid.cylinder]: [curved_wall.cylinder] has this name already, and probes "
            "name both; choose another");
}

}  // namespace
}  // namespace sprung
