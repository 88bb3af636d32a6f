#pragma once
/// The time step that ACTION 8 as printed allows explicit springs.

#include "sph/effects/elastic_solid.hpp"

namespace sprung::sph {

/// Moving with the mean of old and new velocity, an elastic mode of frequency w that viscosity
/// damps at the rate c changes by the determinant 1 - c dt + w^2 dt^2 / 2 per step: without
/// viscosity it grows at any step, with it for dt > 2 c / w^2. Long shear waves have c = nu k^2 and
/// w^2 = C44 k^2 / rho, so that dt < 2 mu / C44 whatever the spacing. The lattice's fastest waves
/// are damped less: rows that move against each other along their normal, which the pressure does
/// not see, at the rate of the waves along an axis.
template <int dim>
class PrintedIntegratorLimit final : public TimeStepLimit<dim> {
 public:
  /// `dynamic_viscosity` in Pa s, `shear_stiffness` C44 in Pa; `solid` outlives the limit.
  PrintedIntegratorLimit(double dynamic_viscosity, double shear_stiffness,
                         const ElasticSolid<dim>& solid)
      : dynamic_viscosity_(dynamic_viscosity), shear_stiffness_(shear_stiffness), solid_(solid) {}
  double largest_time_step(const State<dim>& state) const override {
    const auto sums = lattice_sums(state.kernel, state.particles.spacing);
    const double decay =
        2.0 * dynamic_viscosity_ / state.particles.density * sums.decay_along_axis;
    const double frequency = solid_.fastest_mode(state).frequency;
    return kept_of_limit * std::min(2.0 * dynamic_viscosity_ / shear_stiffness_,
                                    2.0 * decay / (frequency * frequency));
  }
  std::string_view limit_name() const override { return "springs moved with the mean velocity"; }

 private:
  double dynamic_viscosity_, shear_stiffness_;
  const ElasticSolid<dim>& solid_;
};

}  // namespace sprung::sph
