/// What must not change a result, on scenes of fluid alone: a periodic vortex, a cavity with a
/// moving lid, a channel between two pressures, a channel with a cylinder.

#include "scene/record.hpp"
#include "tests/properties/recorded_run.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace sprung::sph {
namespace {

using sprung::test::TemporaryFolder;
using test::expect_same_bytes;

/// A box of a by b (m), spacing 2^-5 m: the lattice and its mirror image are exact.
std::string head(double a, double b, double end) {
  return fmt::format(
      "title = \"t\"\n[domain]\nchannel = {{ from = [\"0 m\", \"{} m\"], to = [\"{} m\", \"{} m\"] "
      "}}\n[time]\nend = \"{} s\"\n[fluid]\ndensity = \"1000 kg/m3\"\n",
      -0.5 * b, a, 0.5 * b, end);
}

std::string tail(double end, double x, double half_height, const std::string& sph = "",
                 const std::string& numerics = "") {
  return fmt::format(
      "[probes.profile]\nvelocity_along = {{ from = [\"{0} m\", \"{1} m\"], to = [\"{0} m\", \"{2} "
      "m\"], points = 17 }}\ntimes = [\"{3} s\", \"{4} s\"]\n[record]\nfields_every = \"{3} "
      "s\"\n[sph]\nspacing = \"31.25 mm\"\n{5}\n[numerics]\n{6}\n",
      x, -half_height, half_height, 0.5 * end, end, sph, numerics);
}

std::string taylor_green(const std::string& numerics = "") {
  return head(0.625, 0.625, 0.4) +
         "[viscosity]\ndynamic = \"1 Pa s\"\n[periodic]\naxes = [\"x\", "
         "\"y\"]\n[initial]\nvelocity "
         "= [\"sin(2*pi*x/0.625)*cos(2*pi*y/0.625)\", "
         "\"-cos(2*pi*x/0.625)*sin(2*pi*y/0.625)\"]\n" +
         tail(0.4, 0.25, 0.3, "", numerics);
}

std::string cavity(const std::string& numerics = "") {
  return head(0.625, 0.625, 0.3) +
         "[viscosity]\ndynamic = \"10 Pa s\"\n[walls]\nno_slip = [\"left\", \"right\", \"bottom\", "
         "\"top\"]\n[wall_motion.top]\nvelocity = [\"1 m/s\", \"0 m/s\"]\nwaveform = { formula = "
         "\"min(t/0.1, 1)\" }\n" +
         tail(0.3, 0.25, 0.3, "", numerics);
}

std::string pressure_channel(double offset = 0.0, const std::string& numerics = "") {
  return head(0.75, 0.5, 0.6) +
         fmt::format(
             "[viscosity]\ndynamic = \"10 Pa s\"\n[walls]\nno_slip = [\"bottom\", \"top\"]\n"
             "[inflow]\nside = \"left\"\npressure = \"{} Pa\"\n[outflow]\nside = "
             "\"right\"\npressure = \"{} Pa\"\n[probes.p]\npressure_at = [[\"0.2 m\", \"0.1 "
             "m\"]]\n",
             offset + 400.0, offset) +
         tail(0.6, 0.375, 0.25, "velocity_scale = \"0.5 m/s\"", numerics);
}

/// `middle`: height of the cylinder's centre above the channel's middle.
std::string cylinder(double middle = 0.015625, const std::string& numerics = "") {
  return head(1.0, 0.5, 0.15) +
         fmt::format(
             "[viscosity]\ndynamic = \"10 Pa s\"\n[walls]\nno_slip = [\"bottom\", "
             "\"top\"]\n[inflow]\nside = \"left\"\nprofile = \"parabolic\"\nmean_velocity = \"0.5 "
             "m/s\"\nramp = \"0.1 s\"\n[outflow]\nside = \"right\"\npressure = \"0 Pa\"\n"
             "[curved_wall.cylinder]\ncircle = {{ centre = [\"0.34375 m\", \"{} m\"], radius = "
             "\"0.085 "
             "m\" }}\nfluid = \"outside\"\nslip = \"no_slip\"\n[probes.drag]\nforce_on = "
             "\"cylinder\"\n",
             middle) +
         tail(0.15, 0.625, 0.25, "", numerics);
}

Outcome run_scene(const std::string& scene, const std::filesystem::path& out, int threads = 1,
                  double until = 0.0, bool resume = false) {
  return test::run_scene(Document::from_text(scene, "s.toml"), out, threads, until, resume);
}

double largest(const std::vector<double>& values) {
  double size = 0.0;
  for (const double v : values) size = std::max(size, std::abs(v));
  return size;
}

struct Scene {
  const char* name;
  std::string text;
  double pause;  ///< between two steps, neither a probe's time
};

void PrintTo(const Scene& scene, std::ostream* out) {
  *out << scene.name;
}

class FluidRun : public testing::TestWithParam<Scene> {};

TEST_P(FluidRun, HasTheSameBitsForOneAndTwoThreadsAndAfterAPause) {
  const TemporaryFolder folder;
  const Scene& scene = GetParam();
  ASSERT_EQ(run_scene(scene.text, folder.path() / "one", 1), Outcome::finished);
  ASSERT_EQ(run_scene(scene.text, folder.path() / "two", 2), Outcome::finished);
  expect_same_bytes(folder.path() / "one", folder.path() / "two");
  ASSERT_EQ(run_scene(scene.text, folder.path() / "paused", 1, scene.pause), Outcome::paused);
  ASSERT_EQ(run_scene(scene.text, folder.path() / "paused", 2, 0.0, true), Outcome::finished);
  expect_same_bytes(folder.path() / "one", folder.path() / "paused");
  const RecordReader record(folder.path() / "one");
  EXPECT_GT(
      largest(record.table("profile", record.table_times("profile").back()).column("velocity_x")),
      0.01);
}

INSTANTIATE_TEST_SUITE_P(Scenes, FluidRun,
                         testing::Values(Scene{"taylor_green", taylor_green(), 0.23},
                                         Scene{"cavity", cavity(), 0.17},
                                         Scene{"pressure_channel", pressure_channel(), 0.31},
                                         Scene{"cylinder", cylinder(), 0.09}),
                         [](const auto& info) { return std::string(info.param.name); });

// With both pressures raised by 1 bar the flow is the same to round-off: psi = p/rho of 100 m2/s2
// is off by 1e-14, and a gradient over 31 mm and 0.6 s makes 1e-12 m/s of it, which disorder
// multiplies over the steps. The limit is 1e-7 of the flow.
TEST(PressureOffset, ChangesNothing) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_scene(pressure_channel(), folder.path() / "low"), Outcome::finished);
  ASSERT_EQ(run_scene(pressure_channel(1e5), folder.path() / "high"), Outcome::finished);
  const RecordReader low(folder.path() / "low"), high(folder.path() / "high");
  const auto u = low.table("profile", 0.6).column("velocity_x");
  const auto v = high.table("profile", 0.6).column("velocity_x");
  ASSERT_EQ(u.size(), v.size());
  const double size = largest(u);
  EXPECT_GT(size, 0.05);
  for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(u[k], v[k], 1e-7 * size) << k;
  const auto p = low.series("p").column("pressure_0"), q = high.series("p").column("pressure_0");
  ASSERT_EQ(p.size(), q.size());
  for (std::size_t k = 0; k < p.size(); ++k) EXPECT_NEAR(p[k] + 1e5, q[k], 1e-4) << k;
}

