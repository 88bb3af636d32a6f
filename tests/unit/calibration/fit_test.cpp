#include "calibration/fit.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace {

using sprung::calibration::extrapolate;

constexpr std::array layers{12, 16, 20, 28, 40};

TEST(Extrapolation, FindsTheConstantOfAPolynomial) {
  std::array<double, 5> value;
  for (int k = 0; k < 5; ++k) value[k] = 3.0 - 2.5 / layers[k] + 7.0 / (layers[k] * layers[k]);
  const auto fit = extrapolate(layers, value, 2);
  EXPECT_NEAR(fit.value, 3.0, 1e-10);  // rounding
  EXPECT_LT(fit.half_width, 1e-9);
  EXPECT_LT(fit.residual, 1e-12);
}

TEST(Extrapolation, ConfidenceIntervalOfAMean) {
  // Degree 0: mean 2, s = 1, five points: t(0.975, 4) s/sqrt(5) = 2.776/sqrt(5); sum of squares 4
  // over 5 points.
  const std::array value{1.0, 1.0, 2.0, 3.0, 3.0};
  const auto fit = extrapolate(layers, value, 0);
  EXPECT_NEAR(fit.value, 2.0, 1e-12);
  EXPECT_NEAR(fit.half_width, 2.776 / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(fit.residual, std::sqrt(0.8), 1e-12);
}

TEST(Extrapolation, RefusesAFitWithoutResidual) {
  const std::array<double, 5> value{};
  EXPECT_THROW(extrapolate(layers, value, 4), std::invalid_argument);
  EXPECT_THROW(extrapolate(std::span(layers).first(2), value, 0), std::invalid_argument);
}

}  // namespace
