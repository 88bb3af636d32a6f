#include "sph/numerics.hpp"

#include "tests/unit/scene/beam_scene.hpp"

#include <gtest/gtest.h>

namespace sprung::sph {
namespace {

Numerics numerics(const std::string& lines) {
  Document document = Document::from_text("[numerics]\n" + lines, "beam.toml");
  const Numerics n = read_numerics(document);
  document.refuse_unread();
  return n;
}

std::string refusal(const std::string& lines) {
  return sprung::test::scene_error([&] { numerics(lines); });
}

/// What the paper prints: h = dx, mean velocity, explicit equal springs, nothing corrected.
TEST(Numerics, PaperIsAsPrinted) {
  const Numerics n = numerics("preset = \"paper\"\n");
  EXPECT_EQ(n.preset, "paper");
  EXPECT_EQ(n.smoothing_length_ratio, 1.0);
  EXPECT_FALSE(n.normalised_gradient);
  EXPECT_EQ(n.position_update, PositionUpdate::mean_velocity);
  EXPECT_EQ(n.bonds, Bonds::equal);
  EXPECT_EQ(n.spring_integration, SpringIntegration::explicit_force);
  EXPECT_FALSE(n.volume_along_step);
  EXPECT_EQ(n.density_feedback, 0.0);
  EXPECT_EQ(n.void_feedback, 0.0);
  EXPECT_EQ(n.body_projections, 1);
  EXPECT_FALSE(n.fitted_bodies);
  EXPECT_FALSE(n.surface_correction);
  EXPECT_EQ(n.area_stiffness, 0.0);
  EXPECT_EQ(n.solid_no_slip, SolidNoSlip::centres);
}

TEST(Numerics, RecommendedIsTheDefaultAndCorrected) {
  for (const std::string lines : {"", "preset = \"recommended\"\n"}) {
    const Numerics n = numerics(lines);
    EXPECT_EQ(n.preset, "recommended");
    EXPECT_EQ(n.smoothing_length_ratio, 1.3);
    EXPECT_TRUE(n.normalised_gradient);
    EXPECT_EQ(n.position_update, PositionUpdate::new_velocity);
    EXPECT_EQ(n.bonds, Bonds::isotropic);
    EXPECT_EQ(n.spring_integration, SpringIntegration::implicit_force);
    EXPECT_TRUE(n.volume_along_step);
    EXPECT_GT(n.density_feedback, 0.0);
    EXPECT_GT(n.void_feedback, 0.0);
    EXPECT_GT(n.body_projections, 1);
    EXPECT_TRUE(n.fitted_bodies);
    EXPECT_TRUE(n.surface_correction);
    EXPECT_GT(n.area_stiffness, 0.0);
    EXPECT_EQ(n.solid_no_slip, SolidNoSlip::face);
  }
}

TEST(Numerics, EveryChoiceCanBeNamedOnItsOwn) {
  const Numerics n = numerics(R"(preset = "paper"
smoothing_length_ratio = 1.5
normalised_gradient = true
position_update = "new_velocity"
shifting = "none"
shifting_coefficient = 0.1
volume_along_step = true
density_feedback = 0.25
void_feedback = 1.5
fitted_bodies = true
pressure_tolerance = 1e-5
pressure_solver = "bicgstab"
body_projections = 5
bonds = "isotropic"
solid_no_slip = "face"
surface_correction = true
area_stiffness = 30
spring_integration = "implicit"
courant = 0.2
)");
  EXPECT_EQ(n.smoothing_length_ratio, 1.5);
  EXPECT_TRUE(n.normalised_gradient);
  EXPECT_EQ(n.position_update, PositionUpdate::new_velocity);
  EXPECT_EQ(n.shifting, Shifting::none);
  EXPECT_EQ(n.shifting_coefficient, 0.1);
  EXPECT_TRUE(n.volume_along_step);
  EXPECT_EQ(n.density_feedback, 0.25);
  EXPECT_EQ(n.void_feedback, 1.5);
  EXPECT_TRUE(n.fitted_bodies);
  EXPECT_EQ(n.pressure_tolerance, 1e-5);
  EXPECT_EQ(n.pressure_solver, PressureSolverKind::bicgstab);
  EXPECT_EQ(n.body_projections, 5);
  EXPECT_EQ(n.bonds, Bonds::isotropic);
  EXPECT_EQ(n.solid_no_slip, SolidNoSlip::face);
  EXPECT_TRUE(n.surface_correction);
  EXPECT_EQ(n.area_stiffness, 30.0);
  EXPECT_EQ(n.spring_integration, SpringIntegration::implicit_force);
  EXPECT_EQ(n.courant, 0.2);
}

TEST(Numerics, TheOppositeWordsToo) {
  const Numerics n = numerics(R"(position_update = "mean_velocity"
shifting = "xu"
pressure_solver = "two_level"
bonds = "equal"
solid_no_slip = "centres"
spring_integration = "explicit"
)");
  EXPECT_EQ(n.position_update, PositionUpdate::mean_velocity);
  EXPECT_FALSE(n.volume_along_step);  // only new velocities can keep it
  EXPECT_EQ(n.shifting, Shifting::xu);
  EXPECT_EQ(n.pressure_solver, PressureSolverKind::two_level);
  EXPECT_EQ(n.bonds, Bonds::equal);
  EXPECT_EQ(n.solid_no_slip, SolidNoSlip::centres);
  EXPECT_EQ(n.spring_integration, SpringIntegration::explicit_force);
}

TEST(Numerics, RefusalsNameLineValueAndRange) {
  const std::string ratio = refusal("smoothing_length_ratio = 3.0\n");
  EXPECT_NE(ratio.find("beam.toml:2"), std::string::npos) << ratio;
  EXPECT_NE(ratio.find("smoothing_length_ratio"), std::string::npos) << ratio;
  EXPECT_NE(ratio.find("3"), std::string::npos) << ratio;
  EXPECT_NE(ratio.find("between 0.8 and 2"), std::string::npos) << ratio;
  const std::string word = refusal("shifting = \"xue\"\n");
  EXPECT_NE(word.find("beam.toml:2"), std::string::npos) << word;
  EXPECT_NE(word.find("xu"), std::string::npos) << word;
  EXPECT_NE(refusal("preset = \"papers\"\n").find("paper"), std::string::npos);
  const std::string key = refusal("shifting_coeficient = 0.04\n");
  EXPECT_NE(key.find("shifting_coefficient"), std::string::npos) << key;
  EXPECT_NE(refusal("pressure_tolerance = 0.0\n"), "");
  EXPECT_NE(refusal("courant = 0.0\n"), "");
  EXPECT_NE(refusal("density_feedback = -0.1\n"), "");
  EXPECT_NE(refusal("void_feedback = -0.1\n"), "");
  EXPECT_NE(refusal("body_projections = 0\n").find("between 1 and 10"), std::string::npos);
  const std::string motion =
      refusal("position_update = \"mean_velocity\"\nvolume_along_step = true\n");
  EXPECT_NE(motion.find("new_velocity"), std::string::npos) << motion;
  EXPECT_NE(refusal("courant = \"0.4 s\"\n"), "");
}

/// The limits are part of the message; one that reads as 0.000000 tells nobody what to write.
TEST(Numerics, RefusalsStateSmallLimitsReadably) {
  const std::string message = refusal("pressure_tolerance = 0.0\n");
  EXPECT_EQ(message.find("0.000000"), std::string::npos) << message;
}

TEST(Numerics, DefaultsAreWrittenIntoTheResolvedScene) {
  Document document = Document::from_text("[numerics]\npreset = \"paper\"\n");
  read_numerics(document);
  const std::string resolved = document.resolved_toml();
  for (const char* key : {"smoothing_length_ratio", "bonds", "courant", "position_update"})
    EXPECT_NE(resolved.find(key), std::string::npos) << key;
}

}  // namespace
}  // namespace sprung::sph
