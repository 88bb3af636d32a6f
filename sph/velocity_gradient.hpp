#pragma once
/// The velocity's gradient at a particle.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// Columns d/dx_k in 1/s: sum_j V (u_j - u_i) (grad W_ij)^T, made exact for linear fields where the
/// scene corrects gradients. `extended`: velocities of particles and images.
template <int dim>
Matrix<dim> velocity_gradient(const State<dim>& state, const std::vector<Vector<dim>>& extended,
                              std::size_t i) {
  const auto& points = state.images.points();
  const auto near = state.support.of(i);
  const Vector<dim> x = points[i], u = extended[i];
  OuterProductSum<dim> sum;
  for (std::size_t k = 0; k < near.index.size(); ++k) {
    const std::int32_t j = near.index[k];
    sum.add(near.gradient_factor[k], extended[j] - u, x - points[j]);
  }
  const Matrix<dim> gradient = state.particles.volume * sum.sum();
  if (state.gradient_correction.empty()) return gradient;
  return gradient * state.gradient_correction[i].full();
}

}  // namespace sprung::sph
