#pragma once
/// The time step that ACTION 8 as printed allows explicit springs.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// Moving with the mean of old and new velocity, an elastic mode of frequency w that viscosity
/// damps at the rate c changes by the determinant 1 - c dt + w^2 dt^2 / 2 per step: without
/// viscosity it grows at any step. For shear waves c = nu k^2 and w^2 = C44 k^2 / rho, so the wave
/// number drops out and the limit is dt < 2 mu / C44, whatever the spacing; C44 is the lattice's
/// shear stiffness along its axes.
template <int dim>
class PrintedIntegratorLimit final : public TimeStepLimit<dim> {
 public:
  /// `dynamic_viscosity` in Pa s, `shear_stiffness` C44 in Pa.
  PrintedIntegratorLimit(double dynamic_viscosity, double shear_stiffness)
      : limit_(0.8 * 2.0 * dynamic_viscosity / shear_stiffness) {}
  double largest_time_step(const State<dim>&) const override { return limit_; }
  std::string limit_name() const override {
    return "springs moved with the mean velocity, 0.8 x 2 mu/C44";
  }

 private:
  double limit_;
};

}  // namespace sprung::sph
