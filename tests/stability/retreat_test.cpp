/// What a run does with a fault: it stops with a checkpoint that is good, or goes back to it with
/// half the step.

#include "sph/guard.hpp"
#include "sph/time_step.hpp"
#include "tests/properties/recorded_run.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

using sprung::test::TemporaryFolder;
using test::ChannelScene;

// Explicit springs moved with the new velocity are stable for dt < 0.7071 dx sqrt(rho/k_e)
// (method.md section 2) = 1.23e-4 s with k_e = E/1.5: 1.3e-4 s is not, half of it is.
ChannelScene beyond_the_limit() {
  ChannelScene scene;
  scene.preset = "paper";
  scene.numerics = "position_update = \"new_velocity\"";
  scene.spacing = 0.00375;
  scene.length = 0.15;
  scene.height = 0.12;
  scene.beam_x = 0.06;
  scene.beam_height = 0.06;
  scene.probe_x = 0.12;
  scene.ramp = 0.1;
  scene.end = 0.02;
  scene.probe_times = "\"0.02 s\"";
  scene.sph = "time_step = \"1.3e-4 s\"\n";
  return scene;
}

void expect_finite(const std::filesystem::path& out) {
  const RecordReader record(out);
  for (const char* name : {"tip", "force", "ledger_mass", "ledger_energy", "ledger_solid"})
    for (const double value : record.series(name).values) ASSERT_TRUE(std::isfinite(value)) << name;
}

TEST(Retreat, AFaultStopsTheRunAndLeavesACheckpointThatIsGood) {
  const TemporaryFolder folder;
  const auto out = folder.path() / "out";
  ASSERT_EQ(test::run_scene(beyond_the_limit().document(), out), Outcome::stopped);
  expect_finite(out);
  const double fault_time = RecordReader(out).series("tip").column("time").back();
  ASSERT_TRUE(std::filesystem::exists(out / "checkpoint.h5"));

  // Good: with half the step the run goes on from there, past the fault, to its end.
  Document document = beyond_the_limit().document();
  ParticleScene<2> scene =
      set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
  scene.simulation->restore(read_archive(out / "checkpoint.h5"));
  const Clock& clock = scene.simulation->state().clock;
  EXPECT_GT(clock.time, 0.0);
  EXPECT_LT(clock.time, fault_time);
  scene.simulation->shorten_steps(0.5);
  Guard<2> guard(scene);
  EXPECT_EQ(guard.find_fault(), std::nullopt);
  while (clock.time < 0.02) {
    advance(*scene.simulation);
    ASSERT_EQ(guard.find_fault().value_or(""), "");
  }
}

TEST(Retreat, GoesBackWithHalfTheStepAndTellsSo) {
  const TemporaryFolder folder;
  ChannelScene scene = beyond_the_limit();
  scene.sph += "retreat = true\n";
  const auto a = folder.path() / "a", b = folder.path() / "b";
  ASSERT_EQ(test::run_scene(scene.document(), a), Outcome::finished);
  expect_finite(a);
  const RecordReader record(a);
  EXPECT_EQ(record.manifest_number("retreats"), 1.0);
  EXPECT_NE(record.manifest_text("retreats").find("back to t = "), std::string::npos);
  const SeriesData& told = record.series("ledger_retreats");
  ASSERT_EQ(told.rows(), 1u);
  EXPECT_EQ(told.column("step_factor").back(), 0.5);
  EXPECT_LT(told.column("time").back(), told.column("fault_time").back());
  // Time goes on in one piece: nothing of what was taken back is left.
  const auto time = record.series("tip").column("time");
  for (std::size_t k = 1; k < time.size(); ++k) ASSERT_GT(time[k], time[k - 1]);
  EXPECT_NEAR(time.back(), 0.02, 1e-12);
  // By simulated time alone: another run goes back to the same place and gives the same bits.
  ASSERT_EQ(test::run_scene(scene.document(), b), Outcome::finished);
  test::expect_same_bytes(a, b);
}

/// |length/rest length - 1| of the most strained spring now.
double most_strained(const ParticleScene<2>& scene) {
  const auto& network = scene.solid->network();
  const auto& position = scene.simulation->state().particles.position;
  const auto at = [&](std::int32_t node) {
    return std::size_t(node) < network.movable ? position[node] : network.reference[node];
  };
  double most = 0.0;
  for (const Bond& bond : network.bonds)
    most = std::max(most, std::abs((at(bond.a) - at(bond.b)).norm() / bond.rest_length - 1.0));
  return most;
}

// The run that the record holds is the one up to the checkpoint, and from there on with half the
// step: stepped here, its springs looked at after every step. The attempt that was given up
// strained them more.
TEST(Retreat, TellsTheStrainOfTheRunThatIsKept) {
  const TemporaryFolder folder;
  ChannelScene scene = beyond_the_limit();
  const auto failed = folder.path() / "failed", kept = folder.path() / "kept";
  ASSERT_EQ(test::run_scene(scene.document(), failed), Outcome::stopped);
  const Archive good = read_archive(failed / "checkpoint.h5");
  scene.sph += "retreat = true\n";
  ASSERT_EQ(test::run_scene(scene.document(), kept), Outcome::finished);

  Document document = scene.document();
  ParticleScene<2> own =
      set_up<2>(document, test::plane_modulus_table(folder.path() / "table.csv"));
  const Clock& clock = own.simulation->state().clock;
  const std::int64_t good_step = std::get<std::vector<std::int64_t>>(good.at("counters")).at(0);
  double largest = 0.0;
  own.simulation->stop_at(0.02);
  while (clock.step < good_step) {
    advance(*own.simulation);
    largest = std::max(largest, most_strained(own));
  }
  own.simulation->restore(good);
  own.simulation->shorten_steps(0.5);
  own.simulation->stop_at(0.02);
  while (clock.time < 0.02) {
    advance(*own.simulation);
    largest = std::max(largest, most_strained(own));
  }
  const auto told = [](const std::filesystem::path& out) {
    return RecordReader(out).manifest_number("largest_spring_strain");
  };
  EXPECT_NEAR(told(kept), largest, 1e-12);
  EXPECT_GT(told(failed), 1.5 * largest);
}

// What smaller steps do not cure ends after five retreats, not never.
TEST(Retreat, GivesUpAfterFive) {
  const TemporaryFolder folder;
  ChannelScene scene = beyond_the_limit();
  scene.end = 0.004;
  scene.probe_times = "\"0.004 s\"";
  scene.sph = "time_step = \"1e-3 s\"\nretreat = true\nvelocity_scale = \"1e-6 m/s\"\n";
  scene.ramp = 0.0;
  EXPECT_EQ(test::run_scene(scene.document(), folder.path() / "out"), Outcome::stopped);
  const RecordReader record(folder.path() / "out");
  EXPECT_EQ(record.manifest_number("retreats"), 5.0);
  EXPECT_EQ(record.manifest_text("outcome").rfind("stopped: ", 0), 0u);
}

}  // namespace
}  // namespace sprung::sph
