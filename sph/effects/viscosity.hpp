#pragma once
/// Viscous diffusion, the term D of Eq. 2, advanced by Adams-Bashforth.

#include "sph/effects/carreau_yasuda.hpp"
#include "sph/effects/roles.hpp"
#include "sph/effects/solid_surface.hpp"

#include <memory>

namespace sprung::sph {

/// The law of a fluid whose viscosity is the same everywhere. What it answers is known when the
/// sweep is compiled, so the sweep is what it would be without a law.
template <int dim>
struct Newtonian {
  void update(const State<dim>&, const std::vector<Vector<dim>>&) {}
  static constexpr double of_pair(const State<dim>&, std::size_t, std::int32_t) { return 1.0; }
  static constexpr double largest_ratio() { return 1.0; }
  /// D is nu times the Laplacian, so the last one tells how the profile bends at a wall.
  static constexpr bool diffusion_is_laplacian = true;
};

/// `Law`: Newtonian or CarreauYasudaLaw, viscosities over `kinematic_viscosity`.
template <int dim, class Law = Newtonian<dim>>
class ViscosityEffect final : public Acceleration<dim>, public TimeStepLimit<dim> {
 public:
  /// `kinematic_viscosity` in m2/s.
  /// `surface`: where the scene has bodies, the place of the no-slip condition on them; else null.
  ViscosityEffect(double kinematic_viscosity, Particles<dim>& particles,
                  std::shared_ptr<SolidSurface<dim>> surface, Law law = {});
  void add_acceleration(const State<dim>& state, std::vector<Vector<dim>>& acceleration) override;
  /// With the largest viscosity that the law gives: the lattice's fastest mode and what bodies add.
  FastestMode fastest_mode(const State<dim>& state) const override;
  std::string_view limit_name() const override { return "viscosity"; }

 private:
  Vector<dim> corrected_sum(const State<dim>& state, std::size_t i,
                            const typename Support<dim>::Neighbours& near) const;
  Vector<dim> beyond_surface(const State<dim>& state, std::size_t i,
                             const typename Support<dim>::Neighbours& near,
                             Eigen::Matrix<double, dim, dim>* moment) const;
  double rate_beyond_surface(const State<dim>& state) const;
  double nu_;
  Law law_;
  std::shared_ptr<SolidSurface<dim>> surface_;
  std::vector<Vector<dim>> previous_diffusion_;  ///< D of the step before, zero before the first
  std::vector<Vector<dim>> diffusion_before_;    ///< the same while a step overwrites it
  std::vector<Eigen::Matrix<double, dim, dim>> moment_;  ///< of the fluid's pull, per solid
  std::vector<Vector<dim>> carried_;                     ///< what it adds at the surface
  mutable std::vector<double> rate_;                     ///< of rate_beyond_surface
};

}  // namespace sprung::sph
