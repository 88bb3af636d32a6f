#include "sph/pressure/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::sph {

namespace {

class ConjugateGradients final : public PressureSolver {
 public:
  explicit ConjugateGradients(std::unique_ptr<Preconditioner> preconditioner)
      : preconditioner_(std::move(preconditioner)) {}

  void prepare(const PressureMatrix& matrix, const CellMap& map) override {
    for (auto* v : {&r_, &p_, &q_, &z_}) v->resize(matrix.rows());
    preconditioner_->prepare(matrix, map);
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
    constexpr int most_iterations = 5000;
    while (report.relative_residual > tolerance && report.iterations < most_iterations) {
      preconditioner_->apply(matrix, r_, z_);
      const double rz_next = dot(r_, z_);
      const double beta = report.iterations == 0 ? 0.0 : rz_next / rz;
      rz = rz_next;
      if (report.iterations == 0) p_.assign(n, 0.0);
      for (std::size_t i = 0; i < n; ++i) p_[i] = z_[i] + beta * p_[i];
      matrix.multiply(p_, q_);
      const double alpha = rz / dot(p_, q_);
      if (!std::isfinite(alpha)) break;
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
  std::unique_ptr<Preconditioner> preconditioner_;
  std::vector<double> r_, p_, q_, z_;
};

class Diagonal final : public Preconditioner {
 public:
  void prepare(const PressureMatrix&, const CellMap&) override {}
  void apply(const PressureMatrix& matrix, const std::vector<double>& r,
             std::vector<double>& z) override {
    for (std::size_t i = 0; i < r.size(); ++i) z[i] = r[i] / matrix.diagonal()[i];
  }
};

}  // namespace

std::unique_ptr<PressureSolver> conjugate_gradients(
    std::unique_ptr<Preconditioner> preconditioner) {
  return std::make_unique<ConjugateGradients>(std::move(preconditioner));
}

std::unique_ptr<PressureSolver> make_jacobi_solver() {
  return conjugate_gradients(std::make_unique<Diagonal>());
}

}  // namespace sprung::sph
