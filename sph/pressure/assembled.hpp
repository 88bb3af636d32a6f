#pragma once
/// The pressure matrix in the form that libraries take.

#include "sph/pressure/matrix.hpp"

#include <Eigen/SparseCore>

namespace sprung::sph {

/// Lower triangle with the diagonal, or all of it (row by row). A singular matrix gets its diagonal
/// raised by `shift` of itself, so that it can be factorised.
enum class Part { lower, all };
Eigen::SparseMatrix<double, Eigen::RowMajor> assembled(const PressureMatrix& matrix, Part part,
                                                       double shift);

}  // namespace sprung::sph
