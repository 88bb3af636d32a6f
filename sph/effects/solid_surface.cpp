#include "sph/effects/solid_surface.hpp"

#include <cmath>

namespace sprung::sph {

template <int dim>
SolidSurface<dim>::SolidSurface(std::vector<Body> bodies, const Particles<dim>& particles)
    : bodies_(std::move(bodies)), depth_(particles.solids) {
  for (const Body& body : bodies_)
    for (std::size_t i = body.first; i < body.last; ++i)
      for (int d = 0; d < dim; ++d) {
        const double x = particles.position[i][d];
        depth_[i].to_face[2 * d] = x - body.shape.body.from[d];
        depth_[i].to_face[2 * d + 1] = body.shape.body.to[d] - x;
      }
}

template <int dim>
double SolidSurface<dim>::depth_along(std::size_t solid, const Vector<dim>& normal) const {
  double depth = std::numeric_limits<double>::infinity();
  for (int d = 0; d < dim; ++d) {
    const double along = std::abs(normal[d]);
    if (along < 1e-6) continue;
    depth = std::min(depth, depth_[solid].to_face[2 * d + (normal[d] > 0.0 ? 1 : 0)] / along);
  }
  return depth;
}

template <int dim>
void SolidSurface<dim>::update(const State<dim>& state) {
  const auto& particles = state.particles;
  const auto& points = state.images.points();
  const auto n = static_cast<std::int32_t>(particles.unknowns);
  normal_.assign(n, Vector<dim>::Zero());
  distance_.assign(n, std::numeric_limits<double>::infinity());
  const auto solids = static_cast<std::int32_t>(particles.solids);
  for (std::int32_t s = 0; s < solids; ++s) {
    const auto neighbours = state.support.of(s);
    for (std::size_t k = 0; k < neighbours.index.size(); ++k) {
      const std::int32_t f = neighbours.index[k];
      if (f >= solids && f < n) normal_[f] -= neighbours.gradient_factor[k] * (points[f] - points[s]);
    }
  }
  for (std::int32_t f = solids; f < n; ++f)
    if (const double length = normal_[f].norm(); length > 0.0) normal_[f] /= length;
  // How far the body has turned is taken from its column of particles as a whole being bent little: the
  // normal is used in the rest frame. TODO rotation.
  for (std::int32_t s = 0; s < solids; ++s) {
    const auto neighbours = state.support.of(s);
    for (const std::int32_t f : neighbours.index)
      if (f >= solids && f < n) {
        const double d = (points[f] - points[s]).dot(normal_[f]) - depth_along(s, normal_[f]);
        distance_[f] = std::min(distance_[f], d);
      }
  }
  const double least = 0.25 * particles.spacing;
  for (double& d : distance_) d = std::max(d, least);
}

template class SolidSurface<2>;
template class SolidSurface<3>;

}  // namespace sprung::sph
