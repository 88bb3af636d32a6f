#include "sph/pressure/solver.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::sph {

namespace {

/// Multiplicative and symmetric: forward Gauss-Seidel from zero, coarse correction, backward sweep.
/// The sweeps run inside blocks of fixed size side by side, so the bits do not depend on the
/// threads.
class TwoLevel final : public PressureSolver {
 public:
  void prepare(const PressureMatrix& matrix, const CellMap& map) override {
    const std::size_t n = matrix.rows();
    for (auto* v : {&r_, &p_, &q_, &z_, &w_}) v->resize(n);
    inverse_diagonal_.resize(n);
    for (std::size_t i = 0; i < n; ++i) inverse_diagonal_[i] = 1.0 / matrix.diagonal()[i];
    map_ = &map;
    levels_.build(matrix, map);
    coarse_residual_.resize(map.cells());
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

  /// z = M^-1 r.
  void precondition(const PressureMatrix& matrix) {
    const std::size_t n = matrix.rows();
    const auto blocks = static_cast<std::ptrdiff_t>((n + sweep_block - 1) / sweep_block);
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = begin; i < end; ++i) {
        double sum = r_[i];
        matrix.for_each_lower(i, [&](std::int32_t j, double a) {
          if (static_cast<std::size_t>(j) >= begin) sum += a * z_[j];
        });
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
        matrix.for_each_upper(i, [&](std::int32_t j, double a) { sum += a * z_[j]; });
        matrix.for_each_lower(i, [&](std::int32_t j, double a) {
          if (static_cast<std::size_t>(j) < begin) sum += a * z_[j];
        });
        w_[i] = sum;
      }
    }
    const auto& cell_of = map_->cell_of;
    std::fill(coarse_residual_.begin(), coarse_residual_.end(), 0.0);
    for (std::size_t i = 0; i < n; ++i) coarse_residual_[cell_of[i]] += w_[i];
    levels_.solve(coarse_residual_, coarse_correction_);
    for (std::size_t i = 0; i < n; ++i) z_[i] += coarse_correction_[cell_of[i]];
    // Backward sweep on the residual that is left; outside the block the values are those before
    // it.
    before_ = z_;
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = end; i-- > begin;) {
        double sum = r_[i];
        matrix.for_each(i, [&](std::int32_t column, double a) {
          const auto j = static_cast<std::size_t>(column);
          sum += a * (j >= begin && j < end ? z_[j] : before_[j]);
        });
        z_[i] = sum * inverse_diagonal_[i];
      }
    }
  }

  std::vector<double> r_, p_, q_, z_, w_, before_;
  std::vector<double> inverse_diagonal_;
  const CellMap* map_ = nullptr;
  CellLevels levels_;
  std::vector<double> coarse_residual_, coarse_correction_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_two_level_solver() {
  return std::make_unique<TwoLevel>();
}

}  // namespace sprung::sph
