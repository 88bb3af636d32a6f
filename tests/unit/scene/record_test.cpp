/// Records: written, read back, and what is refused.

#include "scene/record.hpp"

#include "scene/progress.hpp"
#include "tests/unit/scene/temporary_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <csignal>
#include <limits>

namespace sprung {
namespace {

namespace fs = std::filesystem;
using test::all_files;
using test::bytes;
using test::error_of;
using test::TemporaryFolder;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Manifest manifest() {
  Manifest manifest;
  manifest.solver = "sph";
  manifest.scene_title = "Beam";
  manifest.scene_file = "beam.toml";
  manifest.scene_toml = "title = \"Beam\"\n";
  manifest.threads = 2;
  manifest.libraries = {{"Eigen", "3.4.0"}};
  manifest.numbers = {{"particles", 19200}};
  manifest.notes = {{"preset", "paper"}};
  return manifest;
}

const std::vector<Column> tip{{"time", "s"}, {"displacement_x", "m"}, {"displacement_y", "m"}};
const std::vector<Column> profile{{"x", "m"}, {"y", "m"}};
const std::vector<double> triangle{0, 0, 0, 1, 0, 0, 0, 1, 0};

void append(RecordWriter& writer, const std::string& series, const std::vector<double>& row) {
  writer.append(series, row);
}

// --- archives -----------------------------------------------------------------------------------

TEST(Archive, RoundTripsEveryBit) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.h5";
  const std::vector<double> doubles{0.1,       -0.0, 5e-324,  1.7976931348623157e308,
                                    1.0 / 3.0, nan,  infinity};
  const Archive written{{"doubles", doubles},
                        {"integers", std::vector<std::int64_t>{0, -1, INT64_MAX, INT64_MIN}},
                        {"particles/position", std::vector<double>{1, 2, 3}},
                        {"empty", std::vector<double>{}},
                        {"no_integers", std::vector<std::int64_t>{}}};
  write_archive(file, written);
  const auto read = read_archive(file);
  ASSERT_EQ(read.size(), written.size());
  const auto& back = std::get<std::vector<double>>(read.at("doubles"));
  ASSERT_EQ(back.size(), doubles.size());
  for (std::size_t i = 0; i < doubles.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back[i]), std::bit_cast<std::uint64_t>(doubles[i])) << i;
  for (const auto* name : {"integers", "particles/position", "empty", "no_integers"})
    EXPECT_EQ(read.at(name), written.at(name)) << name;
}

TEST(Archive, SameContentSameBytes) {
  const TemporaryFolder folder;
  const Archive archive{{"x", std::vector<double>{1, 2}}, {"n/m", std::vector<std::int64_t>{3}}};
  write_archive(folder.path() / "a.h5", archive);
  write_archive(folder.path() / "b.h5", archive);
  EXPECT_EQ(bytes(folder.path() / "a.h5"), bytes(folder.path() / "b.h5"));
}

TEST(Archive, MissingAndDamagedFilesAreNamed) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.h5";
  EXPECT_EQ(error_of([&] { read_archive(file); }), file.string() + ": is missing");
  std::ofstream(file) << "not HDF5";
  EXPECT_EQ(error_of([&] { read_archive(file); }),
            file.string() + ": is damaged, or not an HDF5 file");
  write_archive(file, {{"x", std::vector<double>(1000, 1.5)}});
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_EQ(error_of([&] { read_archive(file); }),
            file.string() + ": is damaged, or not an HDF5 file");
}

// Writing fails half-way (a file size limit stands in for a full disk): the old file stays, and
// nothing else appears.
TEST(Archive, FullDiskLeavesTheOldFile) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.h5";
  write_archive(file, {{"x", std::vector<double>{1.5}}});
  const auto before = bytes(file);
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100000, 100000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const auto error = error_of([&] {
      write_archive(file, {{"x", std::vector<double>(1000000, 2.5)}});
    });
    const auto expected = file.string() + ": cannot be written";
    _exit(error.starts_with(expected) && all_files(folder.path()).size() == 1 ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_EQ(bytes(file), before);
  EXPECT_EQ(all_files(folder.path()).size(), 1u);
}

