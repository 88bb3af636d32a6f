/// Formulas and waveforms: values by hand, and what is refused.

#include "scene/waveform.hpp"

#include "tests/unit/scene/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace sprung {
namespace {

using test::error_of;
using test::TemporaryFolder;

constexpr double pi = std::numbers::pi;

double value(const std::string& text, double x, double y) {
  return Formula(text, {"x", "y"}).value(std::array{x, y});
}

TEST(Formula, HasTheValuesOfItsFunctions) {
  EXPECT_EQ(value("2", 0, 0), 2.0);
  EXPECT_EQ(value("x - 3*y", 7, 2), 1.0);
  EXPECT_EQ(value("2^10", 0, 0), 1024.0);
  EXPECT_EQ(value("pi", 0, 0), pi);
  EXPECT_DOUBLE_EQ(value("sin(2*pi*x)*cos(2*pi*y)", 1.0 / 12, 1.0 / 6), 0.25);  // 1/2 x 1/2
  EXPECT_DOUBLE_EQ(value("exp(x)", 1, 0), std::numbers::e);
  EXPECT_DOUBLE_EQ(value("log(x)", std::numbers::e, 0), 1.0);  // the natural logarithm
  EXPECT_EQ(value("min(x/0.1, 1)", 0.05, 0), 0.5);
  EXPECT_EQ(value("min(x/0.1, 1)", 0.5, 0), 1.0);
  EXPECT_EQ(value("x < 1 ? 3 : 4", 0, 0), 3.0);
  EXPECT_EQ(value("x == 1 ? 3 : 4", 0, 0), 4.0);
}

TEST(Formula, ACopyHasVariablesOfItsOwn) {
  const Formula one("x + 10*y", {"x", "y"});
  Formula two = one;
  EXPECT_EQ(two.value(std::array{1.0, 2.0}), 21.0);
  EXPECT_EQ(one.value(std::array{3.0, 4.0}), 43.0);
  EXPECT_EQ(two.value(std::array{1.0, 2.0}), 21.0);
  Formula three("x", {"x"});
  three = one;
  EXPECT_EQ(three.value(std::array{5.0, 0.0}), 5.0);
  const Formula four = std::move(two);
  EXPECT_EQ(four.value(std::array{0.0, 1.0}), 10.0);
  EXPECT_EQ(four.text(), "x + 10*y");
}

TEST(Formula, ValuesThatAreNoneAreLeftToTheCaller) {
  EXPECT_TRUE(std::isinf(value("1/x", 0, 0)));
  EXPECT_TRUE(std::isnan(value("sqrt(x)", -1, 0)));
}

TEST(Formula, RefusalsNameTheVariables) {
  for (const char* text : {"x + z", "sin(t)", "x +", "(x", "sine(x)", "", "x y", "\"x\""}) {
    const auto message = error_of([&] { Formula(text, {"x", "y"}); });
    EXPECT_NE(message.find("pi and the variables x and y"), std::string::npos)
        << text << ": " << message;
  }
  EXPECT_NE(error_of([] { Formula("x + z", {"x", "y"}); }).find("\"z\""), std::string::npos);
}

// muParser would take 0,5 for two results and give the second, and x = 2 for an assignment.
TEST(Formula, ADecimalCommaAndAnAssignmentAreRefused) {
  for (const char* text : {"0,5", "x*0,5", "1, 2, x"}) {
    const auto message = error_of([&] { Formula(text, {"x", "y"}); });
    EXPECT_NE(message.find("decimal point"), std::string::npos) << text << ": " << message;
  }
  for (const char* text : {"x = 2", "x=2", "x += 1", "1 + (y = 3)"})
    EXPECT_NE(error_of([&] { Formula(text, {"x", "y"}); }), "") << text;
  EXPECT_EQ(value("x >= 2 ? 1 : 0", 2, 0), 1.0);
  EXPECT_EQ(value("x != 2 ? 1 : 0", 2, 0), 0.0);
  EXPECT_EQ(value("x <= 2 ? 1 : 0", 2, 0), 1.0);
}

TEST(Waveform, IsOneWhereNoneIsWritten) {
  const Waveform none;
  EXPECT_TRUE(none.constant());
  EXPECT_EQ(none.value(-3.0), 1.0);
  EXPECT_EQ(none.value(1e9), 1.0);
}

TEST(Waveform, FormulaOfTime) {
  const auto wave = Waveform::from_formula("0.5*(1 - cos(2*pi*t))");
  EXPECT_FALSE(wave.constant());
  EXPECT_EQ(wave.value(0.0), 0.0);
  EXPECT_DOUBLE_EQ(wave.value(0.25), 0.5);
  EXPECT_DOUBLE_EQ(wave.value(0.5), 1.0);
  const Waveform copy = wave;
  EXPECT_DOUBLE_EQ(copy.value(1.0 / 6), 0.25);
}

TEST(Waveform, FormulaRefusals) {
  const auto other = error_of([] { Waveform::from_formula("sin(x)"); });
  EXPECT_NE(other.find("\"x\""), std::string::npos) << other;
  EXPECT_NE(other.find("pi and the variables t"), std::string::npos) << other;
  for (const char* text : {"1/t", "log(t)", "sqrt(-1)"}) {
    const auto message = error_of([&] { Waveform::from_formula(text); });
    EXPECT_NE(message.find("finite value at t = 0"), std::string::npos) << message;
  }
  const auto wave = Waveform::from_formula("sqrt(1 - t)");
  EXPECT_EQ(wave.value(1.0), 0.0);
  const auto message = error_of([&] { wave.value(1.5); });
  EXPECT_NE(message.find("sqrt(1 - t)"), std::string::npos) << message;
  EXPECT_NE(message.find("1.5"), std::string::npos) << message;
}

class WaveformFile : public testing::Test {
 protected:
  Waveform read(const std::string& text) {
    std::ofstream(file) << text;
    return Waveform::from_file(file);
  }
  std::string refusal(const std::string& text) {
    return error_of([&] { read(text); });
  }
  TemporaryFolder folder;
  std::filesystem::path file = folder.path() / "beat.csv";
};

TEST_F(WaveformFile, IsLinearBetweenTheSamplesAndConstantOutside) {
  const auto wave = read("time [s],factor\n0.5,1\n1.5,3\n\n2,-1\n");
  EXPECT_FALSE(wave.constant());
  EXPECT_EQ(wave.value(-1.0), 1.0);
  EXPECT_EQ(wave.value(0.5), 1.0);
  EXPECT_DOUBLE_EQ(wave.value(0.75), 1.5);
  EXPECT_DOUBLE_EQ(wave.value(1.0), 2.0);
  EXPECT_EQ(wave.value(1.5), 3.0);
  EXPECT_DOUBLE_EQ(wave.value(1.75), 1.0);
  EXPECT_EQ(wave.value(2.0), -1.0);
  EXPECT_EQ(wave.value(100.0), -1.0);
}

TEST_F(WaveformFile, BlanksTabsAndWindowsLineEndsSeparateToo) {
  const auto wave = read("t factor\r\n0 0\r\n 1\t2 \r\n2 , 4\r\n");
  EXPECT_DOUBLE_EQ(wave.value(0.25), 0.5);
  EXPECT_DOUBLE_EQ(wave.value(1.5), 3.0);
}

TEST_F(WaveformFile, OneSampleIsAConstant) {
  const auto wave = read("t,f\n3,0.25\n");
  for (const double t : {0.0, 3.0, 7.0}) EXPECT_EQ(wave.value(t), 0.25);
}

TEST_F(WaveformFile, RefusalsNameFileLineValueAndRemedy) {
  const std::string place = file.string() + ":3: \"";
  EXPECT_EQ(refusal("t,f\n0,1\n1\n"),
            place + "1\": not a time in s and a factor; write two numbers");
  EXPECT_EQ(refusal("t,f\n0,1\n1,2,3\n"),
            place + "1,2,3\": not a time in s and a factor; write two numbers");
  EXPECT_EQ(refusal("t,f\n0,1\none,2\n"),
            place + "one,2\": not a time in s and a factor; write two numbers");
  EXPECT_EQ(refusal("t,f\n0,1\n1,nan\n"),
            place + "1,nan\": not a time in s and a factor; write two numbers");
  EXPECT_EQ(refusal("t,f\n0,1\n0,2\n"), place + "0,2\": times must ascend");
  EXPECT_EQ(refusal("t,f\n0,1\n-1,2\n"), place + "-1,2\": times must ascend");
  EXPECT_EQ(refusal("t,f\n"), file.string() +
                                  ": holds no sample; write a header line, then a time in s and a "
                                  "factor on each line");
  EXPECT_EQ(refusal(""), refusal("t,f\n\n"));
  EXPECT_EQ(error_of([&] { Waveform::from_file(folder.path() / "none.csv"); }),
            (folder.path() / "none.csv").string() + ": cannot be opened");
}

// A file without a header would lose its first sample silently.
TEST_F(WaveformFile, AHeaderMadeOfNumbersIsRefused) {
  const auto message = refusal("0,1\n1,2\n2,3\n");
  EXPECT_TRUE(message.starts_with(file.string() + ":1: \"0,1\"")) << message;
  EXPECT_NE(message.find("header"), std::string::npos) << message;
}

}  // namespace
}  // namespace sprung
