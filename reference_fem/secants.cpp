#include "reference_fem/secants.hpp"

#include <cmath>

namespace sprung::reference {
namespace {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> c(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) c[i] = a[i] - b[i];
  return c;
}

/// Least squares coefficients of `target` in `columns`, by normal equations with a trace of
/// damping: nearly parallel columns share, none explodes.
std::vector<double> coefficients(const std::vector<const std::vector<double>*>& columns,
                                 const std::vector<double>& target) {
  const std::size_t n = columns.size();
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1));
  double trace = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) a[i][j] = dot(*columns[i], *columns[j]);
    a[i][n] = dot(*columns[i], target);
    trace += a[i][i];
  }
  for (std::size_t i = 0; i < n; ++i) a[i][i] += 1e-12 * trace;
  for (std::size_t i = 0; i < n; ++i)  // positive definite: no pivoting needed
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = a[k][i] / a[i][i];
      for (std::size_t j = i; j <= n; ++j) a[k][j] -= factor * a[i][j];
    }
  std::vector<double> x(n);
  for (std::size_t i = n; i-- > 0;) {
    double sum = a[i][n];
    for (std::size_t j = i + 1; j < n; ++j) sum -= a[i][j] * x[j];
    x[i] = sum / a[i][i];
  }
  return x;
}

}  // namespace

void Secants::clear() {
  has_last_ = false;
  dx_.clear();
  dd_.clear();
}

void Secants::accelerate(const std::vector<double>& velocity, const std::vector<double>& pressure,
                         std::vector<double>& velocity_step, std::vector<double>& pressure_step) {
  const Pair d = {velocity_step, pressure_step};
  if (has_last_) {
    dx_.push_back({difference(velocity, last_x_.velocity), difference(pressure, last_x_.pressure)});
    dd_.push_back(
        {difference(d.velocity, last_d_.velocity), difference(d.pressure, last_d_.pressure)});
    if (dx_.size() > most) {
      dx_.erase(dx_.begin());
      dd_.erase(dd_.begin());
    }
    std::vector<const std::vector<double>*> columns;
    for (const Pair& pair : dd_) columns.push_back(&pair.velocity);
    const auto gamma = coefficients(columns, d.velocity);
    for (std::size_t j = 0; j < gamma.size(); ++j) {
      for (std::size_t i = 0; i < velocity_step.size(); ++i)
        velocity_step[i] -= gamma[j] * (dx_[j].velocity[i] + dd_[j].velocity[i]);
      for (std::size_t i = 0; i < pressure_step.size(); ++i)
        pressure_step[i] -= gamma[j] * (dx_[j].pressure[i] + dd_[j].pressure[i]);
    }
  }
  last_x_ = {velocity, pressure};
  last_d_ = d;
  has_last_ = true;
}

}  // namespace sprung::reference
