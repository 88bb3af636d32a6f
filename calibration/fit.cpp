#include "calibration/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>

namespace sprung::calibration {

namespace {

/// 0.975 quantile of Student's t for 1 to 10 degrees of freedom (standard tables); 2.228 beyond is
/// wide.
double student_t(int freedom) {
  constexpr std::array quantile{12.706, 4.303, 3.182, 2.776, 2.571,
                                2.447,  2.365, 2.306, 2.262, 2.228};
  return quantile[static_cast<std::size_t>(std::clamp(freedom, 1, 10) - 1)];
}

}  // namespace

Extrapolation extrapolate(std::span<const int> layers, std::span<const double> value, int degree) {
  const auto points = static_cast<int>(layers.size());
  if (layers.size() != value.size() || degree < 0 || points < degree + 2)
    throw std::invalid_argument("extrapolation needs at least two points more than its degree");
  Eigen::MatrixXd design(points, degree + 1);
  Eigen::VectorXd right(points);
  for (int k = 0; k < points; ++k) {
    for (int p = 0; p <= degree; ++p) design(k, p) = std::pow(1.0 / layers[k], p);
    right[k] = value[k];
  }
  const Eigen::VectorXd coefficient = design.colPivHouseholderQr().solve(right);
  const double squares = (design * coefficient - right).squaredNorm();
  const int freedom = points - degree - 1;
  const Eigen::MatrixXd covariance = (design.transpose() * design).inverse() * (squares / freedom);
  return {coefficient[0], student_t(freedom) * std::sqrt(covariance(0, 0)),
          std::sqrt(squares / points)};
}

}  // namespace sprung::calibration
