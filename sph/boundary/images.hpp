#pragma once
/// Images: copies of particles outside a wall, each knowing its source and the rule by which each
/// field is copied. Sweeps see particles and images alike; the pressure matrix folds an image's
/// coefficient into its source; only this file knows how images are made.

#include "scene/problem.hpp"
#include "sph/particles.hpp"

namespace sprung::sph {

/// A flat wall of the channel box.
template <int dim>
struct Wall {
  int axis = 0;        ///< normal direction
  double place = 0.0;  ///< coordinate of the plane, m
  int inward = 1;      ///< +1 when the fluid lies on the side of larger coordinates
  bool no_slip = true;
  Vector<dim> velocity = Vector<dim>::Zero();
};

template <int dim>
class Images {
 public:
  explicit Images(std::vector<Wall<dim>> walls) : walls_(std::move(walls)) {}

  /// Mirrors every particle closer than `reach` to a wall along the wall's normal (ACTION 3); near
  /// an edge, images are mirrored again in the next wall.
  void mirror(const Particles<dim>& particles, double reach);

  /// Particles' positions followed by the images'.
  const std::vector<Vector<dim>>& points() const { return points_; }
  std::size_t size() const { return parent_.size(); }
  /// Mirrors a place outside a wall back to the inner side.
  void turn_back(Vector<dim>& x) const {
    for (const auto& wall : walls_)
      if (wall.inward * (x[wall.axis] - wall.place) < 0.0)
        x[wall.axis] = 2.0 * wall.place - x[wall.axis];
  }
  bool outside_a_wall(const Vector<dim>& x) const {
    for (const auto& wall : walls_)
      if (wall.inward * (x[wall.axis] - wall.place) < 0.0) return true;
    return false;
  }
  /// The particle that an index (particle or image) stands for.
  std::int32_t source(std::int32_t index) const {
    return index < particles_ ? index : root_[index - particles_];
  }

  /// `velocity` of the particles followed by the images' for the viscous term: 2 u_wall - u at a
  /// no-slip wall, so that the velocity is the wall's at the wall; only the normal part turned
  /// round at free slip.
  void extend_for_viscosity(const std::vector<Vector<dim>>& velocity,
                            std::vector<Vector<dim>>& extended) const;
  /// The same for the divergence: only the normal part is turned round. The full reversal would let
  /// the shear along a wall count as a source.
  void extend_for_divergence(const std::vector<Vector<dim>>& velocity,
                             std::vector<Vector<dim>>& extended) const;

 private:
  std::vector<Wall<dim>> walls_;
  std::int32_t particles_ = 0;
  std::vector<Vector<dim>> points_;
  std::vector<std::int32_t> parent_;  ///< index of the particle or image that is mirrored
  std::vector<std::int32_t> root_;
  std::vector<std::uint8_t> wall_;
};

}  // namespace sprung::sph
