#include "sph/probes.hpp"

#include <Eigen/Dense>

#include <stdexcept>

#include <algorithm>

namespace sprung::sph {

namespace {

/// 1, x, ..., x^2, xy, ... up to `order`.
template <int dim>
Eigen::VectorXd monomials(const Vector<dim>& x, int order) {
  std::vector<double> values{1.0};
  if (order >= 1)
    for (int d = 0; d < dim; ++d) values.push_back(x[d]);
  if (order >= 2)
    for (int d = 0; d < dim; ++d)
      for (int e = d; e < dim; ++e) values.push_back(x[d] * x[e]);
  return Eigen::Map<Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Value at the origin of the weighted polynomial fit to `values` at `offsets`.
template <int dim, typename Value>
Value fitted_value(const std::vector<Vector<dim>>& offsets, const std::vector<double>& weights,
                   const std::vector<Value>& values, int highest_order) {
  const auto n = static_cast<Eigen::Index>(offsets.size());
  if (n == 0) throw std::runtime_error("no particle lies near the place of a probe");
  for (int order = highest_order; order >= 0; --order) {
    const auto terms = monomials<dim>(Vector<dim>::Zero(), order).size();
    if (n < 2 * terms && order > 0) continue;
    Eigen::MatrixXd rows(n, terms);
    Eigen::Matrix<double, Eigen::Dynamic, Value::RowsAtCompileTime> right(n,
                                                                          Value::RowsAtCompileTime);
    for (Eigen::Index k = 0; k < n; ++k) {
      const double w = std::sqrt(weights[k]);
      rows.row(k) = w * monomials<dim>(offsets[k], order).transpose();
      right.row(k) = w * values[k].transpose();
    }
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> fit(rows);
    if (fit.rank() < terms && order > 0) continue;
    return fit.solve(right).row(0).transpose();
  }
  return Value::Zero();  // order 0 has returned already
}

}  // namespace

template <int dim>
std::vector<Vector<dim>> velocity_at(const State<dim>& state,
                                     const std::vector<Vector<dim>>& places) {
  const double dx = state.particles.spacing;
  const Kernel<dim> kernel(1.25 * state.kernel.smoothing_length());
  std::vector<Vector<dim>> extended;
  state.images.extend_for_viscosity(state.particles.velocity, extended);
  const auto& points = state.images.points();
  Support<dim> support;
  support.build_around(kernel, places, points, state.particles.volume);

  std::vector<Vector<dim>> result(places.size());
  std::vector<Vector<dim>> offsets, values;
  std::vector<double> weights;
  for (std::size_t p = 0; p < places.size(); ++p) {
    offsets.clear();
    values.clear();
    weights.clear();
    for (const std::int32_t j : support.of(p).index) {
      const Vector<dim> r = points[j] - places[p];
      offsets.push_back(r / dx);
      weights.push_back(kernel.value(r.norm()));
      values.push_back(extended[j]);
    }
    result[p] = fitted_value(offsets, weights, values, 2);
  }
  return result;
}

template <int dim>
std::vector<double> pressure_at(const State<dim>& state, const std::vector<Vector<dim>>& places) {
  const auto& particles = state.particles;
  const auto& points = state.images.points();
  const Kernel<dim> kernel(1.25 * state.kernel.smoothing_length());
  Support<dim> support;
  support.build_around(kernel, places, points, particles.volume);
  std::vector<double> result;
  for (std::size_t p = 0; p < places.size(); ++p) {
    std::vector<Vector<dim>> offsets;
    std::vector<double> weights;
    std::vector<Vector<1>> values;
    for (const std::int32_t j : support.of(p).index) {
      const std::int32_t source = state.images.source(j);
      // No pressure of their own: inflow columns; pressure columns stand for the side before them.
      if (static_cast<std::size_t>(source) >= particles.unknowns) continue;
      offsets.push_back((points[j] - places[p]) / particles.spacing);
      weights.push_back(kernel.value((points[j] - places[p]).norm()));
      values.push_back(Vector<1>(particles.pseudo_pressure[source]));
    }
    const double psi = fitted_value(offsets, weights, values, 2)[0];
    result.push_back(particles.density * (state.balanced_acceleration.dot(places[p]) - psi));
  }
  return result;
}

template <int dim>
std::vector<Vector<dim>> displacement_of(const ElasticSolid<dim>& solid,
                                         const Particles<dim>& particles, std::size_t first,
                                         std::size_t last, const std::vector<Vector<dim>>& points) {
  const auto& reference = solid.network().reference;
  const double dx = particles.spacing;
  std::vector<Vector<dim>> result;
  for (const auto& point : points) {
    std::vector<Vector<dim>> offsets, values;
    // A corner has few particles near it: look farther until there are twice as many as the fit has
    // terms.
    for (double reach = 2.1; offsets.size() < std::min<std::size_t>(2 * (dim + 1), last - first);
         reach += 0.5) {
      offsets.clear();
      values.clear();
      for (std::size_t i = first; i < last; ++i) {
        const Vector<dim> r = (reference[i] - point) / dx;
        if (r.norm() > reach) continue;
        offsets.push_back(r);
        values.push_back(particles.position[i] - reference[i]);
      }
    }
    const std::vector<double> weights(offsets.size(), 1.0);
    result.push_back(fitted_value(offsets, weights, values, 1));
  }
  return result;
}

template std::vector<double> pressure_at<2>(const State<2>&, const std::vector<Vector<2>>&);
template std::vector<double> pressure_at<3>(const State<3>&, const std::vector<Vector<3>>&);
template std::vector<Vector<2>> velocity_at<2>(const State<2>&, const std::vector<Vector<2>>&);
template std::vector<Vector<3>> velocity_at<3>(const State<3>&, const std::vector<Vector<3>>&);
template std::vector<Vector<2>> displacement_of<2>(const ElasticSolid<2>&, const Particles<2>&,
                                                   std::size_t, std::size_t,
                                                   const std::vector<Vector<2>>&);
template std::vector<Vector<3>> displacement_of<3>(const ElasticSolid<3>&, const Particles<3>&,
                                                   std::size_t, std::size_t,
                                                   const std::vector<Vector<3>>&);

}  // namespace sprung::sph
