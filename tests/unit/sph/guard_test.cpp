/// What the guard finds: each test spoils one thing of a sound state, by an amount beside the
/// limit.

#include "sph/guard.hpp"

#include "tests/unit/scene/temporary_folder.hpp"
#include "tests/unit/sph/channel_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sprung::sph {
namespace {

constexpr double dx = 0.005;

ParticleScene<2> beam_at_rest() {
  test::ChannelScene channel;
  channel.spacing = dx;
  channel.length = 0.3;
  channel.height = 0.15;
  channel.beam_x = 0.12;
  channel.beam_width = 0.02;
  channel.probe_x = 0.2;
  const sprung::test::TemporaryFolder folder;
  Document document = channel.document();
  return set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
}

std::string fault_of(const ParticleScene<2>& scene) {
  return Guard<2>(scene).find_fault().value_or("");
}

void expect_says(const std::string& fault, std::initializer_list<const char*> words) {
  for (const char* word : words)
    EXPECT_NE(fault.find(word), std::string::npos) << word << ": " << fault;
}

Particles<2>& particles_of(ParticleScene<2>& scene) {
  return scene.simulation->state().particles;
}

TEST(Guard, ASoundStateHasNoFault) {
  EXPECT_EQ(fault_of(beam_at_rest()), "");
}

TEST(Guard, NamesTheParticleThatIsNotANumber) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  const std::size_t i = particles.solids + 17;
  particles.pseudo_pressure[i] = std::numeric_limits<double>::quiet_NaN();
  expect_says(fault_of(scene), {("particle " + std::to_string(particles.identity[i])).c_str(),
                                "(fluid) at (", "not a number", "at t = 0 s", "smaller time step"});
}

TEST(Guard, NamesTheParticleThatIsTooFast) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  const double scale = scene.simulation->velocity_scale();
  particles.velocity[3] = {9.9 * scale, 0.0};
  EXPECT_EQ(fault_of(scene), "");
  particles.velocity[3] = {10.1 * scale, 0.0};
  expect_says(fault_of(scene),
              {"particle 3 (solid) at (", "10 times the velocity scale", "spring_integration"});
}

// rms speed s holds the energy s^2/2 per mass: twice the scale is four times what the fastest flow
// could hold.
TEST(Guard, SeesTheEnergyOfAll) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  const double scale = scene.simulation->velocity_scale();
  for (std::size_t i = 0; i < particles.unknowns; ++i) particles.velocity[i] = {1.98 * scale, 0.0};
  scene.simulation->state().clock.step = 1;  // no sweep over pairs: the inflow stands still
  EXPECT_EQ(fault_of(scene), "");
  for (std::size_t i = 0; i < particles.unknowns; ++i) particles.velocity[i] = {2.02 * scale, 0.0};
  expect_says(fault_of(scene), {"kinetic energy", "velocity_scale"});
}

// A corner particle moved outwards along the diagonal of a cell by 0.2 of it: its bonds along x and
// y get sqrt(1.2^2 + 0.2^2) = 1.2166 of their length, the diagonal 1.2: three springs beyond 5 %.
TEST(Guard, KeepsTheLargestStrainOfTheSprings) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  Guard<2> guard(scene);
  scene.simulation->state().clock.step = 1;
  ASSERT_EQ(guard.find_fault().value_or(""), "");
  EXPECT_LT(guard.spring_strain().largest, 1e-12);
  EXPECT_TRUE(guard.spring_strain().within(2));
  std::size_t corner = 0;  // farthest up and to the right
  for (std::size_t i = 0; i < particles.solids; ++i)
    if (particles.position[i].sum() > particles.position[corner].sum()) corner = i;
  const Vector<2> place = particles.position[corner];
  particles.position[corner] += Vector<2>(0.2 * dx, 0.2 * dx);
  scene.simulation->state().clock.time = 0.25;
  ASSERT_EQ(guard.find_fault().value_or(""), "");
  particles.position[corner] = place;
  scene.simulation->state().clock.time = 0.5;
  ASSERT_EQ(guard.find_fault().value_or(""), "");

  Archive archive;
  guard.save(archive);
  Guard<2> resumed(scene);
  resumed.restore(archive);
  const SpringStrain& strain = resumed.spring_strain();
  EXPECT_NEAR(strain.largest, std::sqrt(1.2 * 1.2 + 0.2 * 0.2) - 1.0, 1e-9);
  EXPECT_DOUBLE_EQ(strain.time, 0.25);
  EXPECT_DOUBLE_EQ(strain.share, 3.0 / static_cast<double>(scene.solid->network().bonds.size()));
  EXPECT_FALSE(strain.within(2));
  expect_says(strain.told(2), {"21.7 %", "t = 0.25 s", "beyond the 5 %", "stress_strain.csv"});
}

