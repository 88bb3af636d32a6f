#pragma once
/// Viscous diffusion, the term D of Eq. 2, advanced by Adams-Bashforth.

#include "sph/effects/roles.hpp"
#include "sph/effects/solid_surface.hpp"

#include <memory>

namespace sprung::sph {

template <int dim>
class ViscosityEffect final : public Acceleration<dim>, public TimeStepLimit<dim> {
 public:
  /// `kinematic_viscosity` in m2/s.
  /// `surface`: where the scene has bodies, the place of the no-slip condition on them; else null.
  ViscosityEffect(double kinematic_viscosity, Particles<dim>& particles,
                  std::shared_ptr<SolidSurface<dim>> surface);
  void add_acceleration(const State<dim>& state, std::vector<Vector<dim>>& acceleration) override;
  /// 0.125 h^2 / nu (Morris, Fox & Zhu 1997).
  double largest_time_step(const State<dim>& state) const override;
  std::string limit_name() const override { return "viscosity, 0.125 h^2/nu"; }

 private:
  Vector<dim> corrected_sum(const State<dim>& state, std::size_t i,
                            const typename Support<dim>::Neighbours& near) const;
  Vector<dim> beyond_surface(const State<dim>& state, std::size_t i,
                             const typename Support<dim>::Neighbours& near) const;
  double nu_;
  std::shared_ptr<SolidSurface<dim>> surface_;
  std::vector<Vector<dim>> previous_diffusion_;  ///< D of the step before, zero before the first
  std::vector<Vector<dim>> extended_velocity_;
};

}  // namespace sprung::sph
