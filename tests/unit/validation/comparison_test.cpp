/// Records made from formulas, whose differences are known beforehand.

#include "validation/comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <stdexcept>

#include "synthetic_record.hpp"
#include "validation/comparison_files.hpp"
#include "validation/measures.hpp"

namespace sprung {
namespace {

namespace fs = std::filesystem;
using synthetic::Deviation;

constexpr const char* acceptance_text = R"(title = "Made-up acceptance"
[measure]
judged_at = ["0.2 s", "1 s", "3 s"]
force_window = "0.1 s"
lag_search = "60 ms"
[full.run.recommended]
scene.numerics.preset = "recommended"
[full.run.recommended.limits]
velocity_difference = { at_most = 0.03, because = "test" }
displacement_difference = { at_most = 0.04, because = "test" }
lost_particles = { at_most = 0, because = "test" }
excess_outflow = { at_most = 0.001, because = "test" }
particle_drift = { at_most = 0.005, because = "test" }
[full.run.paper]
scene.numerics.preset = "paper"
)";

Acceptance acceptance(const std::string& text = acceptance_text) {
  return read_acceptance(Document::from_text(text), "full");
}

class ComparisonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("sprung_comparison_") + test->name());
    fs::remove_all(folder_);
    synthetic::write_reference(folder_ / "reference");
    synthetic::write_error_bar(folder_ / "reference", 0.001);
  }
  void TearDown() override { fs::remove_all(folder_); }

  RunComparison compare_with(const Deviation& deviation, const std::string& run = "recommended",
                             const std::string& text = acceptance_text) {
    synthetic::write_run(folder_ / run, deviation, run);
    return compare(Answer::read(folder_ / "reference"), Answer::read(folder_ / run),
                   ErrorBar(folder_ / "reference" / "error_bar.json"), acceptance(text), run);
  }

  fs::path folder_;
};

const Measurement& find(const RunComparison& comparison, const std::string& name,
                        std::optional<double> time = std::nullopt) {
  for (const Measurement& m : comparison.measurements) {
    if (m.measure == name && m.time == time) return m;
  }
  throw std::runtime_error("no " + name);
}

TEST_F(ComparisonTest, ARunLikeTheReferenceDiffersInNothing) {
  const RunComparison comparison = compare_with({});
  for (const Measurement& m : comparison.measurements) {
    if (!measure(m.measure).against_reference || m.measure == "displacement_amplitude_ratio") {
      continue;
    }
    ASSERT_TRUE(m.value) << m.measure << ": " << m.remark;
    // The lag is found to 1e-9 of the search; the reference's samples lie ten times as far apart as
    // the run's, and straight lines between them differ by 1.4 % of a ringing drag of 1 N/m at
    // 0.055 s, which averages out over the window to some 1e-4 of 20 N/m.
    EXPECT_NEAR(*m.value, 0.0, 1e-3) << m.measure;
  }
  // Cubic interpolation rounds the kink where the ramp ends: a few 1e-6 in the mean.
  EXPECT_NEAR(*find(comparison, "displacement_amplitude_ratio").value, 1.0, 1e-5);
  EXPECT_TRUE(comparison.accepted());
  EXPECT_EQ(comparison.reached, 3.0);
}

