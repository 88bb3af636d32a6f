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

/// A symmetric matrix, its lower triangle row by row: xx, xy, yy, xz, yz, zz. `Number`: Two holds
/// the matrices of two pairs, and takes their vectors as TwoVectors.
template <int dim, typename Number = double>
class SymmetricMatrix {
 public:
  using Triangle = std::array<Number, dim*(dim + 1) / 2>;
  SymmetricMatrix() = default;  ///< zero
  explicit SymmetricMatrix(const Triangle& triangle) : a_(triangle) {}
  /// Of `full`, symmetric but for rounding, the lower triangle.
  explicit SymmetricMatrix(const Matrix<dim>& full) {
    for (int i = 0, k = 0; i < dim; ++i)
      for (int j = 0; j <= i; ++j, ++k) a_[k] = full(i, j);
  }
  const Triangle& triangle() const { return a_; }
  Matrix<dim> full() const {
    Matrix<dim> m;
    if constexpr (dim == 2)
      m << a_[0], a_[1], a_[1], a_[2];
    else
      m << a_[0], a_[1], a_[3], a_[1], a_[2], a_[4], a_[3], a_[4], a_[5];
    return m;
  }
  /// Adds f r r^T.
  template <typename Place>
  void add(Number f, const Place& r) {
    const Number x = f * r[0], y = f * r[1];
    a_[0] += x * r[0];
    a_[1] += x * r[1];
    a_[2] += y * r[1];
    if constexpr (dim == 3) {
      a_[3] += x * r[2];
      a_[4] += y * r[2];
      a_[5] += f * r[2] * r[2];
    }
  }
  /// r . A r.
  template <typename Place>
  Number form(const Place& r) const {
    const Number xy = a_[1] * r[1];
    if constexpr (dim == 2) return r[0] * (a_[0] * r[0] + (xy + xy)) + a_[2] * r[1] * r[1];
    const Number off_x = xy + a_[3] * r[2], off_y = a_[4] * r[2];
    return r[0] * (a_[0] * r[0] + (off_x + off_x)) + r[1] * (a_[2] * r[1] + (off_y + off_y)) +
           a_[5] * r[2] * r[2];
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
  Triangle a_{};
};

/// A + a[j] of two pairs.
template <int dim>
SymmetricMatrix<dim, Two> sums(const SymmetricMatrix<dim>& matrix,
                               const std::vector<SymmetricMatrix<dim>>& a,
                               const std::array<std::int32_t, 2>& j) {
  typename SymmetricMatrix<dim, Two>::Triangle t;
  for (std::size_t k = 0; k < t.size(); ++k)
    t[k] = matrix.triangle()[k] + Two{a[j[0]].triangle()[k], a[j[1]].triangle()[k]};
  return SymmetricMatrix<dim, Two>(t);
}

template <int dim>
SymmetricMatrix<dim> sum_of(const SymmetricMatrix<dim, Two>& both) {
  typename SymmetricMatrix<dim>::Triangle t;
  for (std::size_t k = 0; k < t.size(); ++k) t[k] = sum_of(both.triangle()[k]);
  return SymmetricMatrix<dim>(t);
}

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
