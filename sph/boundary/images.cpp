#include "sph/boundary/images.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sprung::sph {

template <int dim>
void Images<dim>::add(const Vector<dim>& x, std::int32_t parent, double weight) {
  points_.push_back(x);
  parent_.push_back(parent);
  root_.push_back(source(parent));
  if (shaped_.empty()) return;
  weight_.push_back(weight);
  const std::int32_t m = parent - particles_;
  shape_of_.push_back(m >= 0 ? shape_of_[m] : -1);
  before_.push_back(m >= 0 ? before_[m] : points_[parent]);
}

/// Only the particles are mirrored in shaped walls, which come first: two of them closer to each
/// other than the reach, or one that meets a flat wall at an angle, are beyond this.
template <int dim>
void Images<dim>::mirror_in_shapes(double reach) {
  image_in_.assign(shaped_.size(), std::vector<std::int32_t>(particles_, -1));
  normal_.clear();
  spread_.clear();
  for (std::size_t s = 0; s < shaped_.size(); ++s) {
    const std::size_t begin = parent_.size();
    for (std::int32_t i = 0; i < particles_; ++i) {
      const auto view = shaped_[s].shape->view_within(points_[i], reach);
      if (!view || view->distance < 0.0) continue;
      const double weight = view->mirrored_volume();
      if (weight == 0.0) continue;
      image_in_[s][i] = static_cast<std::int32_t>(points_.size());
      add(points_[i] - 2.0 * view->distance * view->normal, i, weight);
      shape_of_.back() = static_cast<std::int32_t>(s);
      normal_.push_back(view->normal);
      spread_.push_back(view->divergence_of_normals());
    }
    runs_.push_back({Rule::shaped, s, begin, parent_.size()});
  }
}

template <int dim>
void Images<dim>::mirror_in_walls(double reach) {
  for (std::size_t w = 0; w < walls_.size(); ++w) {
    const Wall<dim>& wall = walls_[w];
    const std::size_t begin = parent_.size();
    const auto so_far = static_cast<std::int32_t>(points_.size());
    for (std::int32_t i = 0; i < so_far; ++i) {
      const double distance = wall.inward * (points_[i][wall.axis] - wall.place);
      if (distance >= reach || distance < 0.0) continue;
      Vector<dim> x = points_[i];
      x[wall.axis] = 2.0 * wall.place - x[wall.axis];
      const std::int32_t m = i - particles_;
      add(x, i, m >= 0 && !weight_.empty() ? weight_[i] : 1.0);
      if (!before_.empty())
        before_.back()[wall.axis] = 2.0 * wall.place - before_.back()[wall.axis];
    }
    runs_.push_back({Rule::flat, w, begin, parent_.size()});
  }
}

template <int dim>
void Images<dim>::copy_across_periodic_sides(double reach) {
  for (std::size_t p = 0; p < periodic_.size(); ++p) {
    const PeriodicAxis& period = periodic_[p];
    const std::size_t begin = parent_.size();
    const auto so_far = static_cast<std::int32_t>(points_.size());
    for (std::int32_t i = 0; i < so_far; ++i)
      for (const double shift : {period.length(), -period.length()}) {
        Vector<dim> x = points_[i];
        x[period.axis] += shift;
        if (x[period.axis] <= period.low - reach || x[period.axis] >= period.high + reach) continue;
        add(x, i, weight_.empty() ? 1.0 : weight_[i]);
        if (!before_.empty()) before_.back()[period.axis] += shift;
      }
    runs_.push_back({Rule::periodic, p, begin, parent_.size()});
  }
}

template <int dim>
void Images<dim>::mirror(const Particles<dim>& particles, double reach) {
  reach_ = reach;
  particles_ = static_cast<std::int32_t>(particles.size());
  points_ = particles.position;
  parent_.clear();
  root_.clear();
  runs_.clear();
  shape_of_.clear();
  before_.clear();
  if (!shaped_.empty()) {
    weight_.assign(points_.size(), 1.0);
    mirror_in_shapes(reach);
  }
  mirror_in_walls(reach);
  copy_across_periodic_sides(reach);
}

