#include "sph/pressure/solver.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sprung::sph {

namespace {

/// Multiplicative and symmetric: forward Gauss-Seidel from zero, coarse correction, backward sweep.
/// The sweeps run inside blocks of fixed size side by side, so the bits do not depend on the
/// threads.
class TwoLevel final : public PressureSolver {
 public:
  void prepare(const PressureMatrix& matrix, std::span<const std::int32_t> cell_of,
               std::span<const std::int32_t> cell_extent) override {
    const std::size_t n = matrix.rows();
    for (auto* v : {&r_, &p_, &q_, &z_, &w_}) v->resize(n);
    inverse_diagonal_.resize(n);
    for (std::size_t i = 0; i < n; ++i) inverse_diagonal_[i] = 1.0 / matrix.diagonal()[i];
    cell_of_.assign(cell_of.begin(), cell_of.end());
    build_coarse(matrix, cell_extent);
  }

  SolveReport solve(const PressureMatrix& matrix, std::span<const double> b, std::span<double> x,
                    double tolerance) override {
    const std::size_t n = matrix.rows();
    const double norm_b = std::sqrt(dot(b, b));
    if (norm_b == 0.0) {
      std::fill(x.begin(), x.end(), 0.0);
      return {};
    }
    matrix.multiply(x, q_);
    for (std::size_t i = 0; i < n; ++i) r_[i] = b[i] - q_[i];
    SolveReport report;
    report.relative_residual = std::sqrt(dot(r_, r_)) / norm_b;
    double rz = 0.0;
    constexpr int most_iterations = 500;
    while (report.relative_residual > tolerance && report.iterations < most_iterations) {
      precondition(matrix);
      const double rz_next = dot(r_, z_);
      const double beta = report.iterations == 0 ? 0.0 : rz_next / rz;
      rz = rz_next;
      for (std::size_t i = 0; i < n; ++i) p_[i] = z_[i] + beta * p_[i];
      if (report.iterations == 0) p_ = z_;
      matrix.multiply(p_, q_);
      const double alpha = rz / dot(p_, q_);
      for (std::size_t i = 0; i < n; ++i) {
        x[i] += alpha * p_[i];
        r_[i] -= alpha * q_[i];
      }
      ++report.iterations;
      report.relative_residual = std::sqrt(dot(r_, r_)) / norm_b;
    }
    report.converged = report.relative_residual <= tolerance;
    return report;
  }

 private:
  static constexpr std::size_t sweep_block = 2048;

  /// Galerkin matrix of the piecewise constant functions on the cells.
  void build_coarse(const PressureMatrix& matrix, std::span<const std::int32_t> extent) {
    std::int32_t cells = 1;
    for (const std::int32_t e : extent) cells *= e;
    // Coefficients of a cell and its neighbour cells; a pair never reaches past those.
    const int stencil = extent.size() == 2 ? 9 : 27;
    coefficients_.assign(static_cast<std::size_t>(cells) * stencil, 0.0);
    const std::int32_t row = extent[0];
    const std::int32_t layer = extent.size() == 3 ? extent[0] * extent[1] : 0;
    auto slot = [&](std::int32_t from, std::int32_t to) {
      const std::int32_t dx = to % row - from % row;
      const std::int32_t dy =
          extent.size() == 3 ? to % layer / row - from % layer / row : to / row - from / row;
      const std::int32_t dz = extent.size() == 3 ? to / layer - from / layer : 0;
      return (dx + 1) + 3 * (dy + 1) + (extent.size() == 3 ? 9 * (dz + 1) : 0);
    };
    const std::size_t n = matrix.rows();
    const int self = stencil / 2;
    for (std::size_t i = 0; i < n; ++i) {
      const std::int32_t c = cell_of_[i];
      double* const line = &coefficients_[static_cast<std::size_t>(c) * stencil];
      line[self] += matrix.diagonal()[i];
      const auto lower = matrix.lower(i);
      for (std::int32_t k = 0; k < lower.count; ++k) {
        const std::int32_t other = cell_of_[lower.column[k]];
        if (other == c)
          line[self] -= 2.0 * lower.value[k];
        else if (other < c)
          line[slot(c, other)] -= lower.value[k];
        else
          coefficients_[static_cast<std::size_t>(other) * stencil + slot(other, c)] -=
              lower.value[k];
      }
    }
    // Only the lower triangle is kept. Its pattern is that of the grid, so it is analysed once per
    // grid.
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(cells * (self + 1));
    for (std::int32_t c = 0; c < cells; ++c) {
      const double* const line = &coefficients_[static_cast<std::size_t>(c) * stencil];
      const std::int32_t x = c % row, y = extent.size() == 3 ? c % layer / row : c / row;
      const std::int32_t z = extent.size() == 3 ? c / layer : 0;
      for (int s = 0; s < self; ++s) {
        const std::int32_t ox = x + s % 3 - 1, oy = y + s / 3 % 3 - 1;
        const std::int32_t oz = extent.size() == 3 ? z + s / 9 - 1 : 0;
        if (ox < 0 || ox >= row || oy < 0 || oy >= extent[1] || oz < 0) continue;
        entries.emplace_back(c, ox + row * oy + layer * oz, line[s]);
      }
      // An empty cell stands alone; a pure Neumann problem is made definite by a slight shift.
      const double diagonal =
          line[self] > 0.0 ? line[self] * (matrix.singular() ? 1.0 + 1e-6 : 1.0) : 1.0;
      entries.emplace_back(c, c, diagonal);
    }
    coarse_.resize(cells, cells);
    coarse_.setFromTriplets(entries.begin(), entries.end());
    const std::vector<std::int32_t> now(extent.begin(), extent.end());
    if (analysed_ != now) {
      factor_.analyzePattern(coarse_);
      analysed_ = now;
    }
    factor_.factorize(coarse_);
    if (factor_.info() != Eigen::Success)
      throw std::runtime_error(
          "the coarse pressure matrix is not positive definite: particles overlap "
          "or have left the domain");
    coarse_right_.resize(cells);
  }