// --- what is written is read back ---------------------------------------------------------------

TEST(Record, SeriesAndTablesReadBack) {
  const TemporaryFolder folder;
  {
    RecordWriter writer(folder.path() / "run", manifest());
    EXPECT_EQ(writer.folder(), folder.path() / "run");
    writer.declare_series("tip", tip);
    writer.declare_series("empty", {{"time", "s"}, {"force_x", "N/m"}});
    append(writer, "tip", {0, 0, 0});
    append(writer, "tip", {0.1, 1.0 / 3.0, -1e-17});
    writer.write_table("profile", 0.2, profile, std::vector<double>{0.4, 0, 0.4, 0.3});
    writer.write_table("profile", 3.0, profile, std::vector<double>{0.4, 0.1});
    writer.finish("finished");
  }
  const RecordReader reader(folder.path() / "run");
  EXPECT_TRUE(reader.has_series("tip"));
  EXPECT_FALSE(reader.has_series("top"));
  const auto& series = reader.series("tip");
  EXPECT_EQ(series.rows(), 2u);
  EXPECT_EQ(series.columns[1].unit, "m");
  EXPECT_EQ(series.column("time"), (std::vector<double>{0, 0.1}));
  EXPECT_EQ(series.column("displacement_x"), (std::vector<double>{0, 1.0 / 3.0}));
  EXPECT_EQ(series.column("displacement_y"), (std::vector<double>{0, -1e-17}));
  EXPECT_EQ(reader.series("empty").rows(), 0u);
  EXPECT_EQ(reader.table_times("profile"), (std::vector<double>{0.2, 3.0}));
  EXPECT_EQ(reader.table("profile", 0.2).column("y"), (std::vector<double>{0, 0.3}));
  EXPECT_EQ(reader.table("profile", 0.2 + 1e-15).rows(), 2u);  // rounding of a time step's sum
  EXPECT_EQ(reader.table("profile", 3.0).rows(), 1u);
  const auto file = (folder.path() / "run" / "record.h5").string();
  EXPECT_EQ(error_of([&] { reader.series("top"); }),
            file + ": no series top; there are empty and tip");
  EXPECT_EQ(error_of([&] { reader.table_times("top"); }),
            file + ": no table top; there are profile");
  EXPECT_EQ(error_of([&] { reader.table("profile", 0.3); }),
            file + ": no table profile at 0.3 s; there are those at 0.2 and 3 s");
  EXPECT_EQ(error_of([&] { series.column("force"); }),
            "no column force; there are time, displacement_x and displacement_y");
}

TEST(Record, CsvHasUnitsAndSeventeenDigits) {
  const TemporaryFolder folder;
  RecordWriter writer(folder.path(), manifest());
  writer.declare_series("tip", tip);
  append(writer, "tip", {0.1, 1.0 / 3.0, -2});
  writer.write_table("profile", 0.2, profile, std::vector<double>{0.4, 0, 0.4, 1e-20});
  writer.write_table("profile", 1, profile, std::vector<double>{1, 2});
  writer.flush();
  EXPECT_EQ(bytes(folder.path() / "probes" / "tip.csv"),
            "time [s],displacement_x [m],displacement_y [m]\n"
            "0.10000000000000001,0.33333333333333331,-2\n");
  EXPECT_EQ(bytes(folder.path() / "probes" / "profile_t0.2.csv"),
            "x [m],y [m]\n0.40000000000000002,0\n0.40000000000000002,9.9999999999999995e-21\n");
  EXPECT_EQ(bytes(folder.path() / "probes" / "profile_t1.csv"), "x [m],y [m]\n1,2\n");
}