TEST_F(ComparisonTest, FindsEachDeviation) {
  Deviation deviation;
  deviation.lag = 0.005;
  deviation.amplitude = 1.05;
  deviation.velocity_offset = 0.0075;
  deviation.force_offset = 1.0;
  deviation.force_noise = 4.0;
  deviation.excess_outflow = 0.00054;
  deviation.lost = 2;
  deviation.vanished = 1;
  const RunComparison comparison = compare_with(deviation);

  EXPECT_NEAR(*find(comparison, "velocity_difference", 1.0).value, 0.01, 1e-12);  // of 0.75 m/s
  EXPECT_NEAR(*find(comparison, "velocity_difference_rms", 1.0).value, 0.01, 1e-12);
  EXPECT_NEAR(*find(comparison, "velocity_difference_transverse", 1.0).value, 0.0, 1e-12);
  EXPECT_NEAR(*find(comparison, "displacement_lag").value, 0.005, 1e-4);
  EXPECT_NEAR(*find(comparison, "displacement_amplitude_ratio").value, 1.05, 1e-4);

  // At 3 s the tip stands still: amplitude alone counts, x by 5 %, y (quadratic) by 1.05^2.
  const double x = synthetic::tip(3.0), y = -0.6 * x * x / 0.1;
  const double dx = 0.05 * x, dy = (1.05 * 1.05 - 1.0) * y;
  const Measurement& tip = find(comparison, "displacement_difference", 3.0);
  EXPECT_NEAR(*tip.value, std::hypot(dx, dy) / std::hypot(x, y), 1e-6);
  EXPECT_NEAR(*tip.reference, std::hypot(x, y), 1e-9);
  EXPECT_NEAR(*find(comparison, "displacement_difference_x", 3.0).value, dx / std::hypot(x, y),
              1e-6);
  EXPECT_NEAR(*find(comparison, "displacement_difference_y", 3.0).value, dy / std::hypot(x, y),
              1e-6);
  // Error bars of 0.04 mm in either component.
  EXPECT_NEAR(*tip.reference_error, std::sqrt(2.0) * 4e-5 / std::hypot(x, y), 1e-9);

  // The offset is 1 of about (20, 3) N/m; the 200 Hz noise averages out over 20 whole periods.
  EXPECT_NEAR(*find(comparison, "force_difference_x", 1.0).value, 1.0 / std::hypot(20.0, 3.0),
              1e-3);
  EXPECT_NEAR(*find(comparison, "force_difference_y", 1.0).value, 0.0, 1e-3);
  // Straight lines between five samples a period keep (2 + cos(2 pi / 5)) / 3 of a sine's variance.
  const double kept = (2.0 + std::cos(0.4 * std::numbers::pi)) / 3.0;
  EXPECT_NEAR(*find(comparison, "force_scatter", 3.0).value, 4.0 * std::sqrt(0.5 * kept), 1e-3);

  EXPECT_NEAR(*find(comparison, "excess_outflow").value, 0.002, 1e-12);  // of 0.27 m2
  EXPECT_EQ(*find(comparison, "lost_particles").value, 3.0);
  EXPECT_NEAR(*find(comparison, "particle_drift").value, 3.0 / 19200.0, 1e-15);
  EXPECT_NEAR(*find(comparison, "solid_area_change").value, 0.001, 1e-12);

  EXPECT_EQ(find(comparison, "velocity_difference", 1.0).verdict, Verdict::pass);
  EXPECT_EQ(find(comparison, "velocity_difference", 2.0).verdict,
            Verdict::reported);  // not judged at
  EXPECT_EQ(tip.verdict, Verdict::fail);
  EXPECT_EQ(find(comparison, "lost_particles").verdict, Verdict::fail);
  EXPECT_EQ(find(comparison, "excess_outflow").verdict, Verdict::fail);
  EXPECT_FALSE(comparison.accepted());
}

TEST_F(ComparisonTest, OutlineDistanceIsThatOfTheBends) {
  Deviation deviation;
  deviation.amplitude = 1.1;
  const RunComparison comparison = compare_with(deviation);
  // Material points of the tip: x and y move apart by 0.1 and 0.21 of the reference's displacement.
  const double x = synthetic::tip(3.0), y = -0.6 * x * x / 0.1;
  EXPECT_NEAR(*find(comparison, "outline_distance_material", 3.0).value,
              std::hypot(0.1 * x, 0.21 * y), 1e-9);
  const double curves = *find(comparison, "outline_distance", 3.0).value;
  EXPECT_GT(curves, 0.0);
  EXPECT_NEAR(*find(comparison, "outline_distance", 3.0).reference_error, std::sqrt(2.0) * 4e-5,
              1e-12);
  EXPECT_LE(curves,
            std::hypot(0.1 * x, 0.21 * y) * (1.0 + 1e-12));  // the tip's corner is the farthest
  EXPECT_NEAR(*find(comparison, "outline_distance_relative", 3.0).value, curves / std::hypot(x, y),
              1e-9);
}

