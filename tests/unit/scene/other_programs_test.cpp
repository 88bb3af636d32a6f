/// Records opened by programs that know nothing of this project: h5dump, h5py, and meshio's XDMF
/// reader.

#include "scene/record.hpp"

#include "tests/unit/scene/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

namespace sprung {
namespace {

using test::TemporaryFolder;

struct Answer {
  int status = -1;
  std::string text;
};

Answer run(const std::string& command) {
  Answer answer;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return answer;
  std::array<char, 4096> buffer{};
  while (const auto count = fread(buffer.data(), 1, buffer.size(), pipe))
    answer.text.append(buffer.data(), count);
  answer.status = pclose(pipe);
  return answer;
}

std::string quoted(const std::filesystem::path& path) {
  std::string text = "\"";
  return text.append(path.string()).append("\"");
}

/// The record that read_record.py expects; every number is exact in binary.
void write_sample(const std::filesystem::path& folder) {
  Manifest manifest;
  manifest.solver = "sph";
  manifest.scene_title = "Sample";
  RecordWriter writer(folder, manifest);
  writer.declare_series("tip", {{"time", "s"}, {"displacement_x", "m"}});
  for (int i = 0; i < 3; ++i) writer.append("tip", std::vector<double>{0.5 * i, 0.25 * i * i});
  writer.write_table("profile", 0.5, {{"x", "m"}, {"velocity_x", "m/s"}},
                     std::vector<double>{0, 1, 2, 3, 4, 5});

  const std::vector<double> cloud{0, 0, 0, 1, 0, 0, 0, 2, 0};
  const std::vector<double> pressure{1, 2, 4}, velocity{1, 2, 3, 4, 5, 6};
  writer.write_points(0.0, cloud, {{"pressure", 1, pressure}, {"velocity", 2, velocity}});
  const std::vector<double> square{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<double> corner{1, 2, 3, 4};
  writer.write_mesh(0.5, square, 4, std::vector<std::int64_t>{0, 1, 2, 3},
                    {{"pressure", 1, corner}});
  writer.write_mesh(1.0, square, 3, std::vector<std::int64_t>{0, 1, 2, 0, 2, 3},
                    {{"pressure", 1, corner}});
  writer.finish("finished");
}

TEST(OtherPrograms, H5dumpReadsSeriesAndFollowsLinks) {
  const TemporaryFolder folder;
  write_sample(folder.path());
  const auto file = quoted(folder.path() / "record.h5");
  const auto series = run(SPRUNG_H5DUMP " -d /series/tip " + file);
  EXPECT_EQ(series.status, 0) << series.text;
  EXPECT_NE(series.text.find("(0,0): 0, 0,"), std::string::npos) << series.text;
  EXPECT_NE(series.text.find("(1,0): 0.5, 0.25,"), std::string::npos) << series.text;
  EXPECT_NE(series.text.find("(2,0): 1, 1"), std::string::npos) << series.text;
  EXPECT_NE(series.text.find("\"time\", \"displacement_x\""), std::string::npos) << series.text;
  const auto field = run(SPRUNG_H5DUMP " -d /fields/000000/fields/pressure " + file);
  EXPECT_EQ(field.status, 0) << field.text;
  EXPECT_NE(field.text.find("(0): 1, 2, 4"), std::string::npos) << field.text;
}

TEST(OtherPrograms, PythonReadsRecordAndXdmf) {
  const TemporaryFolder folder;
  write_sample(folder.path());
  const auto answer =
      run(SPRUNG_DEBIAN_PYTHON " " + quoted(SPRUNG_READ_RECORD) + " " + quoted(folder.path()));
  EXPECT_EQ(answer.status, 0) << answer.text;
  EXPECT_EQ(answer.text, "record, xdmf and VTK agree\n");
}

}  // namespace
}  // namespace sprung