TEST(Record, ManifestTellsWhatWasRunAndHow) {
  const TemporaryFolder folder;
  {
    RecordWriter writer(folder.path(), manifest());
    writer.set_number("unknowns", 29200);
    writer.set_note("step", "new velocity");
    writer.set_cost({{"ACTION 6 pressure", 1.5}, {"ACTION 3 neighbours", 0.5}});
    writer.finish("finished");
  }
  const RecordReader reader(folder.path());
  EXPECT_EQ(reader.manifest_text("solver"), "sph");
  EXPECT_EQ(reader.manifest_text("scene_title"), "Beam");
  EXPECT_EQ(reader.manifest_text("scene_file"), "beam.toml");
  EXPECT_EQ(reader.manifest_text("scene_toml"), "title = \"Beam\"\n");
  EXPECT_EQ(reader.manifest_text("outcome"), "finished");
  EXPECT_EQ(reader.manifest_text("preset"), "paper");
  EXPECT_EQ(reader.manifest_text("step"), "new velocity");
  EXPECT_EQ(reader.manifest_number("unknowns"), 29200);
  EXPECT_EQ(reader.manifest_number("particles"), 19200);
  EXPECT_EQ(reader.manifest_number("threads"), 2);
  EXPECT_GE(reader.manifest_number("cores"), 1);
  EXPECT_GT(reader.manifest_number("peak_memory_bytes"), 1e6);
  // The clocks run with this process, and the record was written within it.
  EXPECT_GT(reader.manifest_number("processor_seconds"), 0.0);
  EXPECT_LE(reader.manifest_number("processor_seconds"), processor_seconds());
  EXPECT_LE(reader.manifest_number("wall_seconds"), wall_seconds());
  const std::vector<std::pair<std::string, double>> cost{{"ACTION 6 pressure", 1.5},
                                                         {"ACTION 3 neighbours", 0.5}};
  EXPECT_EQ(reader.cost(), cost);  // in the order given, not sorted
  EXPECT_TRUE(reader.manifest_text("compiler").starts_with("GNU ") ||
              reader.manifest_text("compiler").starts_with("Clang "));
  EXPECT_FALSE(reader.manifest_text("processor").empty());
  const auto clean = reader.manifest_text("clean");
  EXPECT_TRUE(clean == "yes" || clean == "no" || clean == "unknown") << clean;
  const auto commit = reader.manifest_text("commit");
  EXPECT_TRUE(commit == "unknown" || commit.size() == 40) << commit;
  const auto json = nlohmann::json::parse(reader.manifest());
  EXPECT_EQ(json.at("libraries").at("Eigen"), "3.4.0");
  EXPECT_TRUE(json.at("libraries").contains("HDF5"));
  EXPECT_TRUE(json.at("start_time_utc").get<std::string>().ends_with("Z"));
  EXPECT_TRUE(json.at("resumed").empty());
  EXPECT_THROW(reader.manifest_number("absent"), std::runtime_error);
  EXPECT_THROW(reader.manifest_text("absent"), std::runtime_error);
}

TEST(Record, CostsOfOneOfSeveralRunsStartWhereTheRunStarts) {
  const TemporaryFolder folder;
  auto later = manifest();
  while (processor_seconds() < 0.05) {
  }
  later.processor_start = processor_seconds();
  later.wall_start = wall_seconds();
  RecordWriter(folder.path(), later).finish("finished");
  const RecordReader reader(folder.path());
  EXPECT_LT(reader.manifest_number("processor_seconds"), processor_seconds() - 0.04);
  EXPECT_GE(reader.manifest_number("processor_seconds"), 0.0);
}

TEST(Record, OutcomeOfARunThatNeverFinished) {
  const TemporaryFolder folder;
  {
    RecordWriter writer(folder.path(), manifest());
    EXPECT_EQ(RecordReader(folder.path()).manifest_text("outcome"), "running");
  }
  EXPECT_EQ(RecordReader(folder.path()).manifest_text("outcome"),
            "stopped: the run ended without closing its record");
}

// --- what is refused ----------------------------------------------------------------------------

