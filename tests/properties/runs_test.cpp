/// What must not change a result: the number of threads, a pause, a mirror, the units.

#include "scene/record.hpp"
#include "tests/properties/recorded_run.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

using sprung::test::TemporaryFolder;
using test::ChannelScene;
using test::expect_same_bytes;

Outcome run_scene(const ChannelScene& scene, const std::filesystem::path& out, int threads = 1,
                  double until = 0.0, bool resume = false) {
  return test::run_scene(scene.document(), out, threads, until, resume);
}

/// What went into the record is not all zero: the beam has moved.
void expect_moved(const std::filesystem::path& record) {
  const auto x = RecordReader(record).series("tip").column("displacement_x");
  EXPECT_GT(std::abs(x.back()), 1e-6);
}

TEST(Threads, OneAndTwoGiveTheSameBits) {
  for (const std::string preset : {"recommended", "paper"}) {
    const TemporaryFolder folder;
    ChannelScene scene;
    scene.preset = preset;
    if (preset == "paper") {
      scene.sph = "time_step = \"1e-4 s\"";  // far above its limit, but 60 steps do not blow up
      scene.end = 0.006;
      scene.probe_times = "\"0.003 s\", \"0.006 s\"";
    }
    ASSERT_EQ(run_scene(scene, folder.path() / "one", 1), Outcome::finished);
    ASSERT_EQ(run_scene(scene, folder.path() / "two", 2), Outcome::finished);
    expect_same_bytes(folder.path() / "one", folder.path() / "two");
    expect_moved(folder.path() / "one");
  }
}

TEST(Resume, APausedRunIsTheRunThatWasNeverStopped) {
  const TemporaryFolder folder;
  const ChannelScene scene;
  ASSERT_EQ(run_scene(scene, folder.path() / "whole"), Outcome::finished);
  // At a probe's time, between two probes' times, and twice.
  ASSERT_EQ(run_scene(scene, folder.path() / "at", 1, 0.02), Outcome::paused);
  ASSERT_EQ(run_scene(scene, folder.path() / "at", 1, 0.0, true), Outcome::finished);
  expect_same_bytes(folder.path() / "whole", folder.path() / "at");
  ASSERT_EQ(run_scene(scene, folder.path() / "between", 1, 0.0137), Outcome::paused);
  ASSERT_EQ(run_scene(scene, folder.path() / "between", 1, 0.0291, true), Outcome::paused);
  ASSERT_EQ(run_scene(scene, folder.path() / "between", 1, 0.0, true), Outcome::finished);
  expect_same_bytes(folder.path() / "whole", folder.path() / "between");
  expect_moved(folder.path() / "whole");
}

TEST(Resume, HoldsForThePrintedSchemeToo) {
  const TemporaryFolder folder;
  ChannelScene scene;
  scene.preset = "paper";
  scene.sph = "time_step = \"1e-4 s\"";
  scene.end = 0.006;
  scene.probe_times = "\"0.003 s\", \"0.006 s\"";
  ASSERT_EQ(run_scene(scene, folder.path() / "whole"), Outcome::finished);
  ASSERT_EQ(run_scene(scene, folder.path() / "paused", 1, 0.0041), Outcome::paused);
  ASSERT_EQ(run_scene(scene, folder.path() / "paused", 2, 0.0, true), Outcome::finished);
  expect_same_bytes(folder.path() / "whole", folder.path() / "paused");
}

TEST(Record, HoldsTheStateAtTimeZeroWhereItIsAskedFor) {
  const TemporaryFolder folder;
  ChannelScene scene;
  scene.end = 0.004;
  scene.probe_times = "\"0 s\", \"0.004 s\"";
  ASSERT_EQ(run_scene(scene, folder.path() / "out"), Outcome::finished);
  const RecordReader record(folder.path() / "out");
  EXPECT_EQ(record.table_times("profile"), (std::vector<double>{0.0, 0.004}));
  EXPECT_EQ(record.table_times("outline"), (std::vector<double>{0.0, 0.004}));
  for (const double u : record.table("profile", 0.0).column("velocity_x")) EXPECT_EQ(u, 0.0);
}

/// A scene whose lengths are whole multiples of 2^-6 m: the lattice and its mirror image are exact.
ChannelScene dyadic() {
  ChannelScene scene;
  scene.spacing = 0.015625;
  scene.length = 60 * scene.spacing;
  scene.height = 20 * scene.spacing;
  scene.y_low = -10 * scene.spacing;
  scene.beam_x = 20 * scene.spacing;
  scene.beam_width = 4 * scene.spacing;
  scene.beam_height = 7 * scene.spacing;
  scene.probe_x = 28 * scene.spacing;
  scene.ramp = 0.125;
  scene.end = 0.0625;
  scene.probe_times = "\"0.03125 s\", \"0.0625 s\"";
  return scene;
}