/// The profile upside down: u(y) = u'(-y), v(y) = -v'(-y).
void expect_mirrored(const RecordReader& one, const RecordReader& other, double time,
                     double tolerance) {
  for (const auto& [column, sign] : {std::pair{"velocity_x", 1.0}, {"velocity_y", -1.0}}) {
    const auto u = one.table("profile", time).column(column);
    const auto v = other.table("profile", time).column(column);
    ASSERT_EQ(u.size(), v.size());
    EXPECT_GT(largest(u), 1e3 * tolerance) << column;
    for (std::size_t k = 0; k < u.size(); ++k)
      EXPECT_NEAR(u[k], sign * v[u.size() - 1 - k], tolerance) << column << ' ' << k;
  }
}

const std::string tight = "pressure_tolerance = 1e-13";

// Sums run in another order, so equality holds to round-off as it grows over the run.
TEST(Mirror, ACylinderBelowTheMiddleIsOneAboveUpsideDown) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_scene(cylinder(0.015625, tight), folder.path() / "above"), Outcome::finished);
  ASSERT_EQ(run_scene(cylinder(-0.015625, tight), folder.path() / "below"), Outcome::finished);
  const RecordReader above(folder.path() / "above"), below(folder.path() / "below");
  expect_mirrored(above, below, 0.15, 1e-7);
  const auto drag = above.series("drag").column("force_x"),
             same = below.series("drag").column("force_x");
  const auto lift = above.series("drag").column("force_y"),
             opposite = below.series("drag").column("force_y");
  ASSERT_EQ(drag.size(), same.size());
  const double size = largest(drag);
  EXPECT_GT(drag.back(), 1.0);
  EXPECT_GT(largest(lift), 1e-3 * size);
  for (std::size_t k = 0; k < drag.size(); ++k) {
    EXPECT_NEAR(drag[k], same[k], 1e-6 * size) << k;
    EXPECT_NEAR(lift[k], -opposite[k], 1e-6 * size) << k;
  }
}

TEST(Mirror, ALidBelowMovesTheCavityUpsideDown) {
  const TemporaryFolder folder;
  // Enclosed, so that pressure is known up to a constant, and at rest at first: the tolerance is of
  // a source that is round-off.
  const std::string above = cavity("pressure_tolerance = 1e-10");
  std::string below = above;
  below.replace(below.find("wall_motion.top"), 15, "wall_motion.bottom");
  ASSERT_EQ(run_scene(above, folder.path() / "above"), Outcome::finished);
  ASSERT_EQ(run_scene(below, folder.path() / "below"), Outcome::finished);
  expect_mirrored(RecordReader(folder.path() / "above"), RecordReader(folder.path() / "below"), 0.3,
                  1e-6);
}

// The pressures exchanged, the flow runs the other way: the mirror image in the channel's middle.
TEST(Mirror, PressuresExchangedTurnTheFlowRound) {
  const TemporaryFolder folder;
  const std::string forward = pressure_channel(0.0, tight);
  std::string backward = forward;
  const auto left = backward.find("\"400 Pa\""), right = backward.find("\"0 Pa\"");
  ASSERT_LT(left, right);
  backward.replace(right, 6, "\"400 Pa\"").replace(left, 8, "\"0 Pa\"");
  ASSERT_EQ(run_scene(forward, folder.path() / "forward"), Outcome::finished);
  ASSERT_EQ(run_scene(backward, folder.path() / "backward"), Outcome::finished);
  const RecordReader one(folder.path() / "forward"), two(folder.path() / "backward");
  const auto u = one.table("profile", 0.6).column("velocity_x");
  const auto v = two.table("profile", 0.6).column("velocity_x");
  const double size = largest(u);
  EXPECT_GT(size, 0.05);
  for (std::size_t k = 0; k < u.size(); ++k) EXPECT_NEAR(u[k], -v[k], 1e-6 * size) << k;
}

}  // namespace
}  // namespace sprung::sph