template <int dim>
bool Images<dim>::mirror_back(Vector<dim>& x, Vector<dim>& u, double most) const {
  for (const auto& wall : walls_) {
    const double distance = wall.inward * (x[wall.axis] - wall.place);
    if (distance >= 0.0) continue;
    if (distance < -most) return false;
    x[wall.axis] = 2.0 * wall.place - x[wall.axis];
    u[wall.axis] = -u[wall.axis];
  }
  for (const auto& wall : shaped_) {
    const auto view = wall.shape->view_within(x, reach_);
    if (!view || view->distance >= 0.0) continue;
    if (view->distance < -most) return false;
    x -= 2.0 * view->distance * view->normal;
    u -= 2.0 * u.dot(view->normal) * view->normal;
  }
  return true;
}

template <int dim>
void Images<dim>::turn_back(Vector<dim>& x) const {
  Vector<dim> still = Vector<dim>::Zero();
  mirror_back(x, still, std::numeric_limits<double>::infinity());
}

template <int dim>
bool Images<dim>::reflect(Vector<dim>& x, Vector<dim>& u, double most) const {
  return mirror_back(x, u, most) && !outside_a_wall(x);
}

template <int dim>
bool Images<dim>::outside_a_wall(const Vector<dim>& x) const {
  for (const auto& wall : walls_)
    if (wall.inward * (x[wall.axis] - wall.place) < 0.0) return true;
  // No particle goes farther than the reach in one step.
  for (const auto& wall : shaped_) {
    const auto view = wall.shape->view_within(x, reach_);
    if (view && view->distance < 0.0) return true;
  }
  return false;
}

template <int dim>
typename Images<dim>::OppositePair Images<dim>::opposite(std::int32_t i, std::int32_t index) const {
  const std::int32_t m = index - particles_;
  const std::int32_t mirror = image_in_[shape_of_[m]][i];
  if (mirror < 0) return {-1.0, 0.0};
  return {(points_[mirror] - before_[m]).norm(), weight_[mirror]};
}

template <int dim>
template <bool viscous>
void Images<dim>::extend(const std::vector<Vector<dim>>& velocity,
                         std::vector<Vector<dim>>& extended, const Laplacian* laplacian) const {
  extended.resize(points_.size());
  std::copy(velocity.begin(), velocity.end(), extended.begin());
  for (const Run& run : runs_) {
    if (run.rule == Rule::periodic) {
      for (std::size_t m = run.begin; m < run.end; ++m)
        extended[particles_ + m] = extended[parent_[m]];
    } else if (run.rule == Rule::flat) {
      const Wall<dim>& wall = walls_[run.of];
      const bool turn_all = viscous && wall.no_slip;
      for (std::size_t m = run.begin; m < run.end; ++m) {
        Vector<dim> u = extended[parent_[m]];
        if (turn_all) {
          u = 2.0 * wall.velocity - u;
          // An image's image, in a corner, is left at that.
          const std::int32_t parent = parent_[m];
          if (laplacian && parent < particles_) {
            const double y = points_[parent][wall.axis] - wall.place;
            u += y * y * laplacian->factor * laplacian->field[parent];
          }
        } else
          u[wall.axis] = -u[wall.axis];
        extended[particles_ + m] = u;
      }
    } else {
      const bool turn_all = viscous && shaped_[run.of].no_slip;
      for (std::size_t m = run.begin; m < run.end; ++m) {
        const std::int32_t parent = parent_[m];
        const Vector<dim> u = extended[parent];
        if (!turn_all) {
          extended[particles_ + m] = u - 2.0 * u.dot(normal_[m]) * normal_[m];
          continue;
        }
        extended[particles_ + m] = -u;
        if (!laplacian) continue;
        const double y = 0.5 * (points_[parent] - points_[particles_ + m]).norm();
        extended[particles_ + m] +=
            y / (1.0 + 0.5 * spread_[m] * y) *
            (y * laplacian->factor * laplacian->field[parent] - spread_[m] * u);
      }
    }
  }
}

template <int dim>
void Images<dim>::extend_for_viscosity(const std::vector<Vector<dim>>& velocity,
                                       std::vector<Vector<dim>>& extended) const {
  extend<true>(velocity, extended, nullptr);
}

template <int dim>
void Images<dim>::extend_for_viscosity(const std::vector<Vector<dim>>& velocity,
                                       const std::vector<Vector<dim>>& field, double factor,
                                       std::vector<Vector<dim>>& extended) const {
  const Laplacian laplacian{field, factor};
  extend<true>(velocity, extended, &laplacian);
}

template <int dim>
void Images<dim>::extend_for_divergence(const std::vector<Vector<dim>>& velocity,
                                        std::vector<Vector<dim>>& extended) const {
  extend<false>(velocity, extended, nullptr);
}

template class Images<2>;
template class Images<3>;

}  // namespace sprung::sph
