#include "sph/effects/stiffening.hpp"

namespace sprung::sph {

Stiffening::Stiffening(std::size_t first, std::vector<double> stiffness,
                       std::vector<double> rest_length, const StrainStiffening& law)
    : BondLaw(first, first + stiffness.size()),
      stiffness_(std::move(stiffness)),
      rest_length_(std::move(rest_length)),
      law_(law) {}

void Stiffening::add_tension(std::span<const double> extension, std::span<double> tension,
                             std::span<double> slope) const {
  for (std::size_t k = first_; k < last_; ++k) {
    if (extension[k] <= 0.0) continue;
    const double more = (law_.ratio - 1.0) * stiffness_[k - first_];
    const double toe = law_.toe_strain * rest_length_[k - first_];
    const bool within = extension[k] < toe;
    tension[k] +=
        more * (within ? 0.5 * extension[k] * extension[k] / toe : extension[k] - 0.5 * toe);
    slope[k] += more * (within ? extension[k] / toe : 1.0);
  }
}

double Stiffening::steepest(std::size_t bond) const {
  return bond >= first_ && bond < last_ ? (law_.ratio - 1.0) * stiffness_[bond - first_] : 0.0;
}

double Stiffening::energy(std::span<const double> extension) const {
  double energy = 0.0;
  for (std::size_t k = first_; k < last_; ++k) {
    if (extension[k] <= 0.0) continue;
    const double toe = law_.toe_strain * rest_length_[k - first_], e = extension[k];
    energy += (law_.ratio - 1.0) * stiffness_[k - first_] *
              (e < toe ? e * e * e / (6.0 * toe) : 0.5 * e * e - 0.5 * toe * e + toe * toe / 6.0);
  }
  return energy;
}

}  // namespace sprung::sph
