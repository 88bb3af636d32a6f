#pragma once
/// Particle shifting: fluid particles move a little towards the emptier side, and take the velocity
/// of the new place to first order.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// Xu, Stansby & Laurence (2009, J. Comput. Phys. 228, Eqs. 25-29): by C u_max dt along
/// r_mean^2 sum_j r_ij / |r_ij|^3.
struct XuDirection {
  static constexpr double default_coefficient = 0.04;
};

/// Lind, Xu, Stansby & Rogers (2012, J. Comput. Phys. 231, Eqs. 18-25) in the form of Skillen et
/// al. (2013): by C h u_max dt down the gradient of concentration, sum_j V grad W_ij. Their second
/// part against pairs, 0.2 (W_ij / W(dx))^4 in the sum, is left out: it depends on the order of the
/// particles and not on their number alone, so it moves them from sheared rows to orderly ones for
/// ever, and the velocity that brings them back carries momentum across the flow (sph/METHOD.md).
struct FickianDirection {
  static constexpr double default_coefficient = 0.5;
};

/// The same direction by C h dt max(h |grad u|, u_max / 10), with the particle's own velocity
/// gradient (Frobenius norm): disorder grows as neighbours slide past each other, not as the fluid
/// flows, so what shifting costs falls with the spacing. The second part is for places where the
/// disorder arrives before the shear does (sph/METHOD.md).
struct SlidingDirection : FickianDirection {
  static constexpr double default_coefficient = 6.0;
  static constexpr double least_part = 1.0 / 10.0;  ///< of the fastest velocity
};

template <int dim, typename Direction>
class ShiftingEffect final : public Motion<dim> {
 public:
  explicit ShiftingEffect(double coefficient) : coefficient_(coefficient) {}
  void add_displacement(State<dim>& state, std::vector<Vector<dim>>& displacement) override;

 private:
  /// Displacement of particle i per length C u dt, u the direction's speed.
  Vector<dim> direction(const State<dim>& state, std::size_t i,
                        const Vector<dim>& emptier_side) const;
  double coefficient_;
};

}  // namespace sprung::sph
