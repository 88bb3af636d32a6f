/// The problem: the beam scene as both solvers get it, and every scene that is refused.

#include "scene/problem.hpp"

#include "tests/unit/scene/beam_scene.hpp"

#include <gtest/gtest.h>

namespace sprung {
namespace {

using test::beam_text;
using test::scene_error;

Problem read(const std::string& text) {
  const auto scene = Document::from_text(text, "s.toml");
  auto problem = read_problem(scene);
  scene.refuse_unread();
  return problem;
}

TEST(Problem, BeamScene) {
  const auto problem = read(beam_text());
  EXPECT_EQ(problem.title, "Beam");
  EXPECT_EQ(problem.source, "a test");
  EXPECT_EQ(problem.dimension, 2);
  EXPECT_EQ(problem.channel.from, (Point{0, 0, 0}));
  EXPECT_EQ(problem.channel.to, (Point{0.9, 0.3, 0}));
  EXPECT_EQ(problem.end_time, 3.0);
  EXPECT_EQ(problem.density, 1000.0);
  EXPECT_EQ(problem.viscosity.value().dynamic, 1.0);
  EXPECT_EQ(problem.walls.value().no_slip, (std::vector<Side>{Side::bottom, Side::top}));
  EXPECT_TRUE(problem.walls.value().free_slip.empty());
  EXPECT_EQ(problem.inflow.value().side, Side::left);
  EXPECT_EQ(problem.inflow.value().profile, Inflow::Profile::parabolic);
  EXPECT_EQ(problem.inflow.value().mean_velocity, 0.5);
  EXPECT_EQ(problem.inflow.value().ramp, 1.0);
  EXPECT_EQ(problem.outflow.value().side, Side::right);
  EXPECT_EQ(problem.outflow.value().pressure, 0.0);
  ASSERT_EQ(problem.solids.size(), 1u);
  const auto& beam = problem.solids[0];
  EXPECT_EQ(beam.name, "beam");
  EXPECT_EQ(beam.body.from, (Point{0.3, 0, 0}));
  EXPECT_EQ(beam.body.to, (Point{0.315, 0.1, 0}));
  EXPECT_EQ(beam.youngs_modulus, 7e5);
  EXPECT_EQ(beam.clamped, Side::bottom);
  const auto& probes = problem.probes;
  ASSERT_EQ(probes.displacement.size(), 1u);
  EXPECT_EQ(probes.displacement[0].name, "tip");
  EXPECT_EQ(probes.displacement[0].solid, "beam");
  EXPECT_EQ(probes.displacement[0].point, (Point{0.3075, 0.1, 0}));
  ASSERT_EQ(probes.velocity_profile.size(), 1u);
  EXPECT_EQ(probes.velocity_profile[0].points, 121);
  EXPECT_EQ(probes.velocity_profile[0].from, (Point{0.4, 0, 0}));
  EXPECT_EQ(probes.velocity_profile[0].to, (Point{0.4, 0.3, 0}));
  EXPECT_EQ(probes.velocity_profile[0].times, (std::vector<double>{0.2, 3.0}));
  ASSERT_EQ(probes.force.size(), 1u);
  EXPECT_EQ(probes.force[0].solid, "beam");
  ASSERT_EQ(probes.outline.size(), 1u);
  EXPECT_EQ(probes.outline[0].points, 87);
  EXPECT_EQ(problem.fields_every, 0.5);
  // 0.2 and 3 of the probes; 0, 0.5 ... 3 of the fields; 3 once.
  EXPECT_EQ(probes.all_times, (std::vector<double>{0, 0.2, 0.5, 1, 1.5, 2, 2.5, 3}));
}

TEST(Problem, TheProjectsBeamSceneIsAccepted) {
  Document scene(SPRUNG_BEAM_SCENE);
  const auto problem = read_problem(scene);
  EXPECT_EQ(problem.probes.all_times, (std::vector<double>{0.2, 0.4, 0.6, 0.8, 1, 2, 3}));
  scene.leave_unread("numerics");
  scene.leave_unread("sph");
  scene.leave_unread("reference_fem");
  EXPECT_NO_THROW(scene.refuse_unread());
  const auto again = Document::from_text(scene.resolved_toml());
  EXPECT_EQ(read_problem(again).probes.all_times, problem.probes.all_times);
}

// 3 x 0.1 is not 0.3 in binary: the probe's 0.3 must stand, once.
TEST(Problem, FieldTimesMergeWithProbeTimes) {
  auto text = beam_text(37, R"(fields_every = "0.1 s")");
  const auto problem = read(text.replace(text.find("0.2 s"), 5, "0.3 s"));
  const auto& times = problem.probes.all_times;
  EXPECT_EQ(times.size(), 31u);  // 0, 0.1 ... 3, with 0.2, 0.3 and 3 of the probes among them
  EXPECT_EQ(times[2], 0.2);
  EXPECT_EQ(times[3], 0.3);
  EXPECT_NE(3 * 0.1, 0.3);
}

TEST(Problem, AbsentTablesAreAbsentEffects) {
  const auto problem = read(R"(title = "t"
[domain]
channel = { from = ["0 m", "0 m"], to = ["1 m", "1 m"] }
[time]
end = "1 s"
[fluid]
density = "1 g/cm3"
)");
  EXPECT_FALSE(problem.viscosity || problem.walls || problem.inflow || problem.outflow);
  EXPECT_TRUE(problem.solids.empty());
  EXPECT_TRUE(problem.probes.all_times.empty());
  EXPECT_EQ(problem.source, "");
  EXPECT_EQ(problem.fields_every, 0.0);
}

TEST(Problem, ThreeDimensions) {
  const auto problem = read(R"(title = "t"
[domain]
channel = { from = ["0 m", "0 m", "-1 m"], to = ["3 m", "1 m", "1 m"] }
[time]
end = "1 s"
[fluid]
density = "1000 kg/m3"
[walls]
no_slip = ["bottom", "top"]
free_slip = ["back", "front"]
[solid.leaf]
body = { from = ["1 m", "0 m", "-1 m"], to = ["1.5 m", "0.5 m", "0.5 m"] }
youngs_modulus = "1 MPa"
clamped = "back"
[probes.tip]
displacement_of = ["1.25 m", "0.5 m", "0 m"]
)");
  EXPECT_EQ(problem.dimension, 3);
  EXPECT_EQ(problem.channel.from, (Point{0, 0, -1}));
  EXPECT_EQ(problem.walls.value().free_slip, (std::vector<Side>{Side::back, Side::front}));
  EXPECT_EQ(problem.solids.at(0).clamped, Side::back);
  EXPECT_EQ(problem.probes.displacement.at(0).solid, "leaf");
}

TEST(Problem, DefaultsOfAnAbsentTableStandInTheResolvedScene) {
  const auto text = beam_text();
  const auto scene = Document::from_text(text.substr(0, text.find("[record]")));
  read_problem(scene);
  EXPECT_TRUE(scene.resolved_toml().ends_with("\n[record]\nfields_every = \"0 s\"\n"));
}

TEST(Problem, DefaultsStandInTheResolvedScene) {
  const auto scene = Document::from_text(beam_text(37));
  read_problem(scene);
  EXPECT_NE(scene.resolved_toml().find("[record]\nfields_every = \"0 s\"\n"), std::string::npos);
}

// --- refusals -----------------------------------------------------------------------------------

struct Refusal {
  std::size_t line;         // replaced in the beam scene
  const char* replacement;  //
  const char* message;      // the whole of it
};

class RefusedScene : public testing::TestWithParam<Refusal> {};

TEST_P(RefusedScene, HasFileLineValueAndRemedy) {
  const auto& [line, replacement, message] = GetParam();
  EXPECT_EQ(scene_error([&] { read(beam_text(line, replacement)); }), message);
}

INSTANTIATE_TEST_SUITE_P(
    Domain, RefusedScene,
    testing::Values(
        Refusal{1, "", "s.toml: title is missing; write a text in quotes, title = \"...\""},
        Refusal{3, "[domian]",
                "s.toml:3: [domian]: unknown table; the nearest known word is domain"},
        Refusal{4, "", "s.toml:3: [domain] channel is missing; write a table [domain.channel]"},
        Refusal{4, R"(channel = { from = ["0 m"], to = ["1 m"] })",
                "s.toml:4: [domain.channel] from = [\"0 m\"]: 1 coordinates; write two for a plane "
                "problem, [\"0 m\", \"0 m\"], or three"},
        Refusal{
            4, R"(channel = { from = ["0 m", "0 m"], to = ["1 m", "1 m", "1 m"] })",
            "s.toml:4: [domain.channel] to = [\"1 m\", \"1 m\", \"1 m\"]: 3 coordinates where the "
            "channel has 2; write [\"x m\", \"y m\"]"},
        Refusal{
            4, R"(channel = { from = ["0 m", "0.3 m"], to = ["0.9 m", "0 m"] })",
            "s.toml:4: [domain.channel] to = [\"0.9 m\", \"0 m\"]: a box without extent, from (0, "
            "0.3) m to (0.9, 0) m; from is the corner with the smallest coordinates, to the one "
            "with the largest"},
        Refusal{6, R"(end = "0 s")",
                "s.toml:6: [time] end = \"0 s\": must be greater than zero; write a time, such as "
                "\"0.2 s\""},
        Refusal{6, "end = 3",
                "s.toml:6: [time] end = 3: a bare number where a quantity with its unit is needed; "
                "write a time, such as \"0.2 s\""},
        Refusal{8, R"(density = "-1000 kg/m3")",
                "s.toml:8: [fluid] density = \"-1000 kg/m3\": must be greater than zero; write a "
                "density, such as \"1000 kg/m3\""},
        Refusal{8, R"(densty = "1000 kg/m3")",
                "s.toml:8: [fluid] densty = \"1000 kg/m3\": unknown key; the nearest known word is "
                "density"},
        Refusal{
            10, R"(dynamic = "1e-6 m2/s")",
            "s.toml:10: [viscosity] dynamic = \"1e-6 m2/s\": a kinematic viscosity where a dynamic "
            "viscosity is needed; write a dynamic viscosity, such as \"1 Pa s\""},
        Refusal{10, "",
                "s.toml:9: [viscosity] dynamic is missing; write a dynamic viscosity, such as "
                "\"1 Pa s\""}));

INSTANTIATE_TEST_SUITE_P(
    Sides, RefusedScene,
    testing::Values(
        Refusal{12, R"(no_slip = ["bottom", "topp"])",
                "s.toml:12: [walls] no_slip = [\"bottom\", \"topp\"]: \"topp\" is not a choice "
                "here; the "
                "nearest is \"top\"; write one of \"left\", \"right\", \"bottom\" or \"top\""},
        Refusal{
            12, R"(no_slip = ["bottom", "front"])",
            "s.toml:12: [walls] no_slip = [\"bottom\", \"front\"]: \"front\" is not a choice here; "
            "write one of \"left\", \"right\", \"bottom\" or \"top\""},
        Refusal{12, R"(no_slip = ["top", "top"])",
                "s.toml:12: [walls] no_slip = [\"top\", \"top\"]: the side \"top\" has a condition "
                "already (no_slip in [walls]); give every side one condition"},
        Refusal{12, R"(no_slip = ["top", "left"])",
                "s.toml:14: [inflow] side = \"left\": the side \"left\" has a condition already "
                "(no_slip in [walls]); give every side one condition"},
        Refusal{12, "",
                "s.toml:11: [walls]: names no side; write no_slip = [\"bottom\", \"top\"] or "
                "remove the "
                "table"},
        Refusal{12, R"(noslip = ["bottom", "top"])",
                "s.toml:12: [walls] noslip = [\"bottom\", \"top\"]: unknown key; the nearest known "
                "word "
                "is no_slip"},
        Refusal{
            15, R"(profile = "parabola")",
            "s.toml:15: [inflow] profile = \"parabola\": \"parabola\" is not a choice here; the "
            "nearest is \"parabolic\"; write one of \"parabolic\" or \"uniform\""},
        Refusal{16, R"(mean_velocity = "0 m/s")",
                "s.toml:16: [inflow] mean_velocity = \"0 m/s\": must be greater than zero; write a "
                "velocity, such as \"0.5 m/s\""},
        Refusal{17, R"(ramp = "-1 s")",
                "s.toml:17: [inflow] ramp = \"-1 s\": must not be negative; write \"0 s\" for full "
                "speed from the start"},
        Refusal{19, R"(side = "left")",
                "s.toml:19: [outflow] side = \"left\": the side \"left\" has a condition already "
                "([inflow]); give every side one condition"},
        Refusal{20, R"(pressure = "0")",
                "s.toml:20: [outflow] pressure = \"0\": a number without a unit; write a pressure, "
                "such "
                "as \"0.7 MPa\""}));

INSTANTIATE_TEST_SUITE_P(
    Solids, RefusedScene,
    testing::Values(
        Refusal{
            22, R"(body = { from = ["0.3 m", "0 m"], to = ["0.315 m", "0.4 m"] })",
            "s.toml:22: [solid.beam] body = { from = [\"0.3 m\", \"0 m\"], to = [\"0.315 m\", "
            "\"0.4 "
            "m\"] }: the body reaches from (0.3, 0) m to (0.315, 0.4) m, out of the channel, which "
            "reaches from (0, 0) m to (0.9, 0.3) m; move or shrink the body, or enlarge the "
            "channel"},
        Refusal{
            22, R"(body = { from = ["0.3 m", "0.01 m"], to = ["0.315 m", "0.1 m"] })",
            "s.toml:24: [solid.beam] clamped = \"bottom\": the body ends at y = 0.01 m and does "
            "not "
            "touch the side \"bottom\" of the channel at y = 0 m; move the body there or clamp it "
            "to the side that it touches"},
        Refusal{
            22, R"(body = { from = ["0.3 m", "0 m"], to = ["0.3 m", "0.1 m"] })",
            "s.toml:22: [solid.beam.body] to = [\"0.3 m\", \"0.1 m\"]: a box without extent, from "
            "(0.3, 0) m to (0.3, 0.1) m; from is the corner with the smallest coordinates, to the "
            "one with the largest"},
        Refusal{23, R"(youngs_modulus = "0.7 mm")",
                "s.toml:23: [solid.beam] youngs_modulus = \"0.7 mm\": a length where a pressure is "
                "needed; write a pressure, such as \"0.7 MPa\""},
        Refusal{
            23, R"(youngs_modulus = "0 Pa")",
            "s.toml:23: [solid.beam] youngs_modulus = \"0 Pa\": must be greater than zero; write a "
            "pressure, such as \"0.7 MPa\""},
        Refusal{
            23, R"(young_modulus = "0.7 MPa")",
            "s.toml:23: [solid.beam] young_modulus = \"0.7 MPa\": unknown key; the nearest known "
            "word is youngs_modulus"},
        Refusal{
            24, R"(clamped = "left")",
            "s.toml:24: [solid.beam] clamped = \"left\": the body ends at x = 0.3 m and does not "
            "touch the side \"left\" of the channel at x = 0 m; move the body there or clamp it to "
            "the side that it touches"},
        Refusal{
            24, R"(clampd = "bottom")",
            "s.toml:24: [solid.beam] clampd = \"bottom\": unknown key; the nearest known word is "
            "clamped"},
        Refusal{
            24, R"(clamped = "bottom"
[solid.other]
body = { from = ["0.31 m", "0 m"], to = ["0.4 m", "0.1 m"] })",
            "s.toml:26: [solid.other] body = { from = [\"0.31 m\", \"0 m\"], to = [\"0.4 m\", "
            "\"0.1 "
            "m\"] }: the body overlaps [solid.beam], which reaches from (0.3, 0) m to (0.315, 0.1) "
            "m; move one of them"},
        Refusal{
            21, "[solid]",
            "s.toml:23: [solid] youngs_modulus = \"0.7 MPa\": [solid] holds a table for each name, "
            "such as [solid.beam]; put this key into one"}));

INSTANTIATE_TEST_SUITE_P(
    Probes, RefusedScene,
    testing::Values(
        Refusal{26, R"(displacement_of = ["0.3075 m", "0.11 m"])",
                "s.toml:26: [probes.tip] displacement_of = [\"0.3075 m\", \"0.11 m\"]: the point "
                "(0.3075, 0.11) m lies in no body ([solid.beam] reaches from (0.3, 0) m to (0.315, "
                "0.1) "
                "m); name a point of a body as it is at the start"},
        Refusal{
            26, R"(displacment_of = ["0.3075 m", "0.1 m"])",
            "s.toml:26: [probes.tip] displacment_of = [\"0.3075 m\", \"0.1 m\"]: unknown key; the "
            "nearest known word is displacement_of"},
        Refusal{26, "",
                "s.toml:25: [probes.tip]: measures nothing; write exactly one of displacement_of, "
                "velocity_along, force_on, outline_of or pressure_at"},
        Refusal{
            31, "force_on = \"beam\"\noutline_of = \"beam\"",
            "s.toml:32: [probes.force] outline_of = \"beam\": a probe measures one thing, and this "
            "one has force_on and outline_of; give each a table of its own"},
        Refusal{
            28,
            R"(velocity_along = { from = ["0.4 m", "0 m"], to = ["0.4 m", "0.31 m"], points = 9 })",
            "s.toml:28: [probes.profile.velocity_along] to = [\"0.4 m\", \"0.31 m\"]: the point "
            "(0.4, 0.31) m lies outside the channel, which reaches from (0, 0) m to (0.9, 0.3) m; "
            "move it inside"},
        Refusal{
            28,
            R"(velocity_along = { from = ["0.4 m", "0 m"], to = ["0.4 m", "0 m"], points = 9 })",
            "s.toml:28: [probes.profile.velocity_along] to = [\"0.4 m\", \"0 m\"]: the same point "
            "as "
            "from; write the line's other end"},
        Refusal{
            28,
            R"(velocity_along = { from = ["0.4 m", "0 m"], to = ["0.4 m", "0.3 m"], points = 1 })",
            "s.toml:28: [probes.profile.velocity_along] points = 1: must be from 2 to 1000000; "
            "write "
            "for instance points = 121"},
        Refusal{
            29, R"(times = ["0.2 s", "3.1 s"])",
            "s.toml:29: [probes.profile] times = [\"0.2 s\", \"3.1 s\"]: 3.1 s lies beyond the end "
            "of the run at 3 s; leave it out or raise end in [time]"},
        Refusal{
            29, R"(times = ["3 s", "0.2 s"])",
            "s.toml:29: [probes.profile] times = [\"3 s\", \"0.2 s\"]: 0.2 s does not come after 3 "
            "s; write the times in ascending order"},
        Refusal{29, R"(times = ["-1 s"])",
                "s.toml:29: [probes.profile] times = [\"-1 s\"]: -1 s lies before the start; write "
                "times "
                "from 0 s on"},
        Refusal{29, "times = []",
                "s.toml:29: [probes.profile] times = []: names no time; write for instance times = "
                "[\"1 "
                "s\"]"},
        Refusal{29, "",
                "s.toml:27: [probes.profile] times is missing; write a list in brackets, each "
                "element a time, such as \"0.2 s\""},
        Refusal{
            30, "[probes.\"a/b\"]",
            "s.toml:30: [probes.a/b]: \"a/b\" cannot name a probe; use letters, digits and _, a "
            "letter first"},
        Refusal{
            30, "[probes.ledger_mass]",
            "s.toml:30: [probes.ledger_mass]: names that begin with ledger_ belong to the solvers; "
            "choose another"},
        Refusal{31, R"(force_on = "beem")",
                "s.toml:31: [probes.force] force_on = \"beem\": \"beem\" is not a choice here; the "
                "nearest is \"beam\"; write \"beam\""},
        Refusal{34, "points = 2.5",
                "s.toml:34: [probes.outline] points = 2.5: a bare number where a whole number is "
                "needed; "
                "write it without quotes, point or unit, such as 121"},
        Refusal{
            37, R"(fields_every = "-1 s")",
            "s.toml:37: [record] fields_every = \"-1 s\": must not be negative; write \"0 s\" for "
            "the probes' times only"},
        Refusal{37, R"(fields_every = "1 ns")",
                "s.toml:37: [record] fields_every = \"1 ns\": more than 100000 snapshots until the "
                "end; "
                "write a longer interval"},
        Refusal{37, R"(field_every = "1 s")",
                "s.toml:37: [record] field_every = \"1 s\": unknown key; the nearest known word is "
                "fields_every"}));

TEST(RefusedScene, MissingTablesComeWithAnExample) {
  const std::string title = "title = \"t\"\n";
  EXPECT_EQ(
      scene_error([&] { read(title); }),
      "s.toml: the table [domain] is missing; write it, for instance\n  [domain]\n  channel = { "
      "from = [\"0 m\", \"0 m\"], to = [\"0.9 m\", \"0.3 m\"] }");
  const auto domain =
      title + "[domain]\nchannel = { from = [\"0 m\", \"0 m\"], to = [\"1 m\", \"1 m\"] }\n";
  EXPECT_EQ(
      scene_error([&] { read(domain); }),
      "s.toml: the table [time] is missing; write it, for instance\n  [time]\n  end = \"3 s\"");
  EXPECT_EQ(scene_error([&] { read(domain + "[time]\nend = \"1 s\"\n"); }),
            "s.toml: the table [fluid] is missing; write it, for instance\n  [fluid]\n  density = "
            "\"1000 kg/m3\"");
}

TEST(RefusedScene, ProbesOfSolidsNeedASolid) {
  const std::string bare = R"(title = "t"
[domain]
channel = { from = ["0 m", "0 m"], to = ["1 m", "1 m"] }
[time]
end = "1 s"
[fluid]
density = "1000 kg/m3"
[probes.p]
)";
  EXPECT_EQ(scene_error([&] { read(bare + "force_on = \"beam\"\n"); }),
            "s.toml:9: [probes.p] force_on = \"beam\": the scene has no solid and no curved wall; "
            "add one, such as [solid.beam], or remove this probe");
  EXPECT_EQ(
      scene_error([&] { read(bare + "displacement_of = [\"0 m\", \"0 m\"]\n"); }),
      "s.toml:9: [probes.p] displacement_of = [\"0 m\", \"0 m\"]: the scene has no solid; add one, "
      "such as [solid.beam], or remove this probe");
}

