/// Whole runs on a coarse mesh: the same bits for one and two threads and after a resume; refusals.

#include "reference_fem/convergence.hpp"
#include "reference_fem/simulation.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include <unistd.h>

namespace sprung::reference {
namespace {

namespace fs = std::filesystem;

const char* const scene_text = R"(
title = "Beam, coarse and short"
source = "a test"
[domain]
channel = { from = ["0 m", "0 m"], to = ["0.9 m", "0.3 m"] }
[time]
end = "0.1 s"
[fluid]
density = "1000 kg/m3"
[viscosity]
dynamic = "1 Pa s"
[walls]
no_slip = ["bottom", "top"]
[inflow]
side = "left"
profile = "parabolic"
mean_velocity = "0.5 m/s"
ramp = "RAMP"
[outflow]
side = "right"
pressure = "0 Pa"
[solid.beam]
body = { from = ["0.3 m", "0 m"], to = ["0.315 m", "0.1 m"] }
youngs_modulus = "0.7 MPa"
clamped = "bottom"
[probes.tip]
displacement_of = ["0.3075 m", "0.1 m"]
[probes.profile]
velocity_along = { from = ["0.4 m", "0 m"], to = ["0.4 m", "0.3 m"], points = 11 }
times = ["0.05 s", "0.1 s"]
[probes.force]
force_on = "beam"
[reference_fem]
cell_size = "60 mm"
splittings = 0
checkpoint_every = "0.04 s"
time_step = "5 ms"
)";

std::string text_with(const std::string& ramp) {
  std::string text = scene_text;
  return text.replace(text.find("RAMP"), 4, ramp);
}

class Run : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("sprung_reference_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Runs the scene into folder_/name.
  Outcome go(const std::string& name, RunOptions options = {}, const std::string& ramp = "0.06 s",
             const std::vector<std::string>& overrides = {}) {
    Document document = Document::from_text(text_with(ramp), "scene", overrides);
    const Problem problem = read_problem(document);
    const Settings settings = read_settings(document, problem);
    document.refuse_unread();
    options.out = folder_ / name;
    return run(document, problem, settings, options);
  }
  std::vector<double> series(const std::string& name, const std::string& which) const {
    return RecordReader(folder_ / name).series(which).values;
  }
  fs::path folder_;
};

TEST_F(Run, BitsDoNotDependOnThreadsOrOnAResume) {
  RunOptions two;
  two.threads = 2;
  EXPECT_EQ(go("one"), Outcome::finished);
  EXPECT_EQ(go("two", two), Outcome::finished);
  RunOptions until;
  until.until = 0.03;  // between two steps: the pause is at the checkpoint after it, 0.04 s
  EXPECT_EQ(go("parts", until), Outcome::paused);
  RunOptions rest;
  rest.resume = true;
  EXPECT_EQ(go("parts", rest), Outcome::finished);
  for (const auto* which : {"tip", "force", "ledger_mass", "ledger_energy", "ledger_solid"}) {
    EXPECT_EQ(series("one", which), series("two", which)) << which;
    EXPECT_EQ(series("one", which), series("parts", which)) << which;
  }
  EXPECT_EQ(RecordReader(folder_ / "one").table("profile", 0.1).values,
            RecordReader(folder_ / "parts").table("profile", 0.1).values);
}

/// Sends SIGTERM to this process once `file` is there.
std::thread stop_when_there(const fs::path& file) {
  return std::thread([file] {
    while (!fs::exists(file)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(getpid(), SIGTERM);
  });
}

TEST_F(Run, ASignalLeavesARecordThatSaysSoAndGoesOnBitForBit) {
  // Long enough to be under way still when the signal comes, after the first checkpoint, 0.04 s.
  const std::vector<std::string> longer = {"time.end=0.4 s"};
  EXPECT_EQ(go("whole", {}, "0.06 s", longer), Outcome::finished);
  std::thread other = stop_when_there(folder_ / "parts" / "checkpoint.h5");
  EXPECT_THROW(go("parts", {}, "0.06 s", longer), RunInterrupted);
  other.join();
  const RecordReader stopped(folder_ / "parts");
  EXPECT_NE(stopped.manifest_text("outcome").find("stopped by SIGTERM at t = "), std::string::npos)
      << stopped.manifest_text("outcome");
  EXPECT_LT(stopped.series("tip").rows(), RecordReader(folder_ / "whole").series("tip").rows());
  RunOptions rest;
  rest.resume = true;
  EXPECT_EQ(go("parts", rest, "0.06 s", longer), Outcome::finished);
  for (const auto* which : {"tip", "force", "ledger_energy"})
    EXPECT_EQ(series("whole", which), series("parts", which)) << which;
}

TEST_F(Run, KeepsItsBalances) {
  go("run", {}, "1 s");
  const RecordReader record(folder_ / "run");
  // Mass: the space conserves it cell by cell; what is left is the beam's volume between the steps'
  // ends.
  EXPECT_LT(std::abs(record.series("ledger_mass").column("excess_outflow").back()), 1e-7 * 0.27);
  for (const double ratio : record.series("ledger_solid").column("area_ratio"))
    EXPECT_NEAR(ratio, 1.0, 1e-5);
  // Energy: the equations balance exactly in space, so only the steps err, by their square.
  const auto work = record.series("ledger_energy").column("work");
  EXPECT_NEAR(record.series("ledger_energy").column("imbalance").back(), 0.0, 0.001 * work.back());
  EXPECT_GT(record.series("tip").column("displacement_x").back(), 1e-3);
  EXPECT_GT(record.series("force").column("force_x").back(), 1.0);
}

TEST_F(Run, SaysWhereAndWhenACellTurnsInsideOut) {
  // A beam of jelly in a full stream: it is laid flat, and the mesh cannot follow.
  Document document = Document::from_text(text_with("0 s"), "scene",
                                          {"solid.beam.youngs_modulus=0.1 kPa", "time.end=2 s"});
  const Problem problem = read_problem(document);
  const Settings settings = read_settings(document, problem);
  RunOptions options;
  options.out = folder_ / "run";
  try {
    run(document, problem, settings, options);
    FAIL() << "the run finished";
  } catch (const RunStopped& stopped) {
    const std::string what = stopped.what();
    EXPECT_NE(what.find("stopped after t = "), std::string::npos) << what;
    EXPECT_NE(what.find("turned inside out near x = "), std::string::npos) << what;
    EXPECT_NE(what.find("reference_fem.mesh_stiffening"), std::string::npos) << what;
  }
  // The record is whole up to there, and says the same.
  const RecordReader record(folder_ / "run");
  EXPECT_GT(record.series("tip").column("time").size(), 2U);
}

TEST(Extrapolation, FindsLimitAndOrderOfAPower) {
  // f(h) = 3 + 0.5 h^2 at h = 0.4, 0.2, 0.1.
  const Extrapolation e = extrapolate(3.08, 3.02, 3.005, 3.0);
  EXPECT_NEAR(*e.observed_order, 2.0, 1e-12);
  EXPECT_NEAR(e.limit, 3.0, 1e-12);
  EXPECT_NEAR(e.error_of_middle, 1.25 * 0.02, 1e-12);
  EXPECT_NEAR(e.index_of_finest, 1.25 * 0.005, 1e-12);
}

TEST(Extrapolation, DistrustsValuesWithoutOrder) {
  const Extrapolation e = extrapolate(1.0, 1.1, 1.05, 3.0);
  EXPECT_FALSE(e.observed_order);
  EXPECT_EQ(e.limit, 1.05);
  EXPECT_NEAR(e.error_of_middle, 1.25 * 2.0 * 0.05, 1e-12);
}

/// The message with which a scene is refused that has `line` in its table [reference_fem].
std::string refusal(const std::string& line) {
  try {
    Document document = Document::from_text(text_with("1 s") + line + "\n", "beam.toml");
    const Problem problem = read_problem(document);
    read_settings(document, problem);
    document.refuse_unread();
  } catch (const SceneError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Settings, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(refusal("degree = 2"), "accepted");
  EXPECT_NE(refusal("degree = 5").find("must be 2 or 3"), std::string::npos);
  EXPECT_NE(refusal("poisson_ratio = 0.6").find("beyond 0.5"), std::string::npos);
  EXPECT_NE(refusal("face_size = \"1 s\"").find("beam.toml"), std::string::npos);
  EXPECT_NE(refusal("time_scheme = \"tr_bdf\"").find("tr_bdf2"), std::string::npos);
  EXPECT_NE(refusal("corner_size = \"1 mm\"").find("corner_size"), std::string::npos);
}

}  // namespace
}  // namespace sprung::reference
