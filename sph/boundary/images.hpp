#pragma once
/// Images: copies of particles outside a wall or across a periodic side, each knowing its source
/// and the rule by which each field is copied. Sweeps see particles and images alike; the pressure
/// matrix folds an image's coefficient into its source; only this file knows how images are made.

#include "sph/boundary/wall_shape.hpp"
#include "sph/particles.hpp"

#include <memory>

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

/// An axis along which the channel repeats.
struct PeriodicAxis {
  int axis = 0;
  double low = 0.0, high = 0.0;  ///< m
  double length() const { return high - low; }
};

/// A wall of any shape, at rest.
template <int dim>
struct ShapedWall {
  std::shared_ptr<const WallShape<dim>> shape;
  bool no_slip = true;
};

template <int dim>
class Images {
 public:
  explicit Images(std::vector<Wall<dim>> walls, std::vector<PeriodicAxis> periodic = {},
                  std::vector<ShapedWall<dim>> shaped = {})
      : walls_(std::move(walls)), periodic_(std::move(periodic)), shaped_(std::move(shaped)) {}

  /// Copies every particle closer than `reach` to a wall along the wall's normal (ACTION 3), and
  /// every one that close to a periodic side to the other end; near an edge, images are copied
  /// again.
  void mirror(const Particles<dim>& particles, double reach);

  /// Particles' positions followed by the images'.
  const std::vector<Vector<dim>>& points() const { return points_; }
  std::size_t size() const { return parent_.size(); }
  /// Volume of each point over a particle's, or empty when all are 1: a mirror in a curved wall
  /// stretches or shrinks.
  std::span<const double> weights() const { return weight_; }

  const std::vector<PeriodicAxis>& periodic() const { return periodic_; }
  const std::vector<Wall<dim>>& walls() const { return walls_; }
  const std::vector<ShapedWall<dim>>& shaped() const { return shaped_; }
  void set_wall_velocity(std::size_t wall, const Vector<dim>& u) { walls_[wall].velocity = u; }

  /// Brings a place that has crossed a periodic side back in at the other end.
  void wrap(Vector<dim>& x) const {
    for (const auto& p : periodic_)
      if (x[p.axis] < p.low || x[p.axis] >= p.high)
        x[p.axis] -= p.length() * std::floor((x[p.axis] - p.low) / p.length());
  }
  /// Mirrors a place outside a wall back to the inner side.
  void turn_back(Vector<dim>& x) const;
  bool outside_a_wall(const Vector<dim>& x) const;
  /// A place that a step has carried across a wall by at most `most` (m) goes back to its mirror
  /// place, and the part of `u` along the normal is turned round: the particle and its image change
  /// roles, which alters nothing that the fluid feels. False: it is farther out, and left there.
  bool reflect(Vector<dim>& x, Vector<dim>& u, double most) const;

  /// The particle that an index (particle or image) stands for.
  std::int32_t source(std::int32_t index) const {
    return index < particles_ ? index : root_[index - particles_];
  }
  /// For the pair of particle `i` and image `index`, made by a shaped wall: the same pair seen from
  /// the other side, which is the image's source and the mirror of i. Its distance, and the weight
  /// of that mirror; a negative distance when i has no mirror there.
  struct OppositePair {
    double distance;
    double weight;
  };
  OppositePair opposite(std::int32_t i, std::int32_t index) const;
  /// Whether an image comes from a shaped wall, so that opposite() has an answer.
  bool by_shaped_wall(std::int32_t index) const {
    return !shape_of_.empty() && index >= particles_ && shape_of_[index - particles_] >= 0;
  }

  /// `velocity` of the particles followed by the images' for the viscous term: 2 u_wall - u at a
  /// no-slip wall, so that the velocity is the wall's at the wall; only the normal part turned
  /// round at free slip.
  void extend_for_viscosity(const std::vector<Vector<dim>>& velocity,
                            std::vector<Vector<dim>>& extended) const;
  /// The same one order higher at no-slip walls, from the particles' Laplacian of the velocity,
  /// `factor` times `field` (1/(m s)). A profile a y + b y^2 / 2 along the normal goes on across
  /// the wall as -u + b y^2, with b = u_nn the Laplacian less (div n) u_n and u_n = u / y + b y
  /// / 2. Plain -u bends the profile at the wall: with it a parabola 25 particles wide flows 1 %
  /// too fast.
  void extend_for_viscosity(const std::vector<Vector<dim>>& velocity,
                            const std::vector<Vector<dim>>& field, double factor,
                            std::vector<Vector<dim>>& extended) const;
  /// The same for the divergence: only the normal part is turned round. The full reversal would let
  /// the shear along a wall count as a source.
  void extend_for_divergence(const std::vector<Vector<dim>>& velocity,
                             std::vector<Vector<dim>>& extended) const;

 private:
  enum class Rule : std::uint8_t { flat, shaped, periodic };
  /// Images made one after the other by one rule.
  struct Run {
    Rule rule;
    std::size_t of;  ///< which wall
    std::size_t begin, end;
  };
  /// Mirrors `x` in every wall that it is outside of, and turns `u` round; false, and no further,
  /// where that is by more than `most` (m).
  bool mirror_back(Vector<dim>& x, Vector<dim>& u, double most) const;
  void mirror_in_shapes(double reach);
  void mirror_in_walls(double reach);
  void copy_across_periodic_sides(double reach);
  void add(const Vector<dim>& x, std::int32_t parent, double weight);
  /// The particles' Laplacian of the velocity, factor times field.
  struct Laplacian {
    const std::vector<Vector<dim>>& field;
    double factor;
  };
  template <bool viscous>
  void extend(const std::vector<Vector<dim>>& velocity, std::vector<Vector<dim>>& extended,
              const Laplacian* laplacian) const;

  std::vector<Wall<dim>> walls_;
  std::vector<PeriodicAxis> periodic_;
  std::vector<ShapedWall<dim>> shaped_;
  double reach_ = 0.0;  ///< of the last mirror(), m
  std::int32_t particles_ = 0;
  std::vector<Vector<dim>> points_;
  std::vector<std::int32_t> parent_;  ///< index of the particle or image that is copied
  std::vector<std::int32_t> root_;
  std::vector<Run> runs_;

  // Of shaped walls only; empty where the scene has none.
  std::vector<double> weight_;
  std::vector<Vector<dim>> normal_;     ///< at each image that a shaped wall made
  std::vector<double> spread_;          ///< div n at the image's source, 1/m
  std::vector<std::int32_t> shape_of_;  ///< of each image, -1: no shaped wall made it
  std::vector<Vector<dim>> before_;     ///< the image's source, moved as the image was after it
  std::vector<std::vector<std::int32_t>> image_in_;  ///< [shape][particle], -1: none
};

}  // namespace sprung::sph
