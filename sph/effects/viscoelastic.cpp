#include "sph/effects/viscoelastic.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::sph {

template <int dim>
Viscoelastic<dim>::Viscoelastic(std::size_t first, std::vector<double> stiffness,
                                std::vector<std::int32_t> owner, double ratio,
                                double relaxation_time, Particles<dim>& particles,
                                const std::string& name)
    : BondLaw(first, first + stiffness.size()),
      stiffness_(std::move(stiffness)),
      relaxation_time_(relaxation_time) {
  for (double& k : stiffness_) k *= ratio;
  std::vector<std::int32_t> held(particles.solids, 0);
  std::int32_t arrays = 0;
  for (const std::int32_t particle : owner) {
    const std::int32_t slot = held[particle]++;
    place_.push_back({slot / dim, particle, slot % dim});
    arrays = std::max(arrays, slot / dim + 1);
  }
  carried_.assign(arrays, std::vector<Vector<dim>>(particles.size(), Vector<dim>::Zero()));
  for (std::int32_t a = 0; a < arrays; ++a)
    particles.carried.push_back({"viscoelastic_" + name + "_" + std::to_string(a), &carried_[a]});
}

template <int dim>
void Viscoelastic<dim>::add_tension(std::span<const double> /*extension*/,
                                    std::span<double> tension, std::span<double> slope) const {
  for (std::size_t k = first_; k < last_; ++k) {
    tension[k] += stiffness_[k - first_] * branch(k - first_);
    slope[k] += stiffness_[k - first_];
  }
}

template <int dim>
double Viscoelastic<dim>::steepest(std::size_t bond) const {
  return bond >= first_ && bond < last_ ? stiffness_[bond - first_] : 0.0;
}

template <int dim>
double Viscoelastic<dim>::energy(std::span<const double> /*extension*/) const {
  double energy = 0.0;
  for (std::size_t k = 0; k < stiffness_.size(); ++k)
    energy += 0.5 * stiffness_[k] * branch(k) * branch(k);
  return energy;
}

template <int dim>
void Viscoelastic<dim>::advance(std::span<const double> before, std::span<const double> now,
                                double time_step) {
  const double x = time_step / relaxation_time_;
  const double kept = std::exp(-x), taken = -std::expm1(-x) / x;
  for (std::size_t k = first_; k < last_; ++k) {
    double& q = branch(k - first_);
    q = q * kept + (now[k] - before[k]) * taken;
  }
}

template class Viscoelastic<2>;
template class Viscoelastic<3>;

}  // namespace sprung::sph
