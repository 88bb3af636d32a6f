#pragma once
/// Springs that grow stiffer as they are stretched: the toe of soft tissue.

#include "scene/problem.hpp"
#include "sph/effects/bond_law.hpp"

#include <vector>

namespace sprung::sph {

/// The slope of a bond's tension over its strain e grows linearly from its own at e = 0 to `ratio`
/// times that at the toe strain, and stays: beside the linear spring a tension k L (ratio - 1) x
/// (e2/(2 toe) for 0 < e < toe, e - toe/2 beyond). Bonds that are pushed stay linear. k: stiffness
/// in the bulk; the surface correction does not reach it.
class Stiffening final : public BondLaw {
 public:
  /// `stiffness` (N/m) and `rest_length` (m): of the bonds from `first` on.
  Stiffening(std::size_t first, std::vector<double> stiffness, std::vector<double> rest_length,
             const StrainStiffening& law);
  void add_tension(std::span<const double> extension, std::span<double> tension,
                   std::span<double> slope) const override;
  double steepest(std::size_t bond) const override;
  double energy(std::span<const double> extension) const override;

 private:
  std::vector<double> stiffness_, rest_length_;
  StrainStiffening law_;
};

}  // namespace sprung::sph
