#pragma once
/// The velocity's gradient at a particle.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// What a sweep over a particle's list tells at once.
template <int dim>
struct Surroundings {
  /// Of velocity, columns d/dx_k in 1/s: sum_j V (u_j - u_i) (grad W_ij)^T, made exact for linear
  /// fields where the scene corrects gradients.
  Matrix<dim> velocity_gradient;
  /// As the function of concentration.hpp.
  Vector<dim> towards_emptier_side;
};

/// `extended`: velocities of particles and images.
template <int dim>
Surroundings<dim> surroundings(const State<dim>& state, const std::vector<Vector<dim>>& extended,
                               std::size_t i) {
  const auto& points = state.images.points();
  const Vector<dim> x = points[i], u = extended[i];
  OuterProductSum<dim> outer;
  TwoVectors<dim> emptier{};
  for_each_two<dim>(state.support.of(i), [&](Two f, const auto& j) {
    const TwoVectors<dim> du = difference(u, extended, j);
    TwoVectors<dim> fr = difference(x, points, j);
    for (int d = 0; d < dim; ++d) emptier[d] -= fr[d] *= f;
    outer.add(du, fr);
  });
  Surroundings<dim> result{-state.particles.volume * outer.sum(), sum_of<dim>(emptier)};
  if (!state.gradient_correction.empty())
    result.velocity_gradient *= state.gradient_correction[i].full();
  return result;
}

template <int dim>
Matrix<dim> velocity_gradient(const State<dim>& state, const std::vector<Vector<dim>>& extended,
                              std::size_t i) {
  return surroundings(state, extended, i).velocity_gradient;
}

}  // namespace sprung::sph
