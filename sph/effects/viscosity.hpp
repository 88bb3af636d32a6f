#pragma once
/// Viscous diffusion, the term D of Eq. 2, advanced by Adams-Bashforth.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

template <int dim>
class ViscosityEffect final : public Acceleration<dim>, public TimeStepLimit<dim> {
 public:
  /// `kinematic_viscosity` in m2/s.
  ViscosityEffect(double kinematic_viscosity, Particles<dim>& particles);
  void add_acceleration(const State<dim>& state, std::vector<Vector<dim>>& acceleration) override;
  /// 0.125 h^2 / nu (Morris, Fox & Zhu 1997).
  double largest_time_step(const State<dim>& state) const override;
  std::string limit_name() const override { return "viscosity, 0.125 h^2/nu"; }

 private:
  double nu_;
  std::vector<Vector<dim>> previous_diffusion_;  ///< D of the step before, zero before the first
  std::vector<Vector<dim>> extended_velocity_;
};

}  // namespace sprung::sph