TEST(RefusedScene, ClampInAnOpening) {
  auto text = beam_text(22, R"(body = { from = ["0 m", "0.1 m"], to = ["0.1 m", "0.2 m"] })");
  text.replace(text.find("clamped = \"bottom\""), 18, "clamped = \"left\"");
  EXPECT_EQ(
      scene_error([&] { read(text); }),
      "s.toml:24: [solid.beam] clamped = \"left\": fluid passes through the side \"left\"; clamp "
      "the body to a wall or move the opening");
}

TEST(RefusedScene, OverriddenEndIsWeighedAgainstTheTimes) {
  const auto scene = Document::from_text(beam_text(), "s.toml", {"time.end=1 s"});
  EXPECT_EQ(
      scene_error([&] { read_problem(scene); }),
      "s.toml:29: [probes.profile] times = [\"0.2 s\", \"3 s\"]: 3 s lies beyond the end of the "
      "run at 1 s; leave it out or raise end in [time]");
}

// Every letter of the scene left out, doubled, or turned into something else: read or refused, with
// the place in front, never anything worse.
TEST(RefusedScene, OneWrongLetterAnywhere) {
  const auto whole = beam_text();
  int refused = 0, read_well = 0;
  const auto attempt = [&](const std::string& text) {
    try {
      read(text);
      ++read_well;
    } catch (const SceneError& error) {
      const std::string message = error.what();
      EXPECT_TRUE(message.starts_with("s.toml:")) << message;
      ++refused;
    }
  };
  for (std::size_t i = 0; i < whole.size(); ++i) {
    auto text = whole;
    attempt(text.erase(i, 1));
    text = whole;
    attempt(text.insert(i, 1, whole[i]));
    for (const char c : {'"', '[', '-', '9', '\n', '\0', '\xff'}) {
      text = whole;
      text[i] = c;
      attempt(text);
    }
  }
  // Most changes break a word; those of a digit, a space or a text do not.
  EXPECT_GT(refused, 4 * read_well);
}

