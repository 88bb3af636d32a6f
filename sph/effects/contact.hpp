#pragma once
/// Contact of a body with another body or with a flat wall: a force that keeps them apart once
/// their faces meet, which the fluid's pressure cannot do when no particle fits between.

#include "sph/effects/roles.hpp"

namespace sprung::sph {

/// A particle that meets a face: the gap's derivative by each node's place, and by how much the
/// faces overlap.
template <int dim>
struct Touch {
  struct Node {
    std::int32_t node;
    Vector<dim> gradient;  ///< of the gap; the gradients of one touch add up to 0 between bodies
  };
  std::vector<Node> nodes;
  double overlap = 0.0;    ///< m
  double stiffness = 0.0;  ///< N/m (Pa in the plane)
};

/// Faces lie half a spacing outside the outer rows' centres, so two bodies touch where rows of both
/// are a spacing apart. From there on the half spacings on both sides are a layer that is
/// compressed: its pressure is E (1 - gap/spacing), E the harmonic mean of the two Young's moduli;
/// at a rigid wall the body's own half spacing alone. Two blocks pressed together with p rest at
/// spacing x (1 - p/E).
///
/// A particle's distance to the other body is taken along the normal of that body's near particles,
/// to the outermost of them, and not between pairs of particles: rows then slide past each other
/// without friction. What pushes the particle pushes the other body's near row back, with weights
/// whose mean lies below it, so that no couple arises. Both bodies look at each other, each for
/// half of the stiffness.
template <int dim>
class Contact final : public TimeStepLimit<dim> {
 public:
  struct Body {
    std::size_t first, last;  ///< particles
    double youngs_modulus;    ///< Pa
    bool clamped;  ///< its foot, at rest within two spacings of a wall, is not pushed off
  };
  Contact(std::vector<Body> bodies, const Particles<dim>& particles,
          const std::vector<Wall<dim>>& walls);

  /// Where the solids would overlap at x + dt u.
  std::vector<Touch<dim>> find(const State<dim>& state) const {
    return find(state, state.clock.time_step);
  }

  /// Stored in the compressed layer at x, J (J/m in the plane): the sum of k overlap^2 / 2, whose
  /// slope along a touch's gap is the force that find() gives at rest. Faces of two blocks:
  /// E dx/2 (1 - gap/dx)^2 per area; at a wall E dx/4 (1 - 2 gap/dx)^2.
  double energy(const State<dim>& state) const;

  /// Twice what an elastic wave takes from one particle to the next, 2 dx / sqrt(E/rho) of the
  /// stiffest body, as long as two faces are closer than a spacing; else no bound. The pressure
  /// equation moves a body like free fluid, and springs and contact take back afterwards what they
  /// do not allow. A body that others hold by contact, and that shuts a channel, is stopped so in
  /// one step if that is long, and the fluid behind it is not: it tears off and leaves a void.
  /// Measured on two flaps (validation/hard): up to 2 dx / c they held, at 4 and 9 the fluid tore.
  double largest_time_step(const State<dim>& state) const override;
  std::string_view limit_name() const override { return "contact, 2 dx / sqrt(E/rho)"; }

 private:
  /// `ahead`: s, how far along their velocities the particles are looked at.
  std::vector<Touch<dim>> find(const State<dim>& state, double ahead) const;
  bool near(const State<dim>& state) const;
  void touch_bodies(const State<dim>& state, std::size_t solid, double ahead,
                    std::vector<Touch<dim>>& touches) const;
  void touch_walls(const State<dim>& state, std::size_t solid, double ahead,
                   std::vector<Touch<dim>>& touches) const;

  std::vector<Body> bodies_;
  std::vector<std::int32_t> body_of_;  ///< of each solid
  /// [wall][solid]: half a spacing, or the distance at rest where a body stands closer; minus
  /// infinity for its clamped foot.
  std::vector<std::vector<double>> nearest_to_wall_;
};

}  // namespace sprung::sph
