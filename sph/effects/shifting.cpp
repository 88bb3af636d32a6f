#include "sph/effects/shifting.hpp"

#include "sph/velocity_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace sprung::sph {

template <int dim, typename Direction>
Vector<dim> ShiftingEffect<dim, Direction>::direction(const State<dim>& state, std::size_t i,
                                                      const Vector<dim>& emptier_side) const {
  if constexpr (std::is_base_of_v<FickianDirection, Direction>)
    return state.kernel.smoothing_length() * state.particles.volume * emptier_side;
  const auto near = state.support.of(i);
  const auto& points = state.images.points();
  Vector<dim> sum = Vector<dim>::Zero();
  double mean_distance = 0.0;
  for (const std::int32_t j : near.index) {
    const Vector<dim> r = points[i] - points[j];
    const double d2 = r.squaredNorm(), d = std::sqrt(d2);
    sum += (1.0 / (d * d2)) * r;
    mean_distance += d;
  }
  mean_distance /= static_cast<double>(near.index.size());
  return mean_distance * mean_distance * sum;
}

template <int dim, typename Direction>
void ShiftingEffect<dim, Direction>::add_displacement(State<dim>& state,
                                                      std::vector<Vector<dim>>& displacement) {
  auto& particles = state.particles;
  auto& extended = state.extended_velocity;
  state.images.extend_for_viscosity(particles.velocity, extended);
  constexpr bool local = std::is_same_v<Direction, SlidingDirection>;
  const double dt = state.clock.time_step, h = state.kernel.smoothing_length();
  const double fastest = sph::fastest(particles);
  // A particle is never moved by more than a tenth of the spacing, in any direction.
  const double cap = 0.1 * particles.spacing;
  const std::size_t n = particles.unknowns;
#pragma omp parallel for schedule(static)
  for (std::size_t i = particles.solids; i < n; ++i) {
    if (state.support.of(i).index.empty()) continue;
    const auto [gradient, emptier_side] = surroundings(state, extended, i);
    double speed = fastest;
    if constexpr (local)
      speed = std::max(h * gradient.norm(), SlidingDirection::least_part * fastest);
    Vector<dim> shift = coefficient_ * speed * dt * direction(state, i, emptier_side);
    const double length = shift.norm();
    if (length > cap) shift *= cap / length;
    displacement[i] += shift;
    particles.velocity[i] += gradient * shift;
  }
}

template class ShiftingEffect<2, XuDirection>;
template class ShiftingEffect<3, XuDirection>;
template class ShiftingEffect<2, SlidingDirection>;
template class ShiftingEffect<3, SlidingDirection>;
template class ShiftingEffect<2, FickianDirection>;
template class ShiftingEffect<3, FickianDirection>;

}  // namespace sprung::sph
