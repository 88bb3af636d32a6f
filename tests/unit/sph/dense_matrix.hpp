#pragma once
/// The pressure matrix with all its entries, for tests.

#include "sph/pressure/matrix.hpp"

#include <Eigen/Dense>

#include <vector>

namespace sprung::sph::test {

/// Column by column, as multiply() gives them.
inline Eigen::MatrixXd dense(const PressureMatrix& matrix) {
  const auto n = static_cast<Eigen::Index>(matrix.rows());
  Eigen::MatrixXd a(n, n);
  std::vector<double> unit(n, 0.0), column(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    unit[j] = 1.0;
    matrix.multiply(unit, column);
    unit[j] = 0.0;
    a.col(j) = Eigen::Map<Eigen::VectorXd>(column.data(), n);
  }
  return a;
}

}  // namespace sprung::sph::test
