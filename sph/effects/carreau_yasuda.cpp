#include "sph/effects/carreau_yasuda.hpp"

#include "sph/velocity_gradient.hpp"

namespace sprung::sph {

template <int dim>
void CarreauYasudaLaw<dim>::update(const State<dim>& state,
                                   const std::vector<Vector<dim>>& velocity) {
  const auto& particles = state.particles;
  const auto& points = state.images.points();
  const std::size_t n = particles.unknowns;
  const bool corrected = !state.gradient_correction.empty();
  ratio_.resize(n);
  gradient_.resize(n);
  ratio_gradient_.resize(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    const Matrix<dim> gradient = gradient_[i] = velocity_gradient(state, velocity, i);
    // 2 D:D with D = (G + G^T)/2.
    const double rate = std::sqrt(0.5 * (gradient + gradient.transpose()).squaredNorm());
    ratio_[i] = viscosity_ratio(law_, dynamic_, rate);
  }
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    const auto near = state.support.of(i);
    const bool solid = i < particles.solids;
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t k = 0; k < near.index.size(); ++k) {
      const auto s = static_cast<std::size_t>(state.images.source(near.index[k]));
      // A column or a body has no viscosity of the fluid's: there it is taken to be even.
      if (s >= n || (s < particles.solids) != solid) continue;
      sum +=
          near.gradient_factor[k] * (ratio_[s] - ratio_[i]) * (points[i] - points[near.index[k]]);
    }
    sum *= particles.volume;
    ratio_gradient_[i] = corrected ? state.gradient_correction[i] * sum : sum;
  }
}

template class CarreauYasudaLaw<2>;
template class CarreauYasudaLaw<3>;

}  // namespace sprung::sph
