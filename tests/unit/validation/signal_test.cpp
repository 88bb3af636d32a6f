/// Signals with known answers: a damped sine, shifted and scaled, and polynomials.

#include "validation/signal.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace sprung {
namespace {

constexpr double pi = std::numbers::pi;

Signal sampled(const std::function<double(double)>& f, double from, double to, double step) {
  std::vector<double> time, value;
  const auto n = static_cast<int>(std::lround((to - from) / step));
  for (int i = 0; i <= n; ++i) {
    time.push_back(from + i * step);
    value.push_back(f(time.back()));
  }
  return {time, value};
}

/// A tip's history in small: a ramp to a plateau with a ringing mode of 0.35 s upon it.
double ringing(double t) {
  if (t < 0.0) return 0.0;
  const double ramp = t < 1.0 ? t : 1.0;
  return 0.04 * ramp + 0.004 * std::exp(-4.0 * t) * std::sin(2.0 * pi * t / 0.35);
}

TEST(Signal, InterpolatesParabolasExactly) {
  const auto parabola = [](double t) { return 3.0 - 2.0 * t + 5.0 * t * t; };
  const Signal signal({0.0, 0.1, 0.25, 0.7, 1.0},
                      {parabola(0.0), parabola(0.1), parabola(0.25), parabola(0.7), parabola(1.0)});
  for (const double t : {0.0, 0.05, 0.2, 0.5, 0.99, 1.0}) {
    EXPECT_NEAR(signal.at(t), parabola(t), 1e-14) << t;  // round-off of values near 5
  }
}

TEST(Signal, RefusesWhatIsNoSignal) {
  EXPECT_THROW(Signal({0.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(Signal({0.0, 1.0}, {1.0}), std::invalid_argument);
  EXPECT_THROW(Signal({0.0, 1.0, 1.0}, {1.0, 2.0, 3.0}), std::invalid_argument);
  EXPECT_THROW(Signal({0.0, 1.0}, {1.0, std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
  const Signal signal({0.0, 1.0}, {0.0, 1.0});
  EXPECT_THROW(signal.at(1.1), std::out_of_range);
  EXPECT_THROW(signal.at(-0.1), std::out_of_range);
}

TEST(WindowMean, OfAStraightLineThatStartsBetweenSamples) {
  const Signal line({0.0, 0.3, 1.0}, {0.0, 0.6, 2.0});  // 2 t
  const WindowMean window = window_mean(line, 0.1, 0.5);
  EXPECT_NEAR(window.mean, 0.6, 1e-15);                               // 2 x 0.3
  EXPECT_NEAR(window.deviation, 2.0 * 0.4 / std::sqrt(12.0), 1e-14);  // uniform distribution
  EXPECT_THROW(window_mean(line, 0.5, 1.2), std::out_of_range);
  EXPECT_THROW(window_mean(line, 0.5, 0.5), std::invalid_argument);
}

TEST(RelativeL2, OfAScaledSignalIsTheScale) {
  const std::vector<Signal> reference{sampled(ringing, 0.0, 3.0, 0.01)};
  const std::vector<Signal> candidate{
      sampled([](double t) { return 1.03 * ringing(t); }, 0.0, 3.0, 0.01)};
  EXPECT_NEAR(relative_l2(reference, candidate), 0.03, 1e-12);  // exact up to round-off
}

TEST(RelativeL2, OfAShiftedSineIsTwiceTheSineOfHalfThePhase) {
  // |sin(x) - sin(x - a)|^2 averages to 2 sin^2(a/2) over whole periods, |sin|^2 to 1/2.
  const double phase = 0.2;
  const auto sine = [](double t) { return std::sin(2.0 * pi * t); };
  const std::vector<Signal> reference{sampled(sine, 0.0, 3.0, 0.002)};
  const std::vector<Signal> candidate{
      sampled([&](double t) { return sine(t - phase / (2.0 * pi)); }, 0.0, 3.0, 0.002)};
  // The trapezoidal rule is spectrally exact over whole periods.
  EXPECT_NEAR(relative_l2(reference, candidate), 2.0 * std::sin(phase / 2.0), 1e-9);
}

TEST(RelativeL2, SumsComponentsAndTakesTheCommonTimeOnly) {
  const auto one = [](double) { return 1.0; };
  const auto two = [](double) { return 2.0; };
  const std::vector<Signal> reference{sampled(one, 0.0, 2.0, 0.1), sampled(two, 0.0, 2.0, 0.1)};
  const std::vector<Signal> candidate{sampled(two, 0.0, 1.0, 0.1), sampled(two, 0.0, 1.0, 0.1)};
  EXPECT_NEAR(relative_l2(reference, candidate), 1.0 / std::sqrt(5.0), 1e-14);
  const std::vector<Signal> zero{sampled([](double) { return 0.0; }, 0.0, 1.0, 0.1)};
  EXPECT_THROW(relative_l2(zero, zero), std::invalid_argument);
}

struct Shift {
  double lag, amplitude, reference_step, candidate_step;
};

class AlignTest : public ::testing::TestWithParam<Shift> {};

/// Cubic interpolation of the ringing (period 0.35 s, 4 mm) at steps of 0.01 s errs by some 1e-4 of
/// its amplitude, which moves the best lag by less than 0.1 ms: a hundredth of the step.
TEST_P(AlignTest, FindsLagAndAmplitudeBetweenTheSamples) {
  const Shift shift = GetParam();
  const Signal reference = sampled(ringing, 0.0, 3.0, shift.reference_step);
  const Signal candidate =
      sampled([&](double t) { return shift.amplitude * ringing(t - shift.lag); }, 0.0, 3.0,
              shift.candidate_step);
  const auto alignment = align(reference, candidate, 0.06);
  ASSERT_TRUE(alignment);
  EXPECT_NEAR(alignment->lag, shift.lag, 1e-4);
  EXPECT_NEAR(alignment->amplitude_ratio, shift.amplitude, 1e-4 * shift.amplitude);
  EXPECT_GT(alignment->correlation, 0.99999);
}

INSTANTIATE_TEST_SUITE_P(DampedSine, AlignTest,
                         ::testing::Values(Shift{0.0, 1.0, 0.01, 0.01},
                                           Shift{0.005, 1.05, 0.01, 0.001},
                                           Shift{-0.0123, 0.8, 0.01, 0.0007},
                                           Shift{0.0333, 1.4, 0.005, 0.002}));

TEST(Align, SaysNothingWhereThereIsNothingToSay) {
  const Signal reference = sampled(ringing, 0.0, 3.0, 0.01);
  const Signal late = sampled([](double t) { return ringing(t - 0.2); }, 0.0, 3.0, 0.01);
  EXPECT_FALSE(align(reference, late, 0.05));  // beyond the search
  const Signal constant = sampled([](double) { return 0.04; }, 0.0, 3.0, 0.01);
  EXPECT_FALSE(align(constant, constant, 0.05));
  const Signal brief = sampled(ringing, 0.0, 0.1, 0.01);
  EXPECT_FALSE(align(reference, brief, 0.05));
}

}  // namespace
}  // namespace sprung
