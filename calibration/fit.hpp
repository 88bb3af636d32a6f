#pragma once
/// Extrapolation of measured values to infinitely many layers.

#include <span>

namespace sprung::calibration {

/// Value at 1/n = 0 of the least-squares polynomial in 1/n.
struct Extrapolation {
  double value = 0.0;
  double half_width = 0.0;  ///< of the 95 % confidence interval (Student's t on the residuals)
  double residual = 0.0;    ///< root mean square of the residuals
};

/// Polynomial of degree `degree` through (1/layers[k], value[k]). Throws std::invalid_argument
/// unless there are at least degree + 2 points: with fewer there is no residual to judge by.
Extrapolation extrapolate(std::span<const int> layers, std::span<const double> value, int degree);

}  // namespace sprung::calibration
