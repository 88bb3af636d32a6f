#include "sph/boundary/images.hpp"

namespace sprung::sph {

template <int dim>
void Images<dim>::mirror(const Particles<dim>& particles, double reach) {
  particles_ = static_cast<std::int32_t>(particles.size());
  points_ = particles.position;
  parent_.clear();
  root_.clear();
  wall_.clear();
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    const Wall<dim>& wall = walls_[w];
    const auto so_far = static_cast<std::int32_t>(points_.size());
    for (std::int32_t i = 0; i < so_far; ++i) {
      const double distance = wall.inward * (points_[i][wall.axis] - wall.place);
      if (distance >= reach || distance < 0.0) continue;
      Vector<dim> x = points_[i];
      x[wall.axis] = 2.0 * wall.place - x[wall.axis];
      points_.push_back(x);
      parent_.push_back(i);
      root_.push_back(source(i));
      wall_.push_back(static_cast<std::uint8_t>(w));
    }
  }
}

template <int dim>
void Images<dim>::extend_for_viscosity(const std::vector<Vector<dim>>& velocity,
                                       std::vector<Vector<dim>>& extended) const {
  extended.resize(points_.size());
  std::copy(velocity.begin(), velocity.end(), extended.begin());
  for (std::size_t m = 0; m < parent_.size(); ++m) {
    const Wall<dim>& wall = walls_[wall_[m]];
    Vector<dim> u = extended[parent_[m]];
    if (wall.no_slip)
      u = 2.0 * wall.velocity - u;
    else
      u[wall.axis] = -u[wall.axis];
    extended[particles_ + m] = u;
  }
}

template <int dim>
void Images<dim>::extend_for_divergence(const std::vector<Vector<dim>>& velocity,
                                        std::vector<Vector<dim>>& extended) const {
  extended.resize(points_.size());
  std::copy(velocity.begin(), velocity.end(), extended.begin());
  for (std::size_t m = 0; m < parent_.size(); ++m) {
    Vector<dim> u = extended[parent_[m]];
    const int axis = walls_[wall_[m]].axis;
    u[axis] = -u[axis];
    extended[particles_ + m] = u;
  }
}

template class Images<2>;
template class Images<3>;

}  // namespace sprung::sph
