#include "sph/scene_setup.hpp"

#include "tests/unit/scene/beam_scene.hpp"
#include "tests/unit/scene/temporary_folder.hpp"
#include "tests/unit/sph/channel_scene.hpp"

#include <gtest/gtest.h>

namespace sprung::sph {
namespace {

using sprung::test::error_of;
using sprung::test::scene_error;
using sprung::test::TemporaryFolder;
using test::ChannelScene;

ParticleScene<2> set_up(const ChannelScene& scene) {
  const TemporaryFolder folder;
  Document document = scene.document();
  return sph::set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
}

void expect_contains(const std::string& text, const std::vector<std::string>& words) {
  for (const auto& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
}

TEST(ModulusTable, GivesTheRowOfTheRequest) {
  const TemporaryFolder folder;
  const auto table = test::plane_modulus_table(folder.path() / "table.csv");
  EXPECT_EQ(table.modulus_per_stiffness(2, Bonds::equal, 0.0), 1.5);
  EXPECT_EQ(table.modulus_per_stiffness(2, Bonds::isotropic, 300.0), 1.49504950495);
}

TEST(ModulusTable, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "table.csv";
  const auto table = test::plane_modulus_table(file);
  expect_contains(
      error_of([&] { table.modulus_per_stiffness(3, Bonds::equal, 0.0); }),
      {"table.csv", "3D", "equal", "2D, isotropic bonds, area stiffness 300", "calibrate"});
  expect_contains(error_of([&] { table.modulus_per_stiffness(2, Bonds::isotropic, 299.0); }),
                  {"299"});
  expect_contains(error_of([&] { ModulusTable(folder.path() / "none.csv"); }),
                  {"none.csv", "sprung calibrate"});
  for (const std::string line :
       {"2,equal,0", "2;equal;0;1.5", "two,equal,0,1.5", "2,equal,0,much"}) {
    std::ofstream(file) << "header\n2,equal,0,1.5\n" << line << "\n";
    expect_contains(error_of([&] { ModulusTable{file}; }), {"table.csv:3", line});
  }
}

TEST(SceneSetup, FillsTheChannelAndTheBeam) {
  const auto scene = set_up({});
  const auto& particles = scene.simulation->state().particles;
  EXPECT_EQ(particles.unknowns - particles.solids, 120u * 40u - 27u);
  // Beam 15 mm x 100 mm at 7.5 mm: two columns of the 13 rows whose centres (3.75 mm + k 7.5 mm)
  // lie below 100 mm.
  EXPECT_EQ(particles.solids, 2u * 13u);
  ASSERT_EQ(scene.bodies.size(), 1u);
  EXPECT_EQ(scene.bodies[0].name, "beam");
  EXPECT_EQ(scene.bodies[0].last, 26u);
  // 2h = 2.6 dx: three columns on either side.
  EXPECT_EQ(particles.size() - particles.unknowns, 6u * 40u);
  for (std::size_t i = 0; i < particles.solids; ++i) {
    EXPECT_EQ(particles.role[i], Role::solid);
    EXPECT_GT(particles.position[i][0], 0.3);
    EXPECT_LT(particles.position[i][0], 0.315);
    EXPECT_LT(particles.position[i][1], 0.1);
  }
}

TEST(SceneSetup, RefusesABeamOfOneParticle) {
  ChannelScene scene;
  scene.spacing = 0.015;
  expect_contains(
      scene_error([&] { set_up(scene); }),
      {"beam.toml:", "[solid.beam]", "body", "one particle thick", "3.75 mm gives four"});
}

TEST(SceneSetup, WarnsOfABeamOfTwoAndNotOfFour) {
  ChannelScene scene;
  const auto coarse = set_up(scene);
  ASSERT_EQ(coarse.warnings.size(), 1u);
  expect_contains(coarse.warnings[0], {"[solid.beam]", "2 particles thick"});
  scene.spacing = 0.00375;
  EXPECT_TRUE(set_up(scene).warnings.empty());
}

// 3 rho U^2/E (L/t)^2 = 3 x 1000 x 0.25/0.35e6 x (0.1/0.015)^2 = 0.095; with twice the modulus half
// of it, within the 5 % of the plane.
TEST(SceneSetup, WarnsOfABodyThatIsStrainedBeyondTheCalibration) {
  ChannelScene scene;
  scene.spacing = 0.00375;
  scene.youngs_modulus = 0.35e6;
  const auto soft = set_up(scene);
  ASSERT_EQ(soft.warnings.size(), 1u);
  expect_contains(soft.warnings[0], {"[solid.beam]", "about 9.5 %", "up to 5 %"});
}

TEST(SceneSetup, RefusesASpacingThatDoesNotDivideTheChannel) {
  ChannelScene scene;
  scene.spacing = 0.007;
  expect_contains(scene_error([&] { set_up(scene); }),
                  {"beam.toml:", "spacing", "nearest that does"});
  scene.spacing = 0.0;
  EXPECT_NE(scene_error([&] { set_up(scene); }), "");
}

TEST(SceneSetup, RefusesWhatNobodyReads) {
  ChannelScene scene;
  scene.sph = "spacings = \"1 mm\"";
  expect_contains(scene_error([&] { set_up(scene); }), {"beam.toml:", "spacings", "spacing"});
}

TEST(SceneSetup, StiffnessComesFromTheTable) {
  ChannelScene scene;
  scene.preset = "paper";
  const auto printed = set_up(scene);
  // k_e = E/lambda = 0.7 MPa/1.5; in the plane a bond has k_e per metre of depth.
  for (const Bond& bond : printed.solid->network().bonds)
    EXPECT_NEAR(bond.stiffness, 0.7e6 / 1.5, 1e-6);
  EXPECT_TRUE(printed.solid->network().cells.empty());
  scene.preset = "recommended";
  const auto corrected = set_up(scene);
  ASSERT_FALSE(corrected.solid->network().cells.empty());
  // kappa G, G = k_e/2; 13 rows share the height of 0.1 m, and a cell at the clamp ends there, half
  // as high.
  const double modulus = 300.0 * 0.5 * 0.7e6 / 1.49504950495;
  for (const auto& cell : corrected.solid->network().cells) {
    const bool at_clamp = *std::max_element(cell.corner.begin(), cell.corner.end()) >= 26;
    EXPECT_NEAR(cell.modulus, modulus, 1e-6 * modulus);
    EXPECT_NEAR(cell.rest_volume / (0.0075 * 0.1 / 13.0), at_clamp ? 0.5 : 1.0, 1e-9);
  }
}

// 0.1 m are 13.3 spacings: the rows of a fitted beam share the height, on the lattice a third of a
// spacing is left over.
TEST(SceneSetup, ABodyOffTheLatticeFillsItsHeight) {
  for (const bool fitted : {true, false}) {
    ChannelScene scene;
    scene.numerics = fitted ? "" : "fitted_bodies = false";
    const auto made = set_up(scene);
    const auto& particles = made.simulation->state().particles;
    double low = 1.0, high = 0.0;
    for (std::size_t i = 0; i < particles.solids; ++i) {
      low = std::min(low, particles.position[i][1]);
      high = std::max(high, particles.position[i][1]);
    }
    EXPECT_EQ(particles.solids, 26u);
    // 15 mm x 100 mm are 26.7 cells of the lattice, whatever the beam's own number of particles.
    EXPECT_EQ(particles.unknowns - particles.solids, 120u * 40u - (fitted ? 27u : 26u));
    EXPECT_NEAR(low + high, fitted ? 0.1 : 0.0975, 1e-12);
  }
}

// A beam at 30 degrees keeps the domain as full as the lattice and gets a network that no step of
// the lattice cuts: the straight beam's, turned.
TEST(SceneSetup, AnObliqueBodyIsFittedAndTheFluidMakesRoom) {
  ChannelScene scene;
  std::string text = scene.text();
  const auto replace = [&](const std::string& old, const std::string& by) {
    const auto at = text.find(old);
    ASSERT_NE(at, std::string::npos) << old;
    text.replace(at, old.size(), by);
  };
  replace("[\"0.3 m\", \"0 m\"], to = [\"0.315 m\", \"0.1 m\"]",
          "[\"0.3 m\", \"0.1 m\"], to = [\"0.3225 m\", \"0.205 m\"], angle_degrees = 30");
  replace("displacement_of = [\"0.3075 m\", \"0.1 m\"]",
          "displacement_of = [\"0.31 m\", \"0.15 m\"]");
  Document document = Document::from_text(text);
  const TemporaryFolder folder;
  const auto turned =
      sph::set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
  EXPECT_EQ(turned.simulation->state().particles.solids, 3u * 14);
  EXPECT_EQ(turned.simulation->state().particles.unknowns, 120u * 40);
  for (const Bond& bond : turned.solid->network().bonds)
    EXPECT_NEAR(bond.rest_length / 0.0075, bond.rest_length < 0.009 ? 1.0 : std::sqrt(2.0), 1e-9);
  // The fluid has spread into the room that it was left: no hole and no clot. On the lattice the
  // sum is 1; a disordered fluid has some per cent of scatter.
  const auto& partition = turned.simulation->state().support.partition();
  EXPECT_GT(*std::min_element(partition.begin(), partition.end()), 0.9);
  EXPECT_LT(*std::max_element(partition.begin(), partition.end()), 1.1);
}

// CFL 0.4 x 7.5 mm / (2 x 0.75 m/s) = 2 ms. Viscosity 0.8 dx^2/(3.8214 nu), the checkerboard's
// decay at h = 1.3 dx: 2 ms x 0.59.
TEST(SceneSetup, TimeStepIsSetByTheSmallestLimit) {
  ChannelScene scene;
  const auto recommended = set_up(scene);
  EXPECT_NEAR(recommended.simulation->time_step_limit().value, 2e-3, 1e-12);
  expect_contains(std::string(recommended.simulation->time_step_limit().limit), {"CFL"});
  scene.viscosity = 100.0;
  scene.beam = false;
  const double viscous = 0.8 / 3.82141 * std::pow(0.0075, 2) / 0.1;
  EXPECT_NEAR(set_up(scene).simulation->time_step_limit().value, viscous, 1e-5 * viscous);
  scene.beam = true;
  EXPECT_LT(set_up(scene).simulation->time_step_limit().value, viscous);
  scene.viscosity = 1.0;
  scene.preset = "paper";
  scene.numerics = "position_update = \"new_velocity\"";
  // Explicit springs: 0.8 x 0.7071 dx sqrt(rho/k_e) in a large block (method.md section 2); the
  // beam of two columns has a lower highest frequency, and a clamp.
  const double block = 0.8 * 0.70711 * 0.0075 * std::sqrt(1000.0 * 1.5 / 0.7e6);
  const auto symplectic = set_up(scene).simulation->time_step_limit();
  EXPECT_GT(symplectic.value, 0.99 * block);
  EXPECT_LT(symplectic.value, 1.3 * block);
  expect_contains(std::string(symplectic.limit), {"springs"});
  // As printed: at most 0.8 x 2 mu/C44, C44 = k_e = E/1.5 along the axes. Rows that move against
  // each other in a large block have w^2 = 8 k_e/(rho dx^2) and decay at 4 nu/dx^2 where h = dx
  // (the pairs that the moment normalises by are those that turn), so half of it; two columns hold
  // more.
  scene.numerics = "";
  const auto printed = set_up(scene).simulation->time_step_limit();
  const double long_waves = 0.8 * 2.0 * 1.5 / 0.7e6;
  EXPECT_LT(printed.value, long_waves);
  EXPECT_GT(printed.value, 0.5 * long_waves);
  expect_contains(std::string(printed.limit), {"mean velocity"});
}

// The bound on the viscous decay r against the recurrence itself, frozen in place: Adams-Bashforth
// holds r dt < 1, and a step half as long again must be too long, or the bound would be of no use.
// Walls and bodies take the profile's bend from the step before, so no operator's eigenvalue will
// do. The incoming fluid is taken out by a difference.
TEST(SceneSetup, TheViscousStepHoldsBesideABody) {
  const auto growth = [](double of_limit, const char* start = "") {
    ChannelScene scene;
    scene.sph = start;
    scene.length = 0.3;
    scene.beam_x = 0.1;
    scene.probe_x = 0.2;
    // Two runs that differ by some of every mode.
    auto one = set_up(scene), other = set_up(scene);
    auto& u = one.simulation->state().particles.velocity;
    auto& v = other.simulation->state().particles.velocity;
    const std::size_t n = one.simulation->state().particles.unknowns;
    const double decay =
        one.simulation->effects().limits[0]->fastest_mode(one.simulation->state()).decay;
    for (std::size_t i = 0; i < n; ++i)
      u[i] += Vector<2>(std::sin(12.9898 * i), std::cos(78.233 * i));
    const double dt = of_limit / decay;
    const auto step = [&](ParticleScene<2>& setup) {
      auto& state = setup.simulation->state();
      state.clock.time_step = dt;
      std::vector<Vector<2>> a(n, Vector<2>::Zero());
      setup.simulation->effects().diffusion[0]->add_acceleration(state, a);
      state.clock.previous_time_step = dt;
      for (std::size_t i = 0; i < n; ++i) state.particles.velocity[i] += dt * a[i];
    };
    const auto difference = [&] {
      double sum = 0.0;
      for (std::size_t i = 0; i < n; ++i) sum += (u[i] - v[i]).squaredNorm();
      return std::sqrt(sum);
    };
    for (int k = 0; k < 400; ++k) step(one), step(other);
    const double before = difference();
    for (int k = 0; k < 100; ++k) step(one), step(other);
    return difference() / before;
  };
  EXPECT_LT(growth(1.0), 1.0);
  EXPECT_LT(growth(1.0, "disorder = 0.3"), 1.0);
  EXPECT_GT(growth(1.5), 1.0);
}

// 0.1 m over 7.5 mm are 13 rows a little farther apart than the fluid's.
TEST(SceneSetup, ABodyWeighsWhatItsShapeHolds) {
  const auto setup = set_up(ChannelScene{});
  double mass = 0.0;
  for (std::size_t i = 0; i < setup.solid->network().movable; ++i) mass += setup.solid->mass(i);
  EXPECT_NEAR(mass, 1000.0 * 0.015 * 0.1, 1e-12);
}

TEST(SceneSetup, RefusesThePrintedIntegratorWithoutViscosity) {
  ChannelScene scene;
  scene.preset = "paper";
  std::string inviscid = scene.text();
  const std::string table = "[viscosity]\ndynamic = \"1 Pa s\"\n";
  inviscid.replace(inviscid.find(table), table.size(), "");
  inviscid.replace(inviscid.find("no_slip"), 7, "free_slip");
  const TemporaryFolder folder;
  Document document = Document::from_text(inviscid);
  const auto modulus = test::plane_modulus_table(folder.path() / "table.csv");
  expect_contains(scene_error([&] { sph::set_up<2>(document, modulus); }),
                  {"mean_velocity", "unstable", "new_velocity"});
}

// A table that is present is an effect that exists; its absence means no object, no array.
TEST(SceneSetup, CreatesOnlyTheEffectsThatTheSceneNames) {
  ChannelScene scene;
  scene.beam = false;
  const auto fluid = set_up(scene);
  auto& effects = fluid.simulation->effects();
  EXPECT_EQ(fluid.solid, nullptr);
  EXPECT_TRUE(fluid.bodies.empty());
  EXPECT_TRUE(effects.body_forces.empty());
  EXPECT_TRUE(effects.constraints.empty());
  EXPECT_EQ(effects.diffusion.size(), 1u);
  EXPECT_EQ(effects.motion.size(), 1u);
  EXPECT_EQ(effects.limits.size(), 1u);
  EXPECT_EQ(fluid.simulation->state().particles.carried.size(), 1u);
  EXPECT_EQ(fluid.effects.size(), 2u);

  // One beam, farther from the other wall than it is long: nothing to touch.
  scene.beam = true;
  const auto alone = set_up(scene);
  for (const auto& effect : alone.effects) EXPECT_EQ(effect.find("contact"), std::string::npos);
  scene.beam = false;

  scene.numerics = "shifting = \"none\"";
  const auto still = set_up(scene);
  EXPECT_TRUE(still.simulation->effects().motion.empty());

  std::string inviscid = scene.text();
  const std::string table = "[viscosity]\ndynamic = \"1 Pa s\"\n";
  inviscid.replace(inviscid.find(table), table.size(), "");
  inviscid.replace(inviscid.find("no_slip"), 7, "free_slip");
  Document document = Document::from_text(inviscid);
  const TemporaryFolder folder;
  const auto ideal =
      sph::set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
  EXPECT_TRUE(ideal.simulation->effects().diffusion.empty());
  EXPECT_TRUE(ideal.simulation->effects().limits.empty());
  EXPECT_TRUE(ideal.simulation->state().particles.carried.empty());
}

TEST(SceneSetup, ABeamBringsItsEffects) {
  ChannelScene scene;
  const auto recommended = set_up(scene);
  EXPECT_EQ(recommended.simulation->effects().body_forces.size(), 1u);
  EXPECT_EQ(recommended.simulation->effects().constraints.size(), 1u);
  EXPECT_EQ(recommended.simulation->effects().limits.size(), 1u);  // implicit springs set none
  scene.preset = "paper";
  const auto printed = set_up(scene);
  EXPECT_EQ(printed.simulation->effects().body_forces.size(), 1u);
  EXPECT_TRUE(printed.simulation->effects().constraints.empty());
  // Viscosity, the highest spring frequency, the printed update.
  EXPECT_EQ(printed.simulation->effects().limits.size(), 3u);
}

}  // namespace
}  // namespace sprung::sph