TEST(RefusedRecord, NumbersThatAreNoneLeaveNothingBehind) {
  const TemporaryFolder folder;
  RecordWriter writer(folder.path(), manifest());
  writer.declare_series("tip", tip);
  append(writer, "tip", {0.1, 0, 0});
  writer.write_points(0.1, triangle, {});
  writer.flush();
  const auto before = all_files(folder.path());

  EXPECT_EQ(
      error_of([&] {
        append(writer, "tip", {0.2, nan, 0});
      }),
      "series tip: displacement_x at 0.2 s is nan: the run has broken down, and nothing of this "
      "is recorded");
  EXPECT_EQ(error_of([&] {
              append(writer, "tip", {infinity, 0, 0});
            }),
            "series tip: time is inf: the run has broken down, and nothing of this is recorded");
  EXPECT_EQ(error_of([&] {
              writer.write_table("profile", 0.2, profile, std::vector<double>{0, 0, 0, -infinity});
            }),
            "table profile at 0.2 s: y is -inf: the run has broken down, and nothing of this is "
            "recorded");
  const std::vector<double> broken{1, nan, 3};
  EXPECT_EQ(
      error_of([&] {
        writer.write_points(0.2, triangle, {{"psi", 1, broken}});
      }),
      "snapshot at 0.2 s: psi is nan: the run has broken down, and nothing of this is recorded");
  EXPECT_EQ(error_of([&] { writer.write_points(0.2, broken, {}); }),
            "snapshot at 0.2 s: a position is nan: the run has broken down, and nothing of this is "
            "recorded");
  const std::vector<std::int64_t> cell{0, 1, 2};
  EXPECT_THROW(writer.write_mesh(0.2, triangle, 3, cell, {{"psi", 1, broken}}), std::runtime_error);
  EXPECT_THROW(writer.write_points(nan, triangle, {}), std::runtime_error);
  EXPECT_THROW(writer.write_table("profile", nan, profile, {}), std::runtime_error);
  EXPECT_THROW(writer.set_number("steps", nan), std::runtime_error);
  EXPECT_THROW(writer.set_cost({{"step", infinity}}), std::runtime_error);
  EXPECT_THROW(writer.checkpoint(nan, {}), std::runtime_error);

  EXPECT_EQ(all_files(folder.path()), before);  // no new file, no half-written one
  writer.flush();
  auto after = all_files(folder.path());
  for (const auto* changing : {"manifest.json"}) after.at(changing) = before.at(changing);
  EXPECT_EQ(after, before);  // and none of it had been kept for later
}

TEST(RefusedRecord, FolderThatHoldsOne) {
  const TemporaryFolder folder;
  const auto place = folder.path() / "run";
  {
    RecordWriter writer(place, manifest());
    writer.declare_series("old", tip);
    writer.write_points(0.0, triangle, {});
    writer.write_points(1.0, triangle, {});
    writer.checkpoint(1.0, {});
  }
  std::ofstream(place / "notes.txt") << "the user's own";
  EXPECT_EQ(
      error_of([&] { RecordWriter(place, manifest()); }),
      place.string() + ": holds a record already; name another folder with --out, or remove it");
  EXPECT_TRUE(RecordReader(place).has_series("old"));
  { RecordWriter writer(place, manifest(), true); }
  EXPECT_FALSE(RecordReader(place).has_series("old"));
  const auto files = all_files(place);
  EXPECT_EQ(files.size(), 4u);  // record.h5, record.xdmf, manifest.json and
  EXPECT_TRUE(files.contains("notes.txt"));
}

TEST(RefusedRecord, PlacesWhereNoFolderCanBe) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "file") << "x";
  const auto error = error_of([&] { RecordWriter(folder.path() / "file" / "run", manifest()); });
  EXPECT_TRUE(error.find("the record's folder cannot be made") != std::string::npos) << error;
  EXPECT_THROW(RecordWriter(folder.path() / "file", manifest()), std::runtime_error);
}