TEST_F(ComparisonTest, AStoppedRunIsNotAccepted) {
  Deviation deviation;
  deviation.stops_at = 1.5;
  deviation.outcome = "stopped: the speed of a particle grew beyond all bounds";
  const RunComparison comparison = compare_with(deviation);
  EXPECT_EQ(find(comparison, "velocity_difference", 1.0).verdict, Verdict::pass);
  EXPECT_EQ(find(comparison, "velocity_difference", 3.0).verdict, Verdict::not_judged);
  EXPECT_EQ(find(comparison, "displacement_difference", 3.0).verdict, Verdict::not_judged);
  // No excess up to 1.5 s says nothing about 3 s.
  EXPECT_EQ(find(comparison, "excess_outflow").verdict, Verdict::not_judged);
  EXPECT_FALSE(comparison.accepted());
}

TEST_F(ComparisonTest, ARunThatStoppedBeforeAnyTableIsStillCompared) {
  Deviation deviation;
  deviation.stops_at = 0.1;
  deviation.outcome = "stopped: made up";
  const RunComparison comparison = compare_with(deviation);
  for (const Measurement& m : comparison.measurements) EXPECT_NE(m.verdict, Verdict::pass);
  EXPECT_EQ(find(comparison, "velocity_difference", 0.2).verdict, Verdict::not_judged);
}

TEST_F(ComparisonTest, ARunWithoutLimitsIsReportedOnly) {
  Deviation deviation;
  deviation.amplitude = 2.0;
  const RunComparison comparison = compare_with(deviation, "paper");
  for (const Measurement& m : comparison.measurements) EXPECT_EQ(m.verdict, Verdict::reported);
}

TEST_F(ComparisonTest, ALimitThatMeetsNoMeasurementIsNotPassed) {
  std::string text = acceptance_text;
  text += "limits.displacement_lag = { at_most = \"10 ms\", because = \"test\" }\n";
  Deviation early;
  early.stops_at = 0.2;  // too short a history for a lag
  const RunComparison comparison = compare_with(early, "paper", text);
  EXPECT_EQ(find(comparison, "displacement_lag").verdict, Verdict::not_judged);
  EXPECT_FALSE(comparison.accepted());
}

