#include "sph/effects/gravity.hpp"

namespace sprung::sph {

template <int dim>
GravityEffect<dim>::GravityEffect(const Gravity& gravity, const std::vector<PeriodicAxis>& periodic)
    : balanced_(as_vector<dim>(gravity.acceleration)),
      driving_(Vector<dim>::Zero()),
      waveform_(gravity.waveform) {
  for (const auto& p : periodic) std::swap(balanced_[p.axis], driving_[p.axis]);
}

template <int dim>
void GravityEffect<dim>::set(State<dim>& state) {
  const Clock& clock = state.clock;
  state.balanced_acceleration = waveform_.value(clock.time) * balanced_;
  state.driving_acceleration = waveform_.value(clock.time - 0.5 * clock.time_step) * driving_;
}

/// The mean over the step: the force at the middle of it.
template <int dim>
void GravityEffect<dim>::add_acceleration(const State<dim>& state,
                                          std::vector<Vector<dim>>& acceleration) {
  const double middle = state.clock.time + 0.5 * state.clock.time_step;
  const Vector<dim> a = waveform_.value(middle) * driving_;
  for (auto& sum : acceleration) sum += a;
}

template class GravityEffect<2>;
template class GravityEffect<3>;

}  // namespace sprung::sph
