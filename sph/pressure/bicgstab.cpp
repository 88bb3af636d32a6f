#include "sph/pressure/solver.hpp"

#include <cmath>

namespace sprung::sph {

double dot(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t block = 1024;
  const std::size_t n = a.size();
  const std::size_t blocks = (n + block - 1) / block;
  static thread_local std::vector<double> partial;
  partial.resize(blocks);
  double* const sums = partial.data();
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < blocks; ++p) {
    const std::size_t end = std::min(n, (p + 1) * block);
    double sum = 0.0;
    for (std::size_t i = p * block; i < end; ++i) sum += a[i] * b[i];
    sums[p] = sum;
  }
  double sum = 0.0;
  for (std::size_t p = 0; p < blocks; ++p) sum += sums[p];
  return sum;
}

void remove_mean(std::span<double> values) {
  double mean = 0.0;
  for (const double value : values) mean += value;
  mean /= static_cast<double>(values.size());
  for (double& value : values) value -= mean;
}

namespace {

class Bicgstab final : public PressureSolver {
 public:
  void prepare(const PressureMatrix& matrix, const CellMap&) override {
    const std::size_t n = matrix.rows();
    for (auto* v : {&r_, &r0_, &p_, &v_, &s_, &t_, &y_, &z_}) v->assign(n, 0.0);
  }

  SolveReport solve(const PressureMatrix& matrix, std::span<const double> b, std::span<double> x,
                    double tolerance) override {
    const std::size_t n = matrix.rows();
    const auto& diagonal = matrix.diagonal();
    const double norm_b = std::sqrt(dot(b, b));
    if (norm_b == 0.0) {
      std::fill(x.begin(), x.end(), 0.0);
      return {};
    }
    matrix.multiply(x, r_);
    for (std::size_t i = 0; i < n; ++i) r_[i] = b[i] - r_[i];
    r0_ = r_;
    double rho = 1.0, alpha = 1.0, omega = 1.0;
    std::fill(p_.begin(), p_.end(), 0.0);
    std::fill(v_.begin(), v_.end(), 0.0);
    SolveReport report;
    report.relative_residual = std::sqrt(dot(r_, r_)) / norm_b;
    constexpr int most_iterations = 5000;
    while (report.relative_residual > tolerance && report.iterations < most_iterations) {
      const double rho_next = dot(r0_, r_);
      const double beta = rho_next / rho * (alpha / omega);
      rho = rho_next;
      for (std::size_t i = 0; i < n; ++i) {
        p_[i] = r_[i] + beta * (p_[i] - omega * v_[i]);
        y_[i] = p_[i] / diagonal[i];
      }
      matrix.multiply(y_, v_);
      alpha = rho / dot(r0_, v_);
      for (std::size_t i = 0; i < n; ++i) {
        s_[i] = r_[i] - alpha * v_[i];
        z_[i] = s_[i] / diagonal[i];
      }
      matrix.multiply(z_, t_);
      const double tt = dot(t_, t_);
      omega = tt > 0.0 ? dot(t_, s_) / tt : 0.0;
      for (std::size_t i = 0; i < n; ++i) {
        x[i] += alpha * y_[i] + omega * z_[i];
        r_[i] = s_[i] - omega * t_[i];
      }
      ++report.iterations;
      report.relative_residual = std::sqrt(dot(r_, r_)) / norm_b;
      if (omega == 0.0 || rho == 0.0) break;
    }
    report.converged = report.relative_residual <= tolerance;
    return report;
  }

 private:
  std::vector<double> r_, r0_, p_, v_, s_, t_, y_, z_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_bicgstab_solver() {
  return std::make_unique<Bicgstab>();
}

}  // namespace sprung::sph
