#pragma once
/// Sweeps over a particle's list that take two pairs at a time, one in each half of a register: all
/// that every x86-64 processor offers. The compiler does not find this by itself, since what
/// belongs to a neighbour stands scattered in memory.

#include "sph/neighbours.hpp"
#include "sph/vector.hpp"

#include <array>
#include <cstddef>

namespace sprung::sph {

/// A number of each of two pairs.
using Two [[gnu::vector_size(16)]] = double;

inline double sum_of(Two a) {
  return a[0] + a[1];
}

/// A vector of each of two pairs.
template <int dim>
using TwoVectors = std::array<Two, dim>;

template <int dim>
Vector<dim> sum_of(const TwoVectors<dim>& a) {
  Vector<dim> sum;
  for (int d = 0; d < dim; ++d) sum[d] = sum_of(a[d]);
  return sum;
}

/// b - c[j] of both pairs.
template <int dim>
TwoVectors<dim> difference(const Vector<dim>& b, const std::vector<Vector<dim>>& c,
                           const std::array<std::int32_t, 2>& j) {
  TwoVectors<dim> result;
  for (int d = 0; d < dim; ++d) result[d] = b[d] - Two{c[j[0]][d], c[j[1]][d]};
  return result;
}

/// Calls visit(factors, neighbours) for two pairs of a list after the other. Beside the last of an
/// odd number stands the same neighbour again, with factor 0.
template <int dim, typename Visit>
[[gnu::always_inline]] inline void for_each_two(const typename Support<dim>::Neighbours& near,
                                                Visit&& visit) {
  const std::size_t n = near.index.size();
  const std::int32_t* const j = near.index.data();
  const double* const f = near.gradient_factor.data();
  for (std::size_t k = 0; k < n; k += 2) {
    const bool both = k + 1 < n;
    visit(Two{f[k], both ? f[k + 1] : 0.0},
          std::array<std::int32_t, 2>{j[k], both ? j[k + 1] : j[k]});
  }
}

}  // namespace sprung::sph
