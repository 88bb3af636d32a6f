#pragma once
/// The force of the fluid on a curved wall, from the momentum of the fluid about it.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// With a weight phi that is 1 at the wall and falls to 0 inside the fluid, the divergence theorem
/// turns the wall's integral into one over the fluid (Babuska and Miller 1984):
///
///   F = int_wall sigma . n = -int [ phi rho (Du/Dt - g) + sigma . grad phi ] dV,
///
/// so stresses are wanted only where no mirror particle takes part. Stresses fitted at the wall
/// itself are no substitute: the first rows next to a mirror carry a shear of their own, and the
/// drag of a cylinder 20 particles wide came out 10 % too large beside a flow whose momentum
/// balance was right to 0.3 %.
///
/// phi is 1 up to a support radius from the wall, then a cubic that reaches 0 four spacings
/// farther, or earlier where something else stands there: a side of the channel, another curved
/// wall, a body.
template <int dim>
class WallForce {
 public:
  /// `state` at the start; `wall` is at rest.
  WallForce(const State<dim>& state, const ShapedWall<dim>& wall);
  /// Why the force cannot be told from that on something else, in words; empty when it can.
  std::string obstacle() const;
  /// Force in the last step in N; N/m in the plane; without the fluid's inertia and stress before
  /// the first step. `dynamic_viscosity` in Pa s.
  Vector<dim> operator()(const State<dim>& state, double dynamic_viscosity) const;

 private:
  std::shared_ptr<const WallShape<dim>> shape_;
  std::vector<WallPatch<dim>> patches_;  ///< carry the balanced part of gravity, exactly
  double inner_, width_, least_width_;
  std::string nearest_;  ///< what stands nearest to the wall
};

}  // namespace sprung::sph
