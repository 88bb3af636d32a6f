#pragma once
/// Springs with a memory: a Maxwell branch beside each bond (the standard linear solid).

#include "sph/effects/bond_law.hpp"
#include "sph/particles.hpp"

#include <array>
#include <vector>

namespace sprung::sph {

/// Spring and dashpot in a row: the branch's spring is extended by q, dq/dt = d(extension)/dt -
/// q/relaxation_time, and pulls with ratio x k q. For extensions that vary linearly over a step
///   q_new = q exp(-x) + (extension_new - extension_old) (1 - exp(-x))/x,  x = dt/relaxation_time,
/// is exact. k: stiffness in the bulk; the surface correction does not reach it. The q of the bonds
/// are carried with the particles, each by a particle that the bond ties, so that a run resumes as
/// it was paused.
template <int dim>
class Viscoelastic final : public BondLaw {
 public:
  /// `owner`: a particle of each bond from `first` on, its solids' numbers. The arrays are carried
  /// by `particles`.
  Viscoelastic(std::size_t first, std::vector<double> stiffness, std::vector<std::int32_t> owner,
               double ratio, double relaxation_time, Particles<dim>& particles,
               const std::string& name);
  void add_tension(std::span<const double> extension, std::span<double> tension,
                   std::span<double> slope) const override;
  double steepest(std::size_t bond) const override;
  double energy(std::span<const double> extension) const override;
  void advance(std::span<const double> before, std::span<const double> now,
               double time_step) override;

 private:
  double& branch(std::size_t k) {
    return carried_[place_[k].array][place_[k].particle][place_[k].component];
  }
  double branch(std::size_t k) const {
    return carried_[place_[k].array][place_[k].particle][place_[k].component];
  }

  struct Place {
    std::int32_t array, particle, component;
  };
  std::vector<double> stiffness_;  ///< of the branch, N/m
  double relaxation_time_;
  std::vector<Place> place_;
  std::vector<std::vector<Vector<dim>>> carried_;
};

}  // namespace sprung::sph
