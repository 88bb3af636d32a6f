#pragma once
/// Symmetric matrices in sweeps over pairs, written out: loops over three coordinates make GCC 12
/// build vectors of two through the stack and wait for its own stores, at twice to thrice the time.

#include "sph/vector.hpp"

namespace sprung::sph {

template <int dim>
using Matrix = Eigen::Matrix<double, dim, dim>;

/// r . A r of a symmetric A, of which the lower triangle is read.
template <int dim>
double quadratic_form(const Matrix<dim>& A, const Vector<dim>& r) {
  double form = A(0, 0) * r[0] * r[0] + A(1, 1) * r[1] * r[1] + 2.0 * A(1, 0) * r[0] * r[1];
  if constexpr (dim == 3)
    form += A(2, 2) * r[2] * r[2] + 2.0 * (A(2, 0) * r[0] + A(2, 1) * r[1]) * r[2];
  return form;
}

/// Adds up f r r^T, one triangle of it.
template <int dim>
class OuterProductSum {
 public:
  void add(double f, const Vector<dim>& r) {
    const double x = f * r[0], y = f * r[1];
    xx_ += x * r[0];
    xy_ += x * r[1];
    yy_ += y * r[1];
    if constexpr (dim == 3) {
      xz_ += x * r[2];
      yz_ += y * r[2];
      zz_ += f * r[2] * r[2];
    }
  }
  Matrix<dim> sum() const {
    Matrix<dim> m;
    if constexpr (dim == 2)
      m << xx_, xy_, xy_, yy_;
    else
      m << xx_, xy_, xz_, xy_, yy_, yz_, xz_, yz_, zz_;
    return m;
  }

 private:
  double xx_ = 0.0, xy_ = 0.0, yy_ = 0.0, xz_ = 0.0, yz_ = 0.0, zz_ = 0.0;
};

}  // namespace sprung::sph