// A corner particle moved outwards along the diagonal by 0.4 of the diagonal: its bonds along x and
// y get sqrt(1.4^2 + 0.4^2) = 1.46 of their length, the diagonal 1.4; by 1.1: more than 2.
TEST(Guard, NamesTheSpringThatIsTooLong) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  std::size_t corner = 0;  // farthest up and to the right
  for (std::size_t i = 0; i < particles.solids; ++i)
    if (particles.position[i].sum() > particles.position[corner].sum()) corner = i;
  const Vector<2> place = particles.position[corner];
  scene.simulation->state().clock.step = 1;
  particles.position[corner] = place + Vector<2>(0.4 * dx, 0.4 * dx);
  EXPECT_EQ(fault_of(scene), "");
  particles.position[corner] = place + Vector<2>(1.1 * dx, 1.1 * dx);
  expect_says(fault_of(scene), {"the spring of particle", "times its rest length"});
}

// The body stretched by 1.06 both ways has 1.1236 of its area, limit 1/0.9 = 1.111;
// by 1.04: 1.0816.
TEST(Guard, SeesTheVolumeOfTheBodies) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  const Vector<2> foot(0.13, 0.0);  // the middle of the clamped side
  const std::vector<Vector<2>> rest(particles.position.begin(),
                                    particles.position.begin() + std::ptrdiff_t(particles.solids));
  for (std::size_t i = 0; i < rest.size(); ++i)
    particles.position[i] = foot + 1.04 * (rest[i] - foot);
  EXPECT_EQ(fault_of(scene), "");
  for (std::size_t i = 0; i < rest.size(); ++i)
    particles.position[i] = foot + 1.06 * (rest[i] - foot);
  expect_says(fault_of(scene), {"times their volume at rest", "area_stiffness"});
}

// u = A sin(k x) has the divergence A k cos(k x), rms A k / sqrt(2). With a wave of 12 dx the
// discrete one is a few per cent less; inlet and outlet are few of 60 columns. A k dx / sqrt(2) =
// 0.4 and 0.6 of the scale lie on both sides of the limit of 0.5.
TEST(Guard, SeesTheDivergence) {
  ParticleScene<2> scene = beam_at_rest();
  auto& particles = particles_of(scene);
  const double k = 2.0 * M_PI / (12.0 * dx);
  const auto stir = [&](double divergence) {
    const double a = std::sqrt(2.0) * divergence * scene.simulation->velocity_scale() / (k * dx);
    for (std::size_t i = 0; i < particles.size(); ++i)
      particles.velocity[i] = {a * std::sin(k * particles.position[i][0]), 0.0};
  };
  stir(0.4);
  EXPECT_EQ(fault_of(scene), "");
  stir(0.6);
  expect_says(fault_of(scene), {"divergence", "pressure_tolerance"});
}

// 1 % of the 1716 particles of fluid is 17: as many may stand on top of each other, not more.
TEST(Guard, SeesClumps) {
  const auto fault_with = [](std::size_t pairs) {
    ParticleScene<2> scene = beam_at_rest();
    auto& particles = particles_of(scene);
    for (std::size_t k = 0; k < pairs; ++k) {
      const std::size_t i = particles.solids + 4 * k;
      particles.position[i + 1] = particles.position[i] + Vector<2>(0.1 * dx, 0.0);
    }
    scene.simulation->update_support_and_mirrors();
    return fault_of(scene);
  };
  EXPECT_EQ(fault_with(8), "");  // both of each pair count: 16
  expect_says(fault_with(10), {"20 particles", "closer than 0.2 spacings", "stronger shifting"});
}

}  // namespace
}  // namespace sprung::sph
