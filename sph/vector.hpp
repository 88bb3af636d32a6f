#pragma once
/// Vectors of the problem's dimension, and walks over lattices of them.

#include "scene/problem.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace sprung::sph {

template <int dim>
using Vector = Eigen::Matrix<double, dim, 1>;

/// The first `dim` coordinates of a scene's point.
template <int dim>
Vector<dim> as_vector(const Point& point) {
  Vector<dim> x;
  for (int d = 0; d < dim; ++d) x[d] = point[d];
  return x;
}

/// Calls `visit` with every multi-index below `count`, the first running fastest.
template <int dim, typename Visit>
void for_each_index(const std::array<long, dim>& count, Visit&& visit) {
  for (const long n : count)
    if (n <= 0) return;
  std::array<long, dim> at{};
  for (bool more = true; more;) {
    visit(at);
    int d = 0;
    while (d < dim && ++at[d] == count[d]) at[d++] = 0;
    more = d < dim;
  }
}

/// Coordinates one after the other, as records and checkpoints hold them.
template <int dim>
std::vector<double> flattened(const std::vector<Vector<dim>>& values) {
  std::vector<double> flat;
  flat.reserve(values.size() * dim);
  for (const auto& v : values)
    for (int d = 0; d < dim; ++d) flat.push_back(v[d]);
  return flat;
}

template <int dim>
void unflatten(const std::vector<double>& flat, std::vector<Vector<dim>>& values) {
  values.resize(flat.size() / dim);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (int d = 0; d < dim; ++d) values[i][d] = flat[i * dim + d];
}

}  // namespace sprung::sph
