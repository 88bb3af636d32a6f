#include "sph/pressure/first_guess.hpp"

namespace sprung::sph {

template <int dim>
void guess_newcomers(Particles<dim>& particles, const Support<dim>& support) {
  auto& psi = particles.pseudo_pressure;
  for (std::size_t i = particles.solids; i < particles.unknowns; ++i) {
    if (psi[i] != 0.0) continue;
    const auto near = support.inner(i);
    double sum = 0.0, weight = 0.0;
    for (std::size_t k = 0; k < near.index.size(); ++k) {
      const double other = psi[near.index[k]];
      if (other == 0.0) continue;
      sum += near.gradient_factor[k] * other;
      weight += near.gradient_factor[k];
    }
    if (weight != 0.0) psi[i] = sum / weight;
  }
}

template void guess_newcomers<2>(Particles<2>&, const Support<2>&);
template void guess_newcomers<3>(Particles<3>&, const Support<3>&);

}  // namespace sprung::sph
