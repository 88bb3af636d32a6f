#pragma once
/// How evenly the particles fill the space about one of them.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// Minus the gradient of the concentration sum_j V W_ij at particle i, over V (1/m^(dim+1)): the
/// way to the emptier side.
template <int dim>
Vector<dim> towards_emptier_side(const State<dim>& state, std::size_t i) {
  const auto& points = state.images.points();
  const auto near = state.support.of(i);
  Vector<dim> sum = Vector<dim>::Zero();
  for (std::size_t k = 0; k < near.index.size(); ++k)
    sum -= near.gradient_factor[k] * (points[i] - points[near.index[k]]);
  return sum;
}

}  // namespace sprung::sph
