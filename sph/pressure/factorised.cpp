/// Solvers that factorise the assembled matrix: completely (CHOLMOD), or incompletely as a
/// preconditioner (Eigen).

#include "sph/pressure/assembled.hpp"
#include "sph/pressure/conjugate_gradients.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/IterativeLinearSolvers>

#include <cmath>
#include <stdexcept>

namespace sprung::sph {

namespace {

using Columns = Eigen::SparseMatrix<double>;

class Cholmod final : public PressureSolver {
 public:
  void prepare(const PressureMatrix& matrix, const CellMap&) override {
    // The lower triangle by rows is the upper one by columns, and symmetric.
    const Columns lower = assembled(matrix, Part::lower, 1e-9);
    factor_.compute(lower);
    if (factor_.info() != Eigen::Success)
      throw std::runtime_error(
          "the pressure matrix is not positive definite: particles overlap or have left the "
          "domain");
    residual_.resize(matrix.rows());
  }
  /// Two steps of refinement at most: the factors of a singular matrix are those of a slightly
  /// different one.
  SolveReport solve(const PressureMatrix& matrix, std::span<const double> b, std::span<double> x,
                    double tolerance) override {
    const auto n = static_cast<Eigen::Index>(matrix.rows());
    const double norm_b = std::sqrt(dot(b, b));
    std::fill(x.begin(), x.end(), 0.0);
    SolveReport report;
    if (norm_b == 0.0) return report;
    std::copy(b.begin(), b.end(), residual_.begin());
    do {
      const Eigen::VectorXd step =
          factor_.solve(Eigen::Map<const Eigen::VectorXd>(residual_.data(), n));
      for (Eigen::Index i = 0; i < n; ++i) x[i] += step[i];
      matrix.multiply(x, residual_);
      for (Eigen::Index i = 0; i < n; ++i) residual_[i] = b[i] - residual_[i];
      ++report.iterations;
      report.relative_residual = std::sqrt(dot(residual_, residual_)) / norm_b;
      report.converged = report.relative_residual <= tolerance;
    } while (!report.converged && report.iterations < 3);
    return report;
  }

 private:
  Eigen::CholmodDecomposition<Columns, Eigen::Lower> factor_;
  std::vector<double> residual_;
};

class IncompleteCholesky final : public Preconditioner {
 public:
  void prepare(const PressureMatrix& matrix, const CellMap&) override {
    const Columns lower = assembled(matrix, Part::lower, 1e-6);
    factor_.compute(lower);
    if (factor_.info() != Eigen::Success)
      throw std::runtime_error("the incomplete factorisation of the pressure matrix failed");
  }
  void apply(const PressureMatrix&, const std::vector<double>& r, std::vector<double>& z) override {
    const auto n = static_cast<Eigen::Index>(r.size());
    Eigen::Map<Eigen::VectorXd>(z.data(), n) =
        factor_.solve(Eigen::Map<const Eigen::VectorXd>(r.data(), n));
  }

 private:
  Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>> factor_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_cholmod_solver() {
  return std::make_unique<Cholmod>();
}

std::unique_ptr<PressureSolver> make_incomplete_cholesky_solver() {
  return conjugate_gradients(std::make_unique<IncompleteCholesky>());
}

}  // namespace sprung::sph
