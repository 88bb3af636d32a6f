#pragma once
/// A uniform force per mass, ACTION 4.
///
/// All particles have the same density, so along an axis that ends at walls or open sides the
/// force only adds rho a . x to the pressure: that part is taken out of the equations exactly
/// (State::balanced_acceleration), and a fluid at rest stays at rest to the last bit. Along a
/// periodic axis no pressure can balance it, and it drives the flow.

#include "scene/problem.hpp"
#include "sph/effects/roles.hpp"

namespace sprung::sph {

template <int dim>
class GravityEffect final : public Acceleration<dim>, public TimeDependence<dim> {
 public:
  GravityEffect(const Gravity& gravity, const std::vector<PeriodicAxis>& periodic);
  void set(State<dim>& state) override;
  void add_acceleration(const State<dim>& state, std::vector<Vector<dim>>& acceleration) override;
  bool drives() const { return driving_.norm() > 0.0; }

 private:
  Vector<dim> balanced_, driving_;
  Waveform waveform_;
};

}  // namespace sprung::sph