TEST(RefusedRecord, MisusesByASolver) {
  const TemporaryFolder folder;
  RecordWriter writer(folder.path(), manifest());
  writer.declare_series("tip", tip);
  append(writer, "tip", {0.1, 0, 0});
  EXPECT_THROW(append(writer, "top", {0}), std::logic_error);
  EXPECT_THROW(append(writer, "tip", {0.2, 0}), std::logic_error);
  EXPECT_THROW(append(writer, "tip", {0.05, 0, 0}), std::logic_error);  // back in time
  EXPECT_THROW(writer.declare_series("tip", {{"time", "s"}, {"x", "m"}}), std::runtime_error);
  EXPECT_THROW(writer.declare_series("a/b", tip), std::logic_error);
  EXPECT_THROW(writer.declare_series("no_time", {{"x", "m"}}), std::logic_error);
  EXPECT_THROW(writer.declare_series("ms", {{"time", "ms"}}), std::logic_error);
  EXPECT_THROW(writer.declare_series("unit", {{"time", "s"}, {"x", "m,"}}), std::logic_error);
  EXPECT_THROW(writer.declare_series("unit", {{"time", "s"}, {"x", ""}}), std::logic_error);
  EXPECT_THROW(writer.declare_series("twice", {{"time", "s"}, {"x", "m"}, {"x", "m"}}),
               std::logic_error);
  EXPECT_THROW(writer.write_table("t", 0, profile, std::vector<double>{1, 2, 3}), std::logic_error);
  EXPECT_THROW(writer.write_points(0, std::vector<double>{1, 2}, {}), std::logic_error);
  const std::vector<double> two{1, 2};
  EXPECT_THROW(writer.write_points(0, triangle, {{"psi", 1, two}}), std::logic_error);
  EXPECT_THROW(writer.write_points(0, triangle, {{"a b", 1, triangle}}), std::logic_error);
  const std::vector<std::int64_t> beyond{0, 1, 3};
  EXPECT_THROW(writer.write_mesh(0, triangle, 3, beyond, {}), std::logic_error);
  EXPECT_THROW(writer.write_mesh(0, triangle, 2, beyond, {}), std::logic_error);
  writer.write_points(0.5, triangle, {});
  EXPECT_THROW(writer.write_points(0.4, triangle, {}), std::logic_error);
  writer.declare_series("profile_t2", tip);  // its file would be that of a table
  EXPECT_THROW(writer.write_table("profile", 2, profile, std::vector<double>{1, 2}),
               std::logic_error);
}

TEST(RefusedRecord, MissingOrDamaged) {
  const TemporaryFolder folder;
  const auto place = folder.path() / "run";
  EXPECT_EQ(error_of([&] { RecordReader reader(place); }),
            (place / "manifest.json").string() + ": is missing or cannot be read");
  { RecordWriter writer(place, manifest()); }
  const auto text = bytes(place / "manifest.json");
  std::ofstream(place / "manifest.json") << text.substr(0, text.size() / 2);
  EXPECT_TRUE(error_of([&] {
                RecordReader reader(place);
              }).starts_with((place / "manifest.json").string() + ": is damaged"));
  std::ofstream(place / "manifest.json") << text;
  fs::resize_file(place / "record.h5", fs::file_size(place / "record.h5") / 2);
  EXPECT_EQ(error_of([&] { RecordReader reader(place); }),
            (place / "record.h5").string() + ": is damaged, or not an HDF5 file");
  fs::remove(place / "record.h5");
  EXPECT_EQ(error_of([&] { RecordReader reader(place); }),
            (place / "record.h5").string() + ": is missing");
  write_archive(place / "record.h5", {{"x", std::vector<double>{1}}});
  EXPECT_EQ(error_of([&] { RecordReader reader(place); }),
            (place / "record.h5").string() +
                ": is damaged, or not written by this program: no attribute format_version of /");
}

TEST(Record, SameTimeReplaces) {
  const TemporaryFolder folder;
  RecordWriter writer(folder.path(), manifest());
  writer.write_table("profile", 0.2, profile, std::vector<double>{1, 2});
  writer.write_table("profile", 0.2, profile, std::vector<double>{3, 4});
  writer.write_points(0.2, triangle, {});
  writer.write_points(0.2, triangle, {});
  writer.flush();
  EXPECT_EQ(RecordReader(folder.path()).table("profile", 0.2).values, (std::vector<double>{3, 4}));
  EXPECT_FALSE(fs::exists(folder.path() / "fields" / "000001.vtkhdf"));
}

}  // namespace
}  // namespace sprung
