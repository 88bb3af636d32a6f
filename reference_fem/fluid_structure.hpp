#pragma once
/// The coupled equations in weak form, their residual and their linearisation.
///
/// Unknown are the velocity v of fluid and solid, one continuous field, and the pressure p. X
/// labels points of the undeformed plane, x = X + u(X, t) is where they are, F = I + grad u, J =
/// det F. In a body u follows the material, in the fluid it follows the mesh: du/dt = g with g = v
/// in the bodies and g = the extension of v from their faces in the fluid (mesh_motion.hpp). For
/// all test functions (phi, q)
///
///   fluid, over the moved mesh x:
///     (rho (dv/dt|_X + ((v - g) . grad) v), phi) + (mu (grad v + grad v^T) - p I, grad phi)
///         = < -p_out n + mu grad v^T n, phi >_open sides,            (q, div v) = 0;
///   bodies, over the undeformed plane X:
///     (rho dv/dt, phi) + (dW_shape/dF - p dtheta/dF, grad phi) = 0,
///     (q, theta + p/lambda) = 0.
///
/// - The time derivative is taken at fixed X and the integrals stand in the non-conservative form
/// at one
///   instant, so a uniform flow stays uniform whatever the mesh does (the geometric conservation
///   law).
/// - The open sides carry mu grad v n - p n = -p_out n ("do nothing"): the symmetric stress stands
/// in the volume, which
///   makes the traction on a body the true one, and the boundary term takes its transpose out
///   again, so that a Poiseuille flow leaves undisturbed.
/// - The bodies' volume is held by its strain theta, not by its rate, so none drifts away.
///
/// Newton's matrix leaves out how the residual depends on the mesh's place (shape derivatives), so
/// that the mesh motion never enters the linear system; the residual is exact, so the converged
/// solution is that of the fully implicit coupled equations. The pressure modes of each cell are
/// eliminated by an artificial compressibility of the matrix alone: again the residual does not
/// know of it.

#include "reference_fem/material.hpp"
#include "reference_fem/space.hpp"
#include "reference_fem/sparse_lu.hpp"

#include <stdexcept>
#include <vector>

namespace sprung::reference {

/// A cell turned inside out: the mesh motion has reached its end.
class InvertedCell : public std::runtime_error {
 public:
  InvertedCell(double x, double y, bool solid);
};

/// Nodal fields are interleaved (x, y per node); the pressure holds the modes of each cell.
struct Fields {
  std::vector<double> velocity;       ///< v, m/s
  std::vector<double> pressure;       ///< p, Pa
  std::vector<double> displacement;   ///< u, m
  std::vector<double> mesh_velocity;  ///< g, m/s
  std::vector<double> acceleration;   ///< dv/dt at fixed X, m/s2
};

/// How an implicit stage ties the fields to the velocity: d(displacement)/d(velocity) = c,
/// d(acceleration)/d(velocity) = inertia/c.
struct StageWeights {
  double c = 0.0;        ///< s
  double inertia = 1.0;  ///< 0 for a static problem
  double time = 0.0;     ///< s, at which gravity and the pressures on open sides are taken
};

struct Residual {
  std::vector<double> momentum;    ///< N/m per node, constrained entries included: the reactions
  std::vector<double> continuity;  ///< m2/s per pressure mode; a body's constraint is divided by c
};

class FluidStructure {
 public:
  /// One material per solid of the problem, in its order.
  FluidStructure(const Space& space, const Problem& problem, std::vector<Material> materials);

  const Space& space() const { return space_; }
  const Problem& problem() const { return problem_; }
  const Material& material(int body) const {
    return materials_[static_cast<std::size_t>(body) - 1];
  }
  double viscosity() const { return viscosity_; }
  int velocity_unknowns() const { return matrix_.size; }
  int pressure_unknowns() const { return space_.cells() * space_.pressures_per_cell(); }
  /// Number of a velocity component among the unknowns, -1 if it is prescribed.
  int unknown(int node, int component) const {
    return unknown_[2 * static_cast<std::size_t>(node) + static_cast<std::size_t>(component)];
  }

  /// Writes the prescribed velocities at `time` into `velocity`.
  void impose(double time, std::vector<double>& velocity) const;
  /// Acceleration of gravity at `time`, m/s2.
  Vec2 gravity(double time) const;
  /// Adds a dead load (N/m per node component) to the right side; empty for none.
  void set_load(std::vector<double> load) { load_ = std::move(load); }

  /// Throws InvertedCell.
  void residual(const Fields& fields, const StageWeights& weights, Residual& result) const;
  /// Assembles and factorises the matrix at `fields`.
  void linearize(const Fields& fields, const StageWeights& weights);
  /// Newton's correction with the last matrix.
  void correct(const Residual& residual, std::vector<double>& velocity_step,
               std::vector<double>& pressure_step) const;
  /// Force of the fluid on a body (N per metre of depth), from the fluid's residual at the wetted
  /// nodes: as accurate as the energy, and in exact balance with the discrete momentum.
  Vec2 force_on(int body, const Fields& fields, const StageWeights& weights) const {
    return force_on(wetted_nodes_[static_cast<std::size_t>(body)], fields, weights);
  }
  /// Force of the fluid on Problem::curved_walls[wall]; a node that a body shares counts as the
  /// body's, so the sum over both is the force on the two together.
  Vec2 force_on_wall(int wall, const Fields& fields, const StageWeights& weights) const {
    return force_on(wall_nodes_[static_cast<std::size_t>(wall)], fields, weights);
  }
  /// The same on any set of wetted nodes, marked by 1.
  Vec2 force_on(const std::vector<char>& nodes, const Fields& fields,
                const StageWeights& weights) const;
  /// Power (W per metre of depth) that the prescribed velocities and the tractions on the open
  /// sides put in.
  double boundary_power(const Fields& fields, const StageWeights& weights) const;
  double factor_entries() const { return lu_.factor_entries(); }

 private:
  template <int degree>
  struct Kernel;
  void number_unknowns();
  void build_pattern();
  double open_pressure(unsigned boundary, double time) const;
  bool is_open(unsigned boundary) const;
  void add_open_boundary(const Fields& fields, double time, Residual& result) const;
  void add_open_boundary_matrix(const Fields& fields);

  const Space& space_;
  Problem problem_;
  std::vector<Material> materials_;
  double viscosity_ = 0.0;
  std::vector<int> unknown_;
  std::vector<double> load_;
  SparseColumns matrix_;
  std::vector<int> entry_;  ///< per cell and local pair, row by row: place in matrix_.value, or -1
  std::vector<double> inverse_c_b2_, b1_, inverse_c_;  ///< per cell, to recover the pressure
  std::vector<std::vector<char>> wetted_nodes_;        ///< per body
  std::vector<std::vector<char>> wall_nodes_;          ///< per curved wall
  mutable std::vector<double> local_;  ///< per cell residuals, written in parallel, summed in order
  SparseLU lu_;
};

/// Largest magnitude; not finite if any entry is not.
double largest(const std::vector<double>& x);

}  // namespace sprung::reference
