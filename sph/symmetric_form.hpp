#pragma once
/// Symmetric matrices in sweeps over pairs, written out: loops over three coordinates make GCC 12
/// build vectors of two through the stack and wait for its own stores, at twice to thrice the time.

#include "sph/two_pairs.hpp"
#include "sph/vector.hpp"

#include <array>
#include <cstddef>

namespace sprung::sph {

/// Kept number by number: a matrix in the plane would be written to the stack so and read back as
/// vectors, before the numbers are there (half the time of the correction's moments).
template <int dim>
using Matrix = Eigen::Matrix<double, dim, dim, Eigen::DontAlign>;

/// A symmetric matrix, its lower triangle row by row: xx, xy, yy, xz, yz, zz.
template <int dim>
class SymmetricMatrix {
 public:
  SymmetricMatrix() = default;  ///< zero
  /// Of `full`, symmetric but for rounding, the lower triangle.
  explicit SymmetricMatrix(const Matrix<dim>& full) {
    for (int i = 0, k = 0; i < dim; ++i)
      for (int j = 0; j <= i; ++j, ++k) a_[k] = full(i, j);
  }
  Matrix<dim> full() const {
    Matrix<dim> m;
    if constexpr (dim == 2)
      m << a_[0], a_[1], a_[1], a_[2];
    else
      m << a_[0], a_[1], a_[3], a_[1], a_[2], a_[4], a_[3], a_[4], a_[5];
    return m;
  }
  /// Adds f r r^T.
  void add(double f, const Vector<dim>& r) {
    const double x = f * r[0], y = f * r[1];
    a_[0] += x * r[0];
    a_[1] += x * r[1];
    a_[2] += y * r[1];
    if constexpr (dim == 3) {
      a_[3] += x * r[2];
      a_[4] += y * r[2];
      a_[5] += f * r[2] * r[2];
    }
  }
  SymmetricMatrix operator+(const SymmetricMatrix& b) const {
    SymmetricMatrix sum;
    for (std::size_t k = 0; k < a_.size(); ++k) sum.a_[k] = a_[k] + b.a_[k];
    return sum;
  }
  /// r . A r.
  double form(const Vector<dim>& r) const {
    double sum = a_[0] * r[0] * r[0] + a_[2] * r[1] * r[1] + 2.0 * a_[1] * r[0] * r[1];
    if constexpr (dim == 3) sum += a_[5] * r[2] * r[2] + 2.0 * (a_[3] * r[0] + a_[4] * r[1]) * r[2];
    return sum;
  }
  /// a . A b.
  double form(const Vector<dim>& a, const Vector<dim>& b) const {
    if constexpr (dim == 2)
      return a[0] * (a_[0] * b[0] + a_[1] * b[1]) + a[1] * (a_[1] * b[0] + a_[2] * b[1]);
    else
      return a[0] * (a_[0] * b[0] + a_[1] * b[1] + a_[3] * b[2]) +
             a[1] * (a_[1] * b[0] + a_[2] * b[1] + a_[4] * b[2]) +
             a[2] * (a_[3] * b[0] + a_[4] * b[1] + a_[5] * b[2]);
  }
  Vector<dim> operator*(const Vector<dim>& r) const {
    if constexpr (dim == 2)
      return {a_[0] * r[0] + a_[1] * r[1], a_[1] * r[0] + a_[2] * r[1]};
    else
      return {a_[0] * r[0] + a_[1] * r[1] + a_[3] * r[2],
              a_[1] * r[0] + a_[2] * r[1] + a_[4] * r[2],
              a_[3] * r[0] + a_[4] * r[1] + a_[5] * r[2]};
  }

 private:
  std::array<double, dim*(dim + 1) / 2> a_{};
};

/// Adds up a b^T over pairs, two at a time.
template <int dim>
class OuterProductSum {
 public:
  void add(const TwoVectors<dim>& a, const TwoVectors<dim>& b) {
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) m_[i * dim + j] += a[i] * b[j];
  }
  Matrix<dim> sum() const {
    Matrix<dim> m;
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j) m(i, j) = sum_of(m_[i * dim + j]);
    return m;
  }

 private:
  std::array<Two, dim * dim> m_{};
};

}  // namespace sprung::sph