// Sums run in another order and the coarse cells of the pressure solver lie otherwise, so equality
// holds up to round-off as it grows over the 15 steps, and up to the solver's tolerance, set to
// 1e-13 here. An error in one wall or clamp would show at the size of the displacement itself.
TEST(Mirror, ABeamOnTheUpperWallMovesAsOneOnTheLower) {
  const TemporaryFolder folder;
  ChannelScene scene = dyadic();
  scene.numerics = "pressure_tolerance = 1e-13";
  ASSERT_EQ(run_scene(scene, folder.path() / "below"), Outcome::finished);
  scene.beam_on_top = true;
  ASSERT_EQ(run_scene(scene, folder.path() / "above"), Outcome::finished);
  const RecordReader below(folder.path() / "below"), above(folder.path() / "above");
  const double tolerance = 1e-7;
  for (const auto& [probe, quantity] : {std::pair{"tip", "displacement"}, {"force", "force"}}) {
    const std::string name = quantity;
    const auto x = below.series(probe).column(name + "_x"),
               y = below.series(probe).column(name + "_y");
    const auto mirrored_x = above.series(probe).column(name + "_x");
    const auto mirrored_y = above.series(probe).column(name + "_y");
    ASSERT_EQ(x.size(), mirrored_x.size());
    double size = 0.0;
    for (std::size_t k = 0; k < x.size(); ++k) size = std::max(size, std::abs(x[k]));
    EXPECT_GT(size, 1e-6);
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_NEAR(x[k], mirrored_x[k], tolerance * size) << probe << ' ' << k;
      EXPECT_NEAR(y[k], -mirrored_y[k], tolerance * size) << probe << ' ' << k;
    }
  }
  const auto u = below.table("profile", 0.0625).column("velocity_x");
  const auto mirrored = above.table("profile", 0.0625).column("velocity_x");
  ASSERT_EQ(u.size(), mirrored.size());
  for (std::size_t k = 0; k < u.size(); ++k)
    EXPECT_NEAR(u[k], mirrored[u.size() - 1 - k], tolerance * scene.mean_velocity);
}

// Lengths x 4, times x 2, masses (per volume) x 8: every number of the run is multiplied by a power
// of two, which rounds nothing, so the results are the same to the last bit. Velocity x 2,
// viscosity x 64 and modulus x 32 (rho L^2/T and rho L^2/T^2).
TEST(Units, PowersOfTwoChangeNoBit) {
  const TemporaryFolder folder;
  const ChannelScene scene = dyadic();
  ChannelScene scaled = scene;
  for (double* length : {&scaled.spacing, &scaled.length, &scaled.height, &scaled.y_low,
                         &scaled.beam_x, &scaled.beam_width, &scaled.beam_height, &scaled.probe_x})
    *length *= 4.0;
  scaled.density *= 8.0;
  scaled.viscosity *= 64.0;
  scaled.youngs_modulus *= 32.0;
  scaled.mean_velocity *= 2.0;
  scaled.ramp *= 2.0;
  scaled.end *= 2.0;
  scaled.probe_times = "\"0.0625 s\", \"0.125 s\"";
  ASSERT_EQ(run_scene(scene, folder.path() / "small"), Outcome::finished);
  ASSERT_EQ(run_scene(scaled, folder.path() / "large"), Outcome::finished);
  const RecordReader small(folder.path() / "small"), large(folder.path() / "large");
  const auto compare = [&](const std::string& series, const std::string& column, double factor) {
    const auto a = small.series(series).column(column), b = large.series(series).column(column);
    ASSERT_EQ(a.size(), b.size()) << series;
    for (std::size_t k = 0; k < a.size(); ++k)
      ASSERT_EQ(factor * a[k], b[k]) << series << ' ' << column << ' ' << k;
  };
  compare("tip", "time", 2.0);
  compare("tip", "displacement_x", 4.0);
  compare("tip", "displacement_y", 4.0);
  compare("force", "force_x", 8.0 * 4.0 * 4.0);  // rho U^2 L
  compare("ledger_mass", "excess_outflow", 16.0);
  compare("ledger_energy", "kinetic_fluid", 8.0 * 4.0 * 16.0);
  compare("ledger_energy", "elastic", 8.0 * 4.0 * 16.0);
  compare("ledger_divergence", "rms_divergence", 0.5);
  compare("ledger_divergence", "pressure_iterations", 1.0);
  expect_moved(folder.path() / "small");
}

}  // namespace
}  // namespace sprung::sph
