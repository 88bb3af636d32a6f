#include "sph/effects/contact.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sprung::sph {

namespace {

/// Particles of another body near a particle: offsets to it and, once weighed, their shares of what
/// pushes back.
template <int dim>
struct Face {
  std::vector<std::int32_t> node;
  std::vector<Vector<dim>> offset;
  std::vector<double> share;
  Vector<dim> normal = Vector<dim>::Zero();
  double distance = 0.0;
};

/// Shares of the near row: the kernel's values, tilted along the face so that their mean lies
/// straight below the particle. At a corner, where that would ask some to pull, untilted.
template <int dim>
void weigh(Face<dim>& face, const Kernel<dim>& kernel, double spacing) {
  const std::size_t n = face.node.size();
  std::vector<Vector<dim>> along(n);
  Vector<dim> first = Vector<dim>::Zero();
  Matrix<dim> second = Matrix<dim>::Zero();
  face.share.assign(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    const double depth = face.offset[k].dot(face.normal);
    along[k] = face.offset[k] - depth * face.normal;
    if (depth > face.distance + 0.5 * spacing) continue;
    face.share[k] = kernel.value(face.offset[k].norm());
    first += face.share[k] * along[k];
    second += face.share[k] * along[k] * along[k].transpose();
  }
  const Matrix<dim> regular =
      second + second.trace() * face.normal * face.normal.transpose() +
      1e-9 * spacing * spacing * kernel.value(0.0) * Matrix<dim>::Identity();
  const Vector<dim> tilt = -regular.inverse() * first;
  const bool pushes = std::all_of(along.begin(), along.end(),
                                  [&](const Vector<dim>& t) { return 1.0 + tilt.dot(t) > 0.0; });
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    if (pushes) face.share[k] *= 1.0 + tilt.dot(along[k]);
    sum += face.share[k];
  }
  for (double& share : face.share) share /= sum;
}

}  // namespace

template <int dim>
Contact<dim>::Contact(std::vector<Body> bodies, const Particles<dim>& particles,
                      const std::vector<Wall<dim>>& walls)
    : bodies_(std::move(bodies)), body_of_(particles.solids, 0) {
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    std::fill(body_of_.begin() + static_cast<std::ptrdiff_t>(bodies_[b].first),
              body_of_.begin() + static_cast<std::ptrdiff_t>(bodies_[b].last),
              static_cast<std::int32_t>(b));
  for (const auto& wall : walls) {
    auto& nearest = nearest_to_wall_.emplace_back(particles.solids);
    for (std::size_t i = 0; i < particles.solids; ++i) {
      const double at_rest = wall.inward * (particles.position[i][wall.axis] - wall.place);
      const bool foot = bodies_[body_of_[i]].clamped && at_rest < 2.0 * particles.spacing;
      nearest[i] = foot ? -std::numeric_limits<double>::infinity()
                        : std::min(0.5 * particles.spacing, at_rest);
    }
  }
}

template <int dim>
double Contact<dim>::largest_time_step(const State<dim>& state) const {
  if (!near(state)) return std::numeric_limits<double>::infinity();
  double stiffest = 0.0;
  for (const Body& body : bodies_) stiffest = std::max(stiffest, body.youngs_modulus);
  return 2.0 * state.particles.spacing * std::sqrt(state.particles.density / stiffest);
}

/// Whether less than a spacing is between any two faces.
template <int dim>
bool Contact<dim>::near(const State<dim>& state) const {
  const auto& particles = state.particles;
  const auto& walls = state.images.walls();
  for (std::size_t i = 0; i < particles.solids; ++i) {
    for (std::size_t w = 0; w < walls.size(); ++w)
      if (walls[w].inward * (particles.position[i][walls[w].axis] - walls[w].place) <
          nearest_to_wall_[w][i] + particles.spacing)
        return true;
    if (bodies_.size() < 2) continue;
    for (const std::int32_t j : state.support.inner(i).index)
      if (static_cast<std::size_t>(j) < particles.solids && body_of_[j] != body_of_[i] &&
          (particles.position[i] - particles.position[j]).norm() < 2.0 * particles.spacing)
        return true;
  }
  return false;
}