  /// z = M^-1 r.
  void precondition(const PressureMatrix& matrix) {
    const std::size_t n = matrix.rows();
    const auto blocks = static_cast<std::ptrdiff_t>((n + sweep_block - 1) / sweep_block);
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = begin; i < end; ++i) {
        double sum = r_[i];
        const auto lower = matrix.lower(i);
        for (std::int32_t k = 0; k < lower.count; ++k)
          if (static_cast<std::size_t>(lower.column[k]) >= begin)
            sum += lower.value[k] * z_[lower.column[k]];
        z_[i] = sum * inverse_diagonal_[i];
      }
    }
    // (D - L) z = r inside a block, so the residual r - A z is what the sweep has not seen: the
    // columns right of the diagonal, and those left of it in other blocks.
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = begin; i < end; ++i) {
        double sum = 0.0;
        const auto upper = matrix.upper(i);
        for (std::int32_t k = 0; k < upper.count; ++k) sum += upper.value[k] * z_[upper.column[k]];
        const auto lower = matrix.lower(i);
        for (std::int32_t k = 0; k < lower.count; ++k)
          if (static_cast<std::size_t>(lower.column[k]) < begin)
            sum += lower.value[k] * z_[lower.column[k]];
        w_[i] = sum;
      }
    }
    coarse_right_.setZero();
    for (std::size_t i = 0; i < n; ++i) coarse_right_[cell_of_[i]] += w_[i];
    coarse_solution_ = factor_.solve(coarse_right_);
    for (std::size_t i = 0; i < n; ++i) z_[i] += coarse_solution_[cell_of_[i]];
    // Backward sweep on the residual that is left; outside the block the values are those before
    // it.
    before_ = z_;
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = end; i-- > begin;) {
        double sum = r_[i];
        const auto row = matrix.off_diagonal(i);
        for (std::int32_t k = 0; k < row.count; ++k) {
          const auto j = static_cast<std::size_t>(row.column[k]);
          sum += row.value[k] * (j >= begin && j < end ? z_[j] : before_[j]);
        }
        z_[i] = sum * inverse_diagonal_[i];
      }
    }
  }

  std::vector<double> r_, p_, q_, z_, w_, before_;
  std::vector<double> inverse_diagonal_;
  std::vector<std::int32_t> cell_of_;
  std::vector<std::int32_t> analysed_;
  std::vector<double> coefficients_;
  Eigen::SparseMatrix<double> coarse_;
  Eigen::CholmodSimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
  Eigen::VectorXd coarse_right_, coarse_solution_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_two_level_solver() {
  return std::make_unique<TwoLevel>();
}

}  // namespace sprung::sph
