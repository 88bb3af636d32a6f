// Bodies in their own frame, and the scenes that describe them.
#include "scene/body_shape.hpp"

#include "tests/unit/scene/beam_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sprung {
namespace {

using test::beam_text;
constexpr double degree = std::numbers::pi / 180.0;

Problem problem_of(const std::string& text) {
  const auto document = Document::from_text(text);
  return read_problem(document);
}

/// The beam's line replaced, its probe moved to `probe`, its clamp and outline as they are.
std::string scene(const std::string& body, const std::string& probe) {
  auto text = beam_text(22, body);
  const std::string old = R"(["0.3075 m", "0.1 m"])";
  return text.replace(text.find(old), old.size(), probe);
}

void expect_near(const Point& a, const Point& b) {
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(a[d], b[d], 1e-14) << d;
}

TEST(BodyShape, ATurnedBoxTurnsAboutItsMiddle) {
  Solid solid;
  solid.body = {{1, 1, 0}, {3, 2, 0}};
  solid.angle = 90.0 * degree;
  expect_near(from_own(solid, {0, 0, 0}), {2.5, 0.5, 0});  // (1, 1) is (-1, -1/2) from (2, 3/2)
  expect_near(to_own(solid, {2.5, 0.5, 0}), {0, 0, 0});
  expect_near(own_direction(solid, {}, 0), {0, 1, 0});
  const Box box = bounding_box(solid, 2);
  expect_near(box.from, {1.5, 0.5, 0});
  expect_near(box.to, {2.5, 2.5, 0});
  EXPECT_TRUE(body_contains(solid, {1.6, 2.4, 0}, 0.0));
  EXPECT_FALSE(body_contains(solid, {1.1, 1.5, 0}, 0.0));
}

TEST(BodyShape, AnArcHasItsMiddleLineAsLength) {
  Solid solid;
  solid.arc = Arc{{1, 0, 0}, 2.0, 4.0, -90.0 * degree, 90.0 * degree};
  const Point extent = own_extent(solid);
  EXPECT_NEAR(extent[0], 2.0, 1e-15);
  EXPECT_NEAR(extent[1], 3.0 * std::numbers::pi, 1e-14);
  expect_near(from_own(solid, {0, 0, 0}), {1, -2, 0});
  expect_near(from_own(solid, {1, extent[1] / 2, 0}), {4, 0, 0});
  expect_near(to_own(solid, {1, 4, 0}), {2, extent[1], 0});
  expect_near(own_direction(solid, {1, extent[1] / 2, 0}, 1), {0, 1, 0});
  EXPECT_NEAR(own_stretch(solid, {2, 0, 0}), 4.0 / 3.0, 1e-15);
  // The ring reaches from its ends at x = 1 to its outer side at x = 5.
  const Box box = bounding_box(solid, 2);
  EXPECT_NEAR(box.to[0], 5.0, 1e-5);
  EXPECT_NEAR(box.from[1], -4.0, 1e-12);
}

TEST(BodyShape, SceneWithATurnedBody) {
  const auto problem = problem_of(
      scene(R"(body = { from = ["0.3 m", "0.1 m"], to = ["0.32 m", "0.2 m"], angle_degrees = 30 })",
            R"(["0.31 m", "0.15 m"])"));
  const Solid& solid = problem.solids[0];
  EXPECT_NEAR(solid.angle, 30.0 * degree, 1e-15);
  EXPECT_EQ(solid.clamped, Side::bottom);  // its own side: it touches no wall
  const auto outline = outline_points(solid, 11);
  expect_near(outline.front(), from_own(solid, {0, 0, 0}));
  expect_near(outline.back(), from_own(solid, {0.02, 0, 0}));
}

TEST(BodyShape, SceneWithAnArc) {
  const auto problem =
      problem_of(scene(R"(body = { centre = ["0.4 m", "0.15 m"], inner_radius = "80 mm", )"
                       R"(outer_radius = "100 mm", from_degrees = -45, to_degrees = 45 })",
                       R"(["0.49 m", "0.15 m"])"));
  ASSERT_TRUE(problem.solids[0].arc);
  EXPECT_EQ(problem.solids[0].arc->outer_radius, 0.1);
}

void expect_refused(const std::string& text, const std::string& words) {
  try {
    problem_of(text);
    ADD_FAILURE() << "accepted";
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(BodyShape, ScenesThatAreRefused) {
  const std::string probe = R"(["0.31 m", "0.15 m"])";
  expect_refused(scene(R"(body = { from = ["0.1 m", "0.14 m"], to = ["0.6 m", "0.16 m"], )"
                       R"(angle_degrees = 60 })",
                       R"(["0.35 m", "0.15 m"])"),
                 "out of the channel");
  expect_refused(scene(R"(body = { centre = ["0.4 m", "0.15 m"], inner_radius = "80 mm", )"
                       R"(outer_radius = "70 mm", from_degrees = -45, to_degrees = 45 })",
                       probe),
                 "outer_radius");
  expect_refused(scene(R"(body = { centre = ["0.4 m", "0.15 m"], inner_radius = "60 mm", )"
                       R"(outer_radius = "70 mm", from_degrees = 45, to_degrees = -45 })",
                       probe),
                 "from_degrees");
  // The probe lies in the box around the ring and not in the ring.
  expect_refused(scene(R"(body = { centre = ["0.4 m", "0.15 m"], inner_radius = "80 mm", )"
                       R"(outer_radius = "100 mm", from_degrees = -45, to_degrees = 45 })",
                       R"(["0.475 m", "0.15 m"])"),
                 "lies in no body");
}

TEST(BodyShape, TurnedBodiesMayStandCloseButNotOverlap) {
  const auto text = [](const std::string& second) {
    return scene(R"(body = { from = ["0.3 m", "0.1 m"], to = ["0.32 m", "0.2 m"], )"
                 R"(angle_degrees = 45 })",
                 R"(["0.31 m", "0.15 m"])") +
           "[solid.second]\nyoungs_modulus = \"0.7 MPa\"\nbody = " + second + "\n";
  };
  // Boxes around them overlap; along (1, 1)/sqrt(2) they lie 0.05/sqrt(2) - 0.02 = 0.015 apart.
  EXPECT_EQ(problem_of(text(R"({ from = ["0.35 m", "0.1 m"], to = ["0.37 m", "0.2 m"], )"
                            R"(angle_degrees = 45 })"))
                .solids.size(),
            2u);
  expect_refused(text(R"({ from = ["0.3 m", "0.14 m"], to = ["0.4 m", "0.16 m"] })"), "overlaps");
}

TEST(BodyShape, LawsOfTheSpringsAreRead) {
  const auto problem = problem_of(
      beam_text(24,
                "clamped = \"bottom\"\n[solid.beam.stiffening]\nratio = 5.0\ntoe_strain = 0.1\n"
                "[solid.beam.viscoelastic]\nmodulus = \"0.3 MPa\"\nrelaxation_time = \"0.5 s\"\n"
                "[solid.beam.fibre]\nangle_degrees = 90\nmodulus = \"2 MPa\""));
  const Solid& solid = problem.solids[0];
  EXPECT_EQ(solid.stiffening.value().ratio, 5.0);
  EXPECT_EQ(solid.stiffening.value().toe_strain, 0.1);
  EXPECT_EQ(solid.viscoelasticity.value().modulus, 3e5);
  EXPECT_EQ(solid.viscoelasticity.value().relaxation_time, 0.5);
  EXPECT_NEAR(solid.fibre.value().angle, 90.0 * degree, 1e-15);
  EXPECT_EQ(solid.fibre.value().modulus, 2e6);
  expect_refused(beam_text(24,
                           "clamped = \"bottom\"\n[solid.beam.stiffening]\nratio = 0.5\n"
                           "toe_strain = 0.1"),
                 "1 or more");
}

}  // namespace
}  // namespace sprung
