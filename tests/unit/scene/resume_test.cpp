/// A run that is stopped and resumed leaves the record of one that was never stopped, byte for
/// byte.

#include "scene/record.hpp"

#include "tests/unit/scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <csignal>

namespace sprung {
namespace {

namespace fs = std::filesystem;
using test::all_files;
using test::error_of;
using test::TemporaryFolder;

Manifest manifest() {
  Manifest manifest;
  manifest.solver = "sph";
  manifest.scene_title = "Oscillator";
  manifest.scene_file = "oscillator.toml";
  manifest.scene_toml = "title = \"Oscillator\"\n";
  return manifest;
}

/// A solver in small: an oscillator with a step that does not divide the times evenly.
struct Oscillator {
  double time = 0.0, x = 1.0, v = 0.0;
  std::int64_t step = 0;

  void advance() {
    const double dt = 0.1;
    v -= dt * x;
    x += dt * v;
    time += dt;
    ++step;
  }
  Archive archive() const {
    return {{"state", std::vector<double>{time, x, v}}, {"step", std::vector<std::int64_t>{step}}};
  }
  static Oscillator from(const Archive& archive) {
    const auto& state = std::get<std::vector<double>>(archive.at("state"));
    return {state[0], state[1], state[2],
            std::get<std::vector<std::int64_t>>(archive.at("step"))[0]};
  }
};

constexpr int last_step = 60;

/// Runs up to step `until`, with output of every kind and a checkpoint every 20 steps.
void run(RecordWriter& writer, Oscillator& oscillator, int until) {
  writer.declare_series("tip", {{"time", "s"}, {"displacement_x", "m"}});
  if (oscillator.step == 0)
    writer.append("tip", std::vector<double>{oscillator.time, oscillator.x});
  while (oscillator.step < until) {
    oscillator.advance();
    const std::vector<double> position{oscillator.x, 0, 0}, velocity{oscillator.v, 0};
    writer.append("tip", std::vector<double>{oscillator.time, oscillator.x});
    if (oscillator.step % 7 == 0)
      writer.write_table("profile", oscillator.time, {{"x", "m"}},
                         std::vector<double>{oscillator.x});
    if (oscillator.step % 6 == 0)
      writer.write_points(oscillator.time, position, {{"velocity", 2, velocity}});
    if (oscillator.step % 5 == 0) writer.flush();
    if (oscillator.step % 20 == 0) writer.checkpoint(oscillator.time, oscillator.archive());
  }
}

std::map<std::string, std::string> uninterrupted(const fs::path& folder) {
  RecordWriter writer(folder, manifest());
  Oscillator oscillator;
  run(writer, oscillator, last_step);
  writer.finish("finished");
  return all_files(folder);
}

void resume(const fs::path& folder) {
  const auto checkpoint = read_archive(folder / "checkpoint.h5");
  auto oscillator = Oscillator::from(checkpoint);
  const double time = std::get<std::vector<double>>(checkpoint.at("time")).at(0);
  EXPECT_EQ(time, oscillator.time);
  auto writer = RecordWriter::resume(folder, manifest(), time);
  run(writer, oscillator, last_step);
  writer.finish("finished");
}

void expect_same(std::map<std::string, std::string> resumed,
                 std::map<std::string, std::string> whole) {
  // Times, cost and resumptions stand in the manifest; everything else is the same.
  EXPECT_EQ(resumed.erase("manifest.json"), 1u);
  EXPECT_EQ(whole.erase("manifest.json"), 1u);
  std::vector<std::string> names, expected;
  for (const auto& [name, content] : resumed) names.push_back(name);
  for (const auto& [name, content] : whole) expected.push_back(name);
  ASSERT_EQ(names, expected);
  for (const auto& name : names)
    EXPECT_TRUE(resumed.at(name) == whole.at(name)) << name << " differs";
}

/// Starts a run in another process and has it stopped by `stop` (which does not return).
template <class Stop>
void run_in_child(const fs::path& folder, const Stop& stop) {
  const pid_t child = fork();
  if (child == 0) {
    RecordWriter writer(folder, manifest());
    Oscillator oscillator;
    stop(writer, oscillator);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
}

TEST(Resume, AfterAnOrderlyStop) {
  const TemporaryFolder whole, parts;
  const auto expected = uninterrupted(whole.path() / "run");
  {
    RecordWriter writer(parts.path() / "run", manifest());
    Oscillator oscillator;
    run(writer, oscillator, 38);  // 18 steps, three snapshots, two tables beyond the checkpoint
  }
  resume(parts.path() / "run");
  expect_same(all_files(parts.path() / "run"), expected);
}

TEST(Resume, AfterTheProcessWasKilled) {
  const TemporaryFolder whole, parts;
  const auto expected = uninterrupted(whole.path() / "run");
  run_in_child(parts.path() / "run", [](RecordWriter& writer, Oscillator& oscillator) {
    run(writer, oscillator, 53);
    kill(getpid(), SIGKILL);
  });
  resume(parts.path() / "run");
  expect_same(all_files(parts.path() / "run"), expected);
}

TEST(Resume, Twice) {
  const TemporaryFolder whole, parts;
  const auto expected = uninterrupted(whole.path() / "run");
  const auto place = parts.path() / "run";
  run_in_child(place, [](RecordWriter& writer, Oscillator& oscillator) {
    run(writer, oscillator, 24);
    kill(getpid(), SIGKILL);
  });
  {
    const auto checkpoint = read_archive(place / "checkpoint.h5");
    auto oscillator = Oscillator::from(checkpoint);
    auto writer = RecordWriter::resume(place, manifest(), oscillator.time);
    run(writer, oscillator, 45);
  }
  resume(place);
  expect_same(all_files(place), expected);
  const auto json = nlohmann::json::parse(RecordReader(place).manifest());
  ASSERT_EQ(json.at("resumed").size(), 2u);
  EXPECT_NEAR(json.at("resumed")[0].at("time").get<double>(), 2.0, 1e-12);
  EXPECT_NEAR(json.at("resumed")[1].at("time").get<double>(), 4.0, 1e-12);
}

// Killed at any moment, also in the middle of writing: what stands under a file's own name is
// whole.
TEST(Resume, KilledAtAnyMomentLeavesWholeFiles) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    const TemporaryFolder folder;
    const auto place = folder.path() / "run";
    const pid_t child = fork();
    if (child == 0) {
      RecordWriter writer(place, manifest());
      Oscillator oscillator;
      for (int until = 20;; until += 20) {
        run(writer, oscillator, until);
        writer.checkpoint(oscillator.time, oscillator.archive());
      }
    }
    while (!fs::exists(place / "checkpoint.h5")) usleep(1000);
    usleep(static_cast<useconds_t>(2000 + 3700 * attempt));
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    const auto oscillator = Oscillator::from(read_archive(place / "checkpoint.h5"));
    const RecordReader reader(place);
    EXPECT_GE(reader.series("tip").column("time").back(), oscillator.time);
    EXPECT_NO_THROW(RecordWriter::resume(place, manifest(), oscillator.time));
    for (const auto& [name, content] : all_files(place))
      EXPECT_FALSE(name.ends_with(".part")) << name;
  }
}

TEST(Resume, CostsAddUp) {
  const TemporaryFolder folder;
  {
    RecordWriter writer(folder.path(), manifest());
    writer.set_cost({{"pressure", 2.0}, {"springs", 1.0}});
    writer.checkpoint(1.0, {});
  }
  const RecordReader before(folder.path());
  auto again = manifest();
  auto writer = RecordWriter::resume(folder.path(), again, 1.0);
  writer.set_cost({{"springs", 0.5}, {"output", 0.25}});
  writer.finish("finished");
  const RecordReader after(folder.path());
  const std::vector<std::pair<std::string, double>> cost{
      {"pressure", 2.0}, {"springs", 1.5}, {"output", 0.25}};
  EXPECT_EQ(after.cost(), cost);
  EXPECT_GE(after.manifest_number("wall_seconds"), before.manifest_number("wall_seconds"));
  EXPECT_GE(after.manifest_number("processor_seconds"),
            before.manifest_number("processor_seconds"));
  EXPECT_EQ(after.manifest_text("start_time_utc"), before.manifest_text("start_time_utc"));
}

TEST(Resume, RefusesWhatWouldNotBeTheSameRun) {
  const TemporaryFolder folder;
  const auto place = folder.path() / "run";
  EXPECT_THROW(RecordWriter::resume(place, manifest(), 0.0), std::runtime_error);
  { RecordWriter(place, manifest()).checkpoint(1.0, {}); }
  const auto file = (place / "manifest.json").string();
  auto other = manifest();
  other.solver = "reference_fem";
  EXPECT_EQ(error_of([&] { RecordWriter::resume(place, other, 1.0); }),
            file + ": the record was made with another solver; resume it with that solver");
  other = manifest();
  other.scene_toml = "title = \"Another\"\n";
  EXPECT_EQ(error_of([&] { RecordWriter::resume(place, other, 1.0); }),
            file +
                ": the record was made with another scene_toml; resume it with the same scene and "
                "overrides, or start a new record");
  EXPECT_EQ(error_of([&] { RecordWriter::resume(place, manifest(), 2.0); }),
            (place / "record.h5").string() +
                ": reaches 1 s and cannot go on from the checkpoint at 2 s: rows would be missing; "
                "start the run anew");
  auto writer = RecordWriter::resume(place, manifest(), 1.0);
  EXPECT_EQ(RecordReader(place).manifest_text("outcome"), "running");
  writer.declare_series("tip", {{"time", "s"}, {"displacement_x", "m"}});
}

}  // namespace
}  // namespace sprung