// --- inflow speed, by hand ----------------------------------------------------------------------

TEST(InflowSpeed, ParabolaOfGivenMean) {
  Inflow inflow;
  inflow.mean_velocity = 0.5;
  inflow.ramp = 1.0;
  const double height = 0.3;
  EXPECT_DOUBLE_EQ(inflow.speed(0.15, height, 2.0), 0.75);  // peak 1.5 x the mean
  EXPECT_DOUBLE_EQ(inflow.speed(0.15, height, 0.5), 0.375);
  EXPECT_EQ(inflow.speed(0.15, height, 0.0), 0.0);
  EXPECT_EQ(inflow.speed(0.0, height, 2.0), 0.0);
  EXPECT_DOUBLE_EQ(inflow.speed(0.075, height, 2.0), 0.5625);  // 6 x 0.5 x 1/4 x 3/4
  // Midpoint rule: its error for this parabola is u / (2 n^2) = 2.5e-7 for n = 1000.
  double mean = 0.0;
  for (int i = 0; i < 1000; ++i)
    mean += inflow.speed(height * (i + 0.5) / 1000, height, 1.0) / 1000;
  EXPECT_NEAR(mean, 0.5, 3e-7);
}

TEST(InflowSpeed, UniformAndWithoutRamp) {
  Inflow inflow;
  inflow.profile = Inflow::Profile::uniform;
  inflow.mean_velocity = 2.0;
  EXPECT_EQ(inflow.speed(0.1, 1.0, 0.0), 2.0);
  EXPECT_EQ(inflow.speed(0.9, 1.0, 5.0), 2.0);
}

}  // namespace
}  // namespace sprung
