#pragma once
/// How evenly the particles fill the space about one of them.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// Minus the gradient of the concentration sum_j V W_ij at particle i, over V (1/m^(dim+1)): the
/// way to the emptier side.
template <int dim>
Vector<dim> towards_emptier_side(const State<dim>& state, std::size_t i) {
  const auto& points = state.images.points();
  const Vector<dim> x = points[i];
  TwoVectors<dim> sum{};
  for_each_two<dim>(state.support.of(i), [&](Two f, const auto& j) {
    const TwoVectors<dim> r = difference(x, points, j);
    for (int d = 0; d < dim; ++d) sum[d] -= f * r[d];
  });
  return sum_of<dim>(sum);
}

}  // namespace sprung::sph
