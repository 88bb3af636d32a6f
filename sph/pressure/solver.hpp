#pragma once
/// Solvers of the pressure equation. One virtual call per solve; none inside a sweep.

#include "sph/pressure/cell_levels.hpp"

#include <memory>
#include <string>

namespace sprung::sph {

struct SolveReport {
  int iterations = 0;
  double relative_residual = 0.0;  ///< |b - A x| / |b|
  bool converged = true;
};

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;
  /// Called once per matrix, before the first solve with it. `map` groups the unknowns for solvers
  /// with coarse levels; it must stay until the last solve.
  virtual void prepare(const PressureMatrix& matrix, const CellMap& map) = 0;
  /// Improves `x` until |b - A x| <= tolerance |b|. `x` comes in as the first guess.
  virtual SolveReport solve(const PressureMatrix& matrix, std::span<const double> b,
                            std::span<double> x, double tolerance) = 0;
};

/// Conjugate gradients, preconditioned by one symmetric Gauss-Seidel sweep and a V-cycle on the
/// cells.
std::unique_ptr<PressureSolver> make_two_level_solver();
/// Conjugate gradients with other preconditioners: the diagonal, Eigen's incomplete factors, one
/// V-cycle of hypre's BoomerAMG.
std::unique_ptr<PressureSolver> make_jacobi_solver();
std::unique_ptr<PressureSolver> make_incomplete_cholesky_solver();
std::unique_ptr<PressureSolver> make_boomeramg_solver();
/// Sparse Cholesky factors, direct.
std::unique_ptr<PressureSolver> make_cholmod_solver();
/// BiCGSTAB with the diagonal, the paper's choice (van der Vorst 1992).
std::unique_ptr<PressureSolver> make_bicgstab_solver();

/// Dot product summed in blocks of fixed size: the same bits for any number of threads.
double dot(std::span<const double> a, std::span<const double> b);
/// Subtracts the mean: a pressure that is known up to a constant, or a source that it can answer.
void remove_mean(std::span<double> values);

}  // namespace sprung::sph
