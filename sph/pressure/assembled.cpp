#include "sph/pressure/assembled.hpp"

#include <algorithm>

namespace sprung::sph {

Eigen::SparseMatrix<double, Eigen::RowMajor> assembled(const PressureMatrix& matrix, Part part,
                                                       double shift) {
  const std::size_t n = matrix.rows();
  std::vector<Eigen::Triplet<double, std::int32_t>> entries;
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<std::int32_t>(i);
    const auto add = [&](std::int32_t j, double a) { entries.emplace_back(row, j, -a); };
    if (part == Part::lower)
      matrix.for_each_lower(i, add);
    else
      matrix.for_each(i, add);
    entries.emplace_back(row, row, matrix.diagonal()[i] * (matrix.singular() ? 1.0 + shift : 1.0));
  }
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::SparseMatrix<double, Eigen::RowMajor> result(size, size);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace sprung::sph
