#pragma once
/// Particle shifting of Xu, Stansby & Laurence (2009, J. Comput. Phys. 228, Eqs. 25-29): fluid
/// particles move a little across streamlines towards the emptier side, and take the velocity of
/// the new place.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

template <int dim>
class XuShifting final : public Motion<dim> {
 public:
  explicit XuShifting(double coefficient) : coefficient_(coefficient) {}
  void add_displacement(State<dim>& state, std::vector<Vector<dim>>& displacement) override;

 private:
  double coefficient_;
  std::vector<Vector<dim>> extended_velocity_;
};

}  // namespace sprung::sph
