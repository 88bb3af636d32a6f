#include "sph/effects/shifting.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::sph {

template <int dim>
void XuShifting<dim>::add_displacement(State<dim>& state, std::vector<Vector<dim>>& displacement) {
  auto& particles = state.particles;
  const auto& points = state.images.points();
  state.images.extend_for_viscosity(particles.velocity, extended_velocity_);
  double fastest2 = 0.0;
  for (std::size_t i = 0; i < particles.unknowns; ++i)
    fastest2 = std::max(fastest2, particles.velocity[i].squaredNorm());
  const double reach = coefficient_ * std::sqrt(fastest2) * state.clock.time_step;
  // A particle is never moved by more than a tenth of the spacing, in any direction.
  const double cap = 0.1 * particles.spacing;
  const std::size_t n = particles.unknowns;
#pragma omp parallel for schedule(static)
  for (std::size_t i = particles.solids; i < n; ++i) {
    const auto neighbours = state.support.of(i);
    const std::size_t count = neighbours.index.size();
    if (count == 0) continue;
    Vector<dim> direction = Vector<dim>::Zero();
    double mean_distance = 0.0;
    // Columns: du/dx_d.
    Eigen::Matrix<double, dim, dim> gradient = Eigen::Matrix<double, dim, dim>::Zero();
    const Vector<dim> u_i = extended_velocity_[i];
    for (std::size_t k = 0; k < count; ++k) {
      const std::int32_t j = neighbours.index[k];
      const Vector<dim> r = points[i] - points[j];
      const double d2 = r.squaredNorm();
      const double d = std::sqrt(d2);
      direction += r / (d * d2);
      mean_distance += d;
      gradient.noalias() -=
          (u_i - extended_velocity_[j]) * (neighbours.gradient_factor[k] * r).transpose();
    }
    mean_distance /= static_cast<double>(count);
    Vector<dim> shift = reach * mean_distance * mean_distance * direction;
    const double length = shift.norm();
    if (length > cap) shift *= cap / length;
    displacement[i] += shift;
    particles.velocity[i] += particles.volume * (gradient * shift);
  }
}

template class XuShifting<2>;
template class XuShifting<3>;

}  // namespace sprung::sph
