#pragma once
/// Numerical choices, each with a price. `paper` is the scheme as printed; `recommended` is what
/// measurement found to hold. Every choice can be named on its own in [numerics].

#include "scene/document.hpp"

#include <string>

namespace sprung::sph {

enum class PositionUpdate {
  mean_velocity,  ///< ACTION 8 as printed: unstable for springs unless damped
  new_velocity,   ///< symplectic
};
enum class SpringIntegration { explicit_force, implicit_force };
enum class Bonds {
  equal,      ///< every bond k_e dx: the paper's Eq. 5
  isotropic,  ///< weights by shell so that the lattice is elastically isotropic
};
enum class Shifting { none, xu, fickian, sliding };
/// Where the velocity of a body meets the fluid's.
enum class SolidNoSlip {
  centres,  ///< at the outer particles' centres, half a spacing inside the body: Eq. 2 as printed
  face,     ///< at the body's face
};
enum class PressureSolverKind {
  bicgstab,             ///< with the diagonal: the paper's
  two_level,            ///< CG, Gauss-Seidel and coarse cells
  jacobi_cg,            ///< CG with the diagonal
  incomplete_cholesky,  ///< CG with Eigen's incomplete factors
  cholmod,              ///< direct, sparse Cholesky
  boomeramg,            ///< CG with hypre's algebraic multigrid
};

struct Numerics {
  std::string preset;
  double smoothing_length_ratio = 0.0;  ///< h / spacing
  bool normalised_gradient = false;     ///< divide the gradient by its lattice factor
  /// Gradients and divergences exact for linear fields on any distribution (Bonet & Lok 1999).
  bool gradient_correction = false;
  PositionUpdate position_update{};
  Shifting shifting{};
  double shifting_coefficient = 0.0;  ///< C; see effects/shifting.hpp
  /// The new velocity keeps each particle's volume along the step, and not at its beginning.
  bool volume_along_step = false;
  /// A wrong filling is corrected at the rate density_feedback x velocity scale / spacing (1/s);
  /// see filling.hpp. 0: none.
  double density_feedback = 0.0;
  /// What of a particle's kernel sum differs from the mean by more than disorder makes it is
  /// corrected at the rate void_feedback x velocity of the fastest particle / spacing (1/s), at
  /// most within a step: voids and clumps. 0: none.
  double void_feedback = 0.0;
  double pressure_tolerance = 0.0;
  PressureSolverKind pressure_solver{};
  /// Times that a step solves the pressure equation in a scene with elastic bodies, to a hundred
  /// times the tolerance each if more than one; without a body it is solved once. See
  /// Simulation::project_what_is_left.
  int body_projections = 1;
  Bonds bonds{};
  /// Bodies along the axes that do not fill whole cells of the fluid's lattice get one of their
  /// own, as bodies at an angle do; false: the lattice's sites inside them.
  bool fitted_bodies = false;
  SolidNoSlip solid_no_slip{};
  bool surface_correction = false;  ///< bond weights as quadrature over the true body
  double area_stiffness = 0.0;      ///< kappa: area springs of modulus kappa G; 0: none
  SpringIntegration spring_integration{};
  double courant = 0.0;  ///< dt u_max / spacing
};

/// Reads [numerics]; keys that are absent take the preset's value, which is written into the
/// record.
Numerics read_numerics(Document& document);

}  // namespace sprung::sph
