#include "reference_fem/secants.hpp"

#include <algorithm>
#include <cmath>
#include <string>

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

}  // namespace

/// Least squares coefficients of `target` in the columns of dd_, by normal equations of the columns
/// scaled to length one, with a trace of damping: nearly parallel columns share, none explodes.
std::vector<double> Secants::coefficients(const std::vector<double>& target) const {
  constexpr double damping = 1e-11;
  const std::size_t n = dd_.size();
  std::vector<double> scale(n);
  for (std::size_t i = 0; i < n; ++i)
    scale[i] = gram_[i][i] > 0.0 ? 1.0 / std::sqrt(gram_[i][i]) : 0.0;
  std::vector<std::vector<double>> a(n, std::vector<double>(n + 1));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j)
      a[i][j] = scale[i] * scale[j] * gram_[std::max(i, j)][std::min(i, j)];
    a[i][i] += damping;
    a[i][n] = scale[i] * dot(dd_[i].velocity, target);
  }
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
  for (std::size_t i = 0; i < n; ++i) x[i] *= scale[i];
  return x;
}

void Secants::clear() {
  has_last_ = false;
  dx_.clear();
  dd_.clear();
  gram_.clear();
}

void Secants::learn(const Pair& x, const Pair& d) {
  if (dx_.size() == most) {
    dx_.erase(dx_.begin());
    dd_.erase(dd_.begin());
    gram_.erase(gram_.begin());
    for (auto& row : gram_) row.erase(row.begin());
  }
  dx_.push_back(
      {difference(x.velocity, last_x_.velocity), difference(x.pressure, last_x_.pressure)});
  dd_.push_back(
      {difference(d.velocity, last_d_.velocity), difference(d.pressure, last_d_.pressure)});
  append_gram_row();
}

/// Inner products of the newest entry of dd_ with all up to itself.
void Secants::append_gram_row() {
  const Pair& newest = dd_[gram_.size()];
  std::vector<double> row;
  for (std::size_t i = 0; i <= gram_.size(); ++i)
    row.push_back(dot(newest.velocity, dd_[i].velocity));
  gram_.push_back(std::move(row));
}

void Secants::save(Archive& archive) const {
  for (std::size_t i = 0; i < dx_.size(); ++i) {
    const std::string name = "secants/" + std::to_string(i) + "/";
    archive[name + "dx_velocity"] = dx_[i].velocity;
    archive[name + "dx_pressure"] = dx_[i].pressure;
    archive[name + "dd_velocity"] = dd_[i].velocity;
    archive[name + "dd_pressure"] = dd_[i].pressure;
  }
}

void Secants::restore(const Archive& archive) {
  clear();
  for (std::size_t i = 0; archive.contains("secants/" + std::to_string(i) + "/dx_velocity"); ++i) {
    const auto read = [&](const char* what) {
      return std::get<std::vector<double>>(archive.at("secants/" + std::to_string(i) + "/" + what));
    };
    dx_.push_back({read("dx_velocity"), read("dx_pressure")});
    dd_.push_back({read("dd_velocity"), read("dd_pressure")});
    append_gram_row();
  }
}

void Secants::accelerate(const std::vector<double>& velocity, const std::vector<double>& pressure,
                         std::vector<double>& velocity_step, std::vector<double>& pressure_step) {
  Pair x = {velocity, pressure}, d = {velocity_step, pressure_step};
  if (has_last_) learn(x, d);
  const auto gamma = coefficients(d.velocity);
  for (std::size_t j = 0; j < gamma.size(); ++j) {
    for (std::size_t i = 0; i < velocity_step.size(); ++i)
      velocity_step[i] -= gamma[j] * (dx_[j].velocity[i] + dd_[j].velocity[i]);
    for (std::size_t i = 0; i < pressure_step.size(); ++i)
      pressure_step[i] -= gamma[j] * (dx_[j].pressure[i] + dd_[j].pressure[i]);
  }
  last_x_ = std::move(x);
  last_d_ = std::move(d);
  has_last_ = true;
}

}  // namespace sprung::reference
