#pragma once
/// A viscosity that depends on the shear rate: the law of Carreau and Yasuda, as a law of
/// ViscosityEffect.

#include "scene/problem.hpp"
#include "sph/effects/roles.hpp"
#include "sph/symmetric_form.hpp"

#include <cmath>

namespace sprung::sph {

/// Viscosity of the law over `dynamic`, at `rate` (1/s), the square root of 2 D:D.
inline double viscosity_ratio(const CarreauYasuda& law, double dynamic, double rate) {
  const double high = law.high_shear / dynamic;
  return high + (1.0 - high) * std::pow(1.0 + std::pow(law.relaxation_time * rate, law.transition),
                                        (law.power - 1.0) / law.transition);
}

template <int dim>
class CarreauYasudaLaw {
 public:
  /// `dynamic`: Pa s at vanishing shear rate.
  CarreauYasudaLaw(const CarreauYasuda& law, double dynamic) : law_(law), dynamic_(dynamic) {}

  /// Shear rates, viscosities and their gradients for the present velocities. `velocity`: of the
  /// particles and their images, as the viscous term sees it.
  void update(const State<dim>& state, const std::vector<Vector<dim>>& velocity);

  /// Viscosity of the pair over `dynamic`: the mean of the two (Brookshaw 1985; exact for a linear
  /// field). Across a body's surface and beside a prescribed column it is the fluid's own.
  double of_pair(const State<dim>& state, std::size_t i, std::int32_t j) const {
    const auto s = static_cast<std::size_t>(state.images.source(j));
    if (s >= ratio_.size()) return ratio_[i];
    const std::size_t solids = state.particles.solids;
    if ((i < solids) != (s < solids)) return ratio_[std::max(i, s)];  // solids have lower numbers
    return 0.5 * (ratio_[i] + ratio_[s]);
  }
  /// What div(2 nu D) has beside div(nu grad u): (grad u)^T grad nu, over the viscosity at rest.
  Vector<dim> beside(std::size_t i) const { return gradient_[i].transpose() * ratio_gradient_[i]; }

  double largest_ratio() const { return std::max(1.0, law_.high_shear / dynamic_); }
  /// Viscosity over `dynamic` of the particles with an equation.
  const std::vector<double>& ratio() const { return ratio_; }

 private:
  CarreauYasuda law_;
  double dynamic_;
  std::vector<double> ratio_;
  std::vector<Matrix<dim>> gradient_;  ///< of velocity: row the component, column the direction
  std::vector<Vector<dim>> ratio_gradient_;
};

}  // namespace sprung::sph