template <int dim>
std::vector<Touch<dim>> Contact<dim>::find(const State<dim>& state, double ahead) const {
  std::vector<Touch<dim>> touches;
  for (std::size_t i = 0; i < state.particles.solids; ++i) {
    if (bodies_.size() > 1) touch_bodies(state, i, ahead, touches);
    touch_walls(state, i, ahead, touches);
  }
  return touches;
}

template <int dim>
double Contact<dim>::energy(const State<dim>& state) const {
  double sum = 0.0;
  for (const auto& touch : find(state, 0.0))
    sum += 0.5 * touch.stiffness * touch.overlap * touch.overlap;
  return sum;
}

template <int dim>
void Contact<dim>::touch_bodies(const State<dim>& state, std::size_t solid, double ahead,
                                std::vector<Touch<dim>>& touches) const {
  const auto& particles = state.particles;
  const auto near = state.support.inner(solid);
  // Bodies are few, and no place is near more than one or two of them.
  for (std::size_t other = 0; other < bodies_.size(); ++other) {
    if (static_cast<std::int32_t>(other) == body_of_[solid]) continue;
    Face<dim> face;
    for (std::size_t k = 0; k < near.index.size(); ++k) {
      const auto j = static_cast<std::size_t>(near.index[k]);
      if (j < bodies_[other].first || j >= bodies_[other].last) continue;
      face.node.push_back(near.index[k]);
      face.offset.push_back(particles.position[solid] - particles.position[j]);
      face.normal -= near.gradient_factor[k] * face.offset.back();
    }
    if (face.node.empty() || face.normal.norm() == 0.0) continue;
    face.normal.normalize();
    face.distance = face.offset[0].dot(face.normal);
    for (const auto& offset : face.offset)
      face.distance = std::min(face.distance, offset.dot(face.normal));
    weigh(face, state.kernel, particles.spacing);
    Touch<dim> touch;
    Vector<dim> velocity = particles.velocity[solid];
    touch.nodes.push_back({static_cast<std::int32_t>(solid), face.normal});
    for (std::size_t k = 0; k < face.node.size(); ++k) {
      if (face.share[k] == 0.0) continue;
      velocity -= face.share[k] * particles.velocity[face.node[k]];
      touch.nodes.push_back({face.node[k], -face.share[k] * face.normal});
    }
    const double gap = face.distance + ahead * velocity.dot(face.normal);
    touch.overlap = particles.spacing - gap;
    if (touch.overlap <= 0.0) continue;
    const double modulus =
        2.0 / (1.0 / bodies_[body_of_[solid]].youngs_modulus + 1.0 / bodies_[other].youngs_modulus);
    touch.stiffness = 0.5 * modulus * std::pow(particles.spacing, dim - 2);
    touches.push_back(std::move(touch));
  }
}

template <int dim>
void Contact<dim>::touch_walls(const State<dim>& state, std::size_t solid, double ahead,
                               std::vector<Touch<dim>>& touches) const {
  const auto& particles = state.particles;
  const auto& walls = state.images.walls();
  for (std::size_t w = 0; w < walls.size(); ++w) {
    const auto& wall = walls[w];
    const double gap = wall.inward * (particles.position[solid][wall.axis] - wall.place +
                                      ahead * particles.velocity[solid][wall.axis]);
    const double overlap = nearest_to_wall_[w][solid] - gap;
    if (overlap <= 0.0) continue;
    const double modulus = bodies_[body_of_[solid]].youngs_modulus;
    touches.push_back({{{static_cast<std::int32_t>(solid),
                         Vector<dim>(wall.inward * Vector<dim>::Unit(wall.axis))}},
                       overlap,
                       2.0 * modulus * std::pow(particles.spacing, dim - 2)});
  }
}

template class Contact<2>;
template class Contact<3>;

}  // namespace sprung::sph
