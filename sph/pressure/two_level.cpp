#include "sph/pressure/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::sph {

namespace {

/// Multiplicative and symmetric: forward Gauss-Seidel from zero, coarse correction, backward sweep.
/// The sweeps run inside blocks of fixed size side by side, so the bits do not depend on the
/// threads.
class TwoLevel final : public Preconditioner {
 public:
  void prepare(const PressureMatrix& matrix, const CellMap& map) override {
    const std::size_t n = matrix.rows();
    w_.resize(n);
    inverse_diagonal_.resize(n);
    for (std::size_t i = 0; i < n; ++i) inverse_diagonal_[i] = 1.0 / matrix.diagonal()[i];
    map_ = &map;
    levels_.build(matrix, map);
    coarse_residual_.resize(map.cells());
  }

  void apply(const PressureMatrix& matrix, const std::vector<double>& r,
             std::vector<double>& z) override {
    forward_sweep(matrix, r, z);
    const auto& cell_of = map_->cell_of;
    std::fill(coarse_residual_.begin(), coarse_residual_.end(), 0.0);
    for (std::size_t i = 0; i < w_.size(); ++i) coarse_residual_[cell_of[i]] += w_[i];
    levels_.solve(coarse_residual_, coarse_correction_);
    for (std::size_t i = 0; i < w_.size(); ++i) z[i] += coarse_correction_[cell_of[i]];
    backward_sweep(matrix, r, z);
  }

 private:
  static constexpr std::size_t sweep_block = 2048;

  /// (D - L) z = r within each block; then w = r - A z.
  void forward_sweep(const PressureMatrix& matrix, const std::vector<double>& r,
                     std::vector<double>& z) {
    const std::size_t n = matrix.rows();
    const auto blocks = static_cast<std::ptrdiff_t>((n + sweep_block - 1) / sweep_block);
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = begin; i < end; ++i) {
        double sum = r[i];
        matrix.for_each_lower(i, [&](std::int32_t j, double a) {
          if (static_cast<std::size_t>(j) >= begin) sum += a * z[j];
        });
        z[i] = sum * inverse_diagonal_[i];
      }
    }
    // (D - L) z = r inside a block, so the residual r - A z is what the sweep has not seen: the
    // columns right of the diagonal, and those left of it in other blocks.
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = begin; i < end; ++i) {
        double sum = 0.0;
        matrix.for_each_upper(i, [&](std::int32_t j, double a) { sum += a * z[j]; });
        matrix.for_each_lower(i, [&](std::int32_t j, double a) {
          if (static_cast<std::size_t>(j) < begin) sum += a * z[j];
        });
        w_[i] = sum;
      }
    }
  }

  /// On the residual that is left; outside the block the values are those before it.
  void backward_sweep(const PressureMatrix& matrix, const std::vector<double>& r,
                      std::vector<double>& z) {
    const std::size_t n = matrix.rows();
    const auto blocks = static_cast<std::ptrdiff_t>((n + sweep_block - 1) / sweep_block);
    before_ = z;
#pragma omp parallel for schedule(static)
    for (std::ptrdiff_t b = 0; b < blocks; ++b) {
      const std::size_t begin = b * sweep_block, end = std::min(n, begin + sweep_block);
      for (std::size_t i = end; i-- > begin;) {
        double sum = r[i];
        matrix.for_each(i, [&](std::int32_t column, double a) {
          const auto j = static_cast<std::size_t>(column);
          sum += a * (j >= begin && j < end ? z[j] : before_[j]);
        });
        z[i] = sum * inverse_diagonal_[i];
      }
    }
  }

  std::vector<double> w_, before_;
  std::vector<double> inverse_diagonal_;
  const CellMap* map_ = nullptr;
  CellLevels levels_;
  std::vector<double> coarse_residual_, coarse_correction_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_two_level_solver() {
  return conjugate_gradients(std::make_unique<TwoLevel>());
}

}  // namespace sprung::sph
