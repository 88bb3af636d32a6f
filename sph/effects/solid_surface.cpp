#include "sph/effects/solid_surface.hpp"

#include "scene/body_shape.hpp"

#include <Eigen/Dense>

#include <cmath>

namespace sprung::sph {

template <int dim>
SolidSurface<dim>::SolidSurface(const std::vector<Body>& bodies, const Particles<dim>& particles)
    : depth_(particles.solids),
      reference_(particles.position.begin(), particles.position.begin() + particles.solids),
      near_at_rest_(particles.solids),
      gradient_of_(particles.solids),
      rotation_(particles.solids) {
  for (const Body& body : bodies) {
    for (std::size_t i = body.first; i < body.last; ++i)
      for (int d = 0; d < dim; ++d) {
        Point place{};
        for (int e = 0; e < dim; ++e) place[e] = reference_[i][e];
        const Point own = to_own(body.shape, place);
        depth_[i].to_face[2 * d] = own[d];
        depth_[i].to_face[2 * d + 1] = own_extent(body.shape)[d] - own[d];
        depth_[i].own_axes.col(d) = as_vector<dim>(own_direction(body.shape, own, d));
      }
    const std::span<const Vector<dim>> own{reference_.data() + body.first, body.last - body.first};
    Support<dim> support;
    support.build(Kernel<dim>(0.8 * particles.spacing), own, own.size(), particles.volume);
    for (std::size_t i = body.first; i < body.last; ++i)
      for (const std::int32_t j : support.of(i - body.first).index)
        near_at_rest_[i].push_back(j + static_cast<std::int32_t>(body.first));
  }
  for (std::size_t i = 0; i < near_at_rest_.size(); ++i) {
    Matrix second = Matrix::Zero();
    for (const std::int32_t j : near_at_rest_[i]) {
      const Vector<dim> r = reference_[j] - reference_[i];
      second += r * r.transpose();
    }
    // A body of one row tells nothing across it: the pseudo-inverse asks nothing of it.
    const Matrix inverse = second.completeOrthogonalDecomposition().pseudoInverse();
    for (const std::int32_t j : near_at_rest_[i])
      gradient_of_[i].push_back(inverse * (reference_[j] - reference_[i]));
  }
}

/// The rotation that best turns the rest places of a particle's neighbours into the present ones
/// (Kabsch).
template <int dim>
typename SolidSurface<dim>::Rotation SolidSurface<dim>::rotation_of(
    std::size_t solid, const std::vector<Vector<dim>>& position) const {
  Rotation correlation = Rotation::Zero();
  for (const std::int32_t j : near_at_rest_[solid])
    correlation +=
        (position[j] - position[solid]) * (reference_[j] - reference_[solid]).transpose();
  if constexpr (dim == 2) {
    const double angle = std::atan2(correlation(1, 0) - correlation(0, 1), correlation.trace());
    return Eigen::Rotation2Dd(angle).toRotationMatrix();
  } else {
    const Eigen::JacobiSVD<Rotation> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Rotation u = svd.matrixU();
    if ((u * svd.matrixV().transpose()).determinant() < 0.0) u.col(dim - 1) *= -1.0;
    return u * svd.matrixV().transpose();
  }
}

/// Distance from a solid particle's centre to its body's surface along a normal turned back to
/// rest.
template <int dim>
double SolidSurface<dim>::depth_along(std::size_t solid, const Vector<dim>& rest_normal) const {
  double depth = std::numeric_limits<double>::infinity();
  const Vector<dim> own_normal = depth_[solid].own_axes.transpose() * rest_normal;
  for (int d = 0; d < dim; ++d) {
    const double along = std::abs(own_normal[d]);
    if (along < 1e-6) continue;
    depth = std::min(depth, depth_[solid].to_face[2 * d + (own_normal[d] > 0.0 ? 1 : 0)] / along);
  }
  return depth;
}

template <int dim>
Vector<dim> SolidSurface<dim>::arm(std::size_t fluid, std::size_t solid) const {
  const Vector<dim> normal = rotation_[solid].transpose() * normal_[fluid];
  if (normal.isZero()) return normal;
  return depth_along(solid, normal) * normal;
}

template <int dim>
void SolidSurface<dim>::carry_out(const std::vector<Matrix>& moment,
                                  std::vector<Vector<dim>>& force) const {
  force.assign(moment.size(), Vector<dim>::Zero());
  for (std::size_t s = 0; s < moment.size(); ++s) {
    if (moment[s].isZero(0.0)) continue;
    for (std::size_t k = 0; k < near_at_rest_[s].size(); ++k) {
      const Vector<dim> moved = moment[s] * gradient_of_[s][k];
      force[near_at_rest_[s][k]] += moved;
      force[s] -= moved;
    }
  }
}

template <int dim>
void SolidSurface<dim>::update(const State<dim>& state) {
  const auto& particles = state.particles;
  const auto& points = state.images.points();
  const auto n = static_cast<std::int32_t>(particles.unknowns);
  const auto solids = static_cast<std::int32_t>(particles.solids);
  const auto is_fluid = [&](std::int32_t i) { return i >= solids && i < n; };
  normal_.assign(n, Vector<dim>::Zero());
  distance_.assign(n, std::numeric_limits<double>::infinity());
  // Normal at a fluid particle: away from the solid particles in its support.
  for (std::int32_t s = 0; s < solids; ++s) {
    rotation_[s] = rotation_of(s, particles.position);
    const auto neighbours = state.support.of(s);
    for (std::size_t k = 0; k < neighbours.index.size(); ++k)
      if (const std::int32_t f = neighbours.index[k]; is_fluid(f))
        normal_[f] -= neighbours.gradient_factor[k] * (points[f] - points[s]);
  }
  for (std::int32_t f = solids; f < n; ++f)
    if (const double length = normal_[f].norm(); length > 0.0) normal_[f] /= length;
  for (std::int32_t s = 0; s < solids; ++s)
    for (const std::int32_t f : state.support.of(s).index)
      if (is_fluid(f)) {
        const double depth = depth_along(s, rotation_[s].transpose() * normal_[f]);
        distance_[f] = std::min(distance_[f], (points[f] - points[s]).dot(normal_[f]) - depth);
      }
  // A particle that has come closer than a quarter of the spacing would ask for a reach without
  // bound.
  const double least = 0.25 * particles.spacing;
  for (double& d : distance_) d = std::max(d, least);
}

template class SolidSurface<2>;
template class SolidSurface<3>;

}  // namespace sprung::sph