TEST_F(ComparisonTest, RefusesAnotherProblem) {
  Deviation deviation;
  deviation.youngs_modulus = 0.35e6;
  try {
    compare_with(deviation);
    FAIL() << "compared two materials";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("youngs_modulus: 700000 against 350000"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(ComparisonTest, RefusesAReferenceWithoutManifest) {
  fs::remove(folder_ / "reference" / "manifest.json");
  EXPECT_THROW(Answer::read(folder_ / "reference"), std::runtime_error);
}

TEST_F(ComparisonTest, RefusesAnUnfinishedReference) {
  Deviation half;
  half.outcome = "stopped: asked to";
  synthetic::write_run(folder_ / "half", half);
  EXPECT_THROW(compare(Answer::read(folder_ / "half"), Answer::read(folder_ / "reference"), {},
                       acceptance(), "recommended"),
               std::runtime_error);
}

TEST_F(ComparisonTest, LeavesWholeFiles) {
  ComparisonResult result;
  result.level = "full";
  result.acceptance = acceptance();
  result.reference_folder = folder_ / "reference";
  result.error_bar = ErrorBar(folder_ / "reference" / "error_bar.json");
  result.runs.push_back(compare_with({}));
  result.planned_but_absent = {"paper"};
  write_comparison(result, folder_);
  std::ifstream in(folder_ / "comparison.json");
  const auto json = nlohmann::json::parse(in);
  EXPECT_EQ(json["accepted"], true);  // the absent run has no limits
  EXPECT_EQ(json["reference"]["folder"], "reference");
  EXPECT_EQ(json["runs"][0]["folder"], "recommended");
  EXPECT_EQ(json["absent"][0], "paper");
  std::ifstream csv(folder_ / "measurements.csv");
  std::size_t lines = 0;
  for (std::string line; std::getline(csv, line);) ++lines;
  EXPECT_EQ(lines, 1 + result.runs[0].measurements.size());
  EXPECT_NE(verdict_table(result).find("within the acceptance"), std::string::npos);

  result.runs[0] = compare_with({}, "paper");
  EXPECT_FALSE(result.accepted());  // nothing judged

  result.planned_but_absent = {"recommended"};  // a run with limits that was not made
  EXPECT_FALSE(result.accepted());
}

// -------------------------------------------------------------------------------------------
// verdicts

Measurement difference(double value, std::optional<double> error) {
  Measurement m;
  m.measure = "displacement_difference";
  m.time = 1.0;
  m.value = value;
  m.reference_error = error;
  return m;
}

Verdict verdict_of(double value, std::optional<double> error, const std::string& extra = "") {
  const Acceptance stated = acceptance(std::string(acceptance_text) + extra);
  Measurement m = difference(value, error);
  judge(m, stated, stated.run("recommended"));
  return m.verdict;
}

TEST(Verdict, TakesTheReferencesErrorBarIntoAccount) {
  EXPECT_EQ(verdict_of(0.030, 0.005), Verdict::pass);        // 0.035 at worst
  EXPECT_EQ(verdict_of(-0.030, 0.005), Verdict::pass);       // amounts are judged
  EXPECT_EQ(verdict_of(0.038, 0.005), Verdict::not_judged);  // 0.033 to 0.043 about 0.04
  EXPECT_EQ(verdict_of(0.042, 0.005), Verdict::not_judged);
  EXPECT_EQ(verdict_of(0.046, 0.005), Verdict::fail);  // 0.041 at best
}

TEST(Verdict, NeedsAReferenceErrorMeasuredOrStated) {
  EXPECT_EQ(verdict_of(0.01, std::nullopt), Verdict::not_judged);
  const char* stated =
      "[full.reference_error]\ndisplacement_difference = { is = 0.02, because = \"test\" }\n";
  EXPECT_EQ(verdict_of(0.01, std::nullopt, stated), Verdict::pass);
  EXPECT_EQ(verdict_of(0.03, std::nullopt, stated), Verdict::not_judged);
  EXPECT_EQ(verdict_of(0.03, 0.001, stated), Verdict::pass);  // measured goes before stated
}

TEST(Acceptance, RefusesSlips) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = acceptance_text;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  EXPECT_THROW(acceptance(with("velocity_difference", "velocity_diference")), SceneError);
  EXPECT_THROW(acceptance(with("at_most = 0.03", "at_most = -0.03")), SceneError);
  EXPECT_THROW(acceptance(with("\"60 ms\"", "\"60 mm\"")), SceneError);
  EXPECT_THROW(acceptance(with("[\"0.2 s\", \"1 s\"", "[\"1 s\", \"0.2 s\"")), SceneError);
}

TEST(Acceptance, TurnsOverlaysIntoOverrides) {
  const Acceptance plan = acceptance();
  ASSERT_EQ(plan.runs.size(), 2u);
  EXPECT_EQ(plan.runs[0].overrides, std::vector<std::string>{"numerics.preset=recommended"});
  EXPECT_EQ(plan.run("none"), nullptr);
}

TEST(ErrorBarFile, RefusesWhatIsNoErrorBar) {
  const fs::path file = fs::temp_directory_path() / "sprung_error_bar_test.json";
  const auto write = [&](const char* text) { std::ofstream(file) << text; };
  write("{\"quantities\": [{\"name\": \"tip.displacement_x\", \"time\": 1.0, \"error\": 1e-5}]}");
  const ErrorBar bar(file);
  EXPECT_EQ(bar.at("tip.displacement_x", 1.0), 1e-5);
  EXPECT_EQ(bar.at("tip.displacement_x", 2.0), std::nullopt);
  EXPECT_EQ(bar.at("tip.displacement_y", 1.0), std::nullopt);
  for (const char* text :
       {"", "{}", "{\"quantities\": [{\"time\": 1.0, \"error\": 1e-5}]}",
        "{\"quantities\": [{\"name\": \"tip\", \"time\": 1.0, \"error\": -1}]}",
        "{\"quantities\": [{\"name\": \"tip\", \"time\": 1.0, \"error\": null}]}"}) {
    write(text);
    EXPECT_THROW(ErrorBar{file}, std::runtime_error) << text;
  }
  fs::remove(file);
}

}  // namespace
}  // namespace sprung
