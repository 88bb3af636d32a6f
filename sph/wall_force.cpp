#include "sph/wall_force.hpp"

#include "sph/velocity_gradient.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace sprung::sph {

template <int dim>
WallForce<dim>::WallForce(const State<dim>& state, const ShapedWall<dim>& wall)
    : shape_(wall.shape),
      patches_(wall.shape->patches(state.particles.spacing)),
      inner_(state.kernel.support_radius()),
      width_(4.0 * state.particles.spacing),
      least_width_(state.particles.spacing) {
  const auto& particles = state.particles;
  const double near = particles.spacing;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vector<dim>& x = particles.position[i];
    const auto view = shape_->view_within(x, inner_ + width_);
    if (!view) continue;
    std::string here;
    if (particles.role[i] == Role::solid) here = "a body";
    if (i >= particles.unknowns) here = "an open side of the channel";
    for (const auto& flat : state.images.walls())
      if (std::abs(x[flat.axis] - flat.place) < near) here = "a wall of the channel";
    for (const auto& other : state.images.shaped())
      if (other.shape != shape_ && other.shape->view_within(x, near)) here = "another curved wall";
    if (here.empty()) continue;
    width_ = view->distance - inner_;
    nearest_ = here;
  }
}

template <int dim>
std::string WallForce<dim>::obstacle() const {
  if (width_ >= least_width_) return {};
  return fmt::format(
      "is measured in the fluid up to {:.4g} m from the wall at least, and {} stands "
      "nearer; use a smaller spacing or leave the probe out",
      inner_ + least_width_, nearest_);
}

template <int dim>
Vector<dim> WallForce<dim>::operator()(const State<dim>& state, double dynamic_viscosity) const {
  const auto& particles = state.particles;
  Vector<dim> force = Vector<dim>::Zero();
  for (const auto& patch : patches_)
    force -= patch.area * particles.density * state.balanced_acceleration.dot(patch.centre) *
             patch.normal;
  if (state.clock.step == 0) return force;
  std::vector<Vector<dim>> extended;
  state.images.extend_for_viscosity(particles.velocity, extended);
  Vector<dim> sum = Vector<dim>::Zero();
  for (std::size_t i = particles.solids; i < particles.unknowns; ++i) {
    const auto view = shape_->view_within(particles.position[i], inner_ + width_);
    if (!view) continue;
    const double s = std::clamp((view->distance - inner_) / width_, 0.0, 1.0);
    const double phi = 1.0 - s * s * (3.0 - 2.0 * s), slope = -6.0 * s * (1.0 - s) / width_;
    // After a step `predicted_velocity` holds the velocity before it.
    const Vector<dim> acceleration =
        (particles.velocity[i] - particles.predicted_velocity[i]) / state.clock.time_step;
    sum += phi * particles.density * (acceleration - state.driving_acceleration);
    if (slope == 0.0) continue;
    sum += particles.density * particles.pseudo_pressure[i] * slope * view->normal;
    if (dynamic_viscosity == 0.0) continue;
    const Matrix<dim> gradient = velocity_gradient(state, extended, i);
    sum += dynamic_viscosity * slope * (gradient + gradient.transpose()) * view->normal;
  }
  return force - particles.volume * sum;
}

template class WallForce<2>;
template class WallForce<3>;

}  // namespace sprung::sph
