// The published table: read by the particle solver, near theory, and of known provenance.
#include "calibration/published.hpp"
#include "sph/scene_setup.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <fstream>

namespace {

using namespace sprung;
using namespace sprung::calibration;
using enum sph::Bonds;

const std::filesystem::path folder = SPRUNG_CALIBRATION_FOLDER;

class Temporary {
 public:
  Temporary()
      : place_(std::filesystem::temp_directory_path() / ("sprung_calibration_" + unique())) {
    std::filesystem::create_directories(place_);
  }
  ~Temporary() { std::filesystem::remove_all(place_); }
  const std::filesystem::path& place() const { return place_; }

 private:
  static std::string unique() {
    return std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
           ::testing::UnitTest::GetInstance()->current_test_info()->name() +
           std::to_string(getpid());
  }
  std::filesystem::path place_;
};

TEST(PublishedTable, HoldsTheRowsThatThePresetsNeedWithinHalfAPerCentOfTheory) {
  const sph::ModulusTable table(folder / "modulus_per_stiffness.csv");
  for (const Material& m : {Material{2, equal, 0.0},
                            {2, isotropic, 0.0},
                            {2, isotropic, 30.0},
                            {2, isotropic, 100.0},
                            {2, isotropic, 300.0},
                            {2, isotropic, 1000.0},
                            {3, equal, 0.0},
                            {3, isotropic, 0.0},
                            {3, isotropic, 300.0},
                            {3, equal, 300.0}}) {
    const double measured = table.modulus_per_stiffness(m.dimension, m.bonds, m.area_stiffness);
    EXPECT_NEAR(measured / theoretical_lambda(m), 1.0, 5e-3) << key_of(m);
  }
}

TEST(PublishedTable, EveryRowHasItsManifest) {
  std::ifstream in(folder / "modulus_per_stiffness.json");
  const auto manifest = nlohmann::json::parse(in);
  const Sheet sheet = read_sheet(folder / "modulus_per_stiffness.csv");
  ASSERT_FALSE(sheet.rows.empty());
  for (const auto& row : sheet.rows) {
    bool found = false;
    for (const auto& [key, run] : manifest.at("rows").items())
      if (row.starts_with(key + ",")) {
        found = true;
        EXPECT_EQ(run.at("clean"), "yes") << key;
        EXPECT_EQ(run.at("commit").get<std::string>().size(), 40u) << key;
        for (const char* what : {"command", "date_utc", "compiler"})
          EXPECT_TRUE(run.contains(what));
      }
    EXPECT_TRUE(found) << row;
  }
}

TEST(PublishedTable, AnAddedRowLeavesTheOthersAndTheirProvenance) {
  const Temporary temporary;
  const auto file = temporary.place() / "table.csv";
  BulkModulus bulk;
  bulk.material = {2, isotropic, 30.0};
  bulk.lambda = 1.4545;
  Sheet sheet{modulus_header(), {modulus_row(bulk)}};
  publish(file, sheet, {"first", "", 1.0, {key_of(bulk.material)}});
  bulk.material.area_stiffness = 3.0;  // its key is the beginning of the other's number
  bulk.lambda = 1.25;
  sheet = read_sheet(file);
  replace_row(sheet, key_of(bulk.material), modulus_row(bulk));
  publish(file, sheet, {"second", "", 1.0, {key_of(bulk.material)}});
  const sph::ModulusTable table(file);
  EXPECT_EQ(table.modulus_per_stiffness(2, isotropic, 30.0), 1.4545);
  EXPECT_EQ(table.modulus_per_stiffness(2, isotropic, 3.0), 1.25);
  EXPECT_THROW(table.modulus_per_stiffness(2, isotropic, 31.0), std::runtime_error);
  std::ifstream in(temporary.place() / "table.json");
  const auto rows = nlohmann::json::parse(in).at("rows");
  EXPECT_EQ(rows.at("2,isotropic,30").at("command"), "first");
  EXPECT_EQ(rows.at("2,isotropic,3").at("command"), "second");
}

TEST(PublishedTable, MissingFileIsAnEmptySheet) {
  EXPECT_TRUE(read_sheet("no_such_folder/none.csv").rows.empty());
}

TEST(Modulus, InThePlaneIsThreeQuartersOfStressOverStrain) {
  EXPECT_DOUBLE_EQ(modulus_per_stiffness(2, 2e-3, 1e-3), 1.5);
  EXPECT_DOUBLE_EQ(modulus_per_stiffness(3, 3e-3, 1e-3), 3.0);
}

}  // namespace
