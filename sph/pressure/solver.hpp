#pragma once
/// Solvers of the pressure equation. One virtual call per solve; none inside a sweep.

#include "sph/pressure/matrix.hpp"

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
  /// Called once per matrix, before the first solve with it. `cell_of` groups the unknowns for
  /// solvers with a coarse level.
  virtual void prepare(const PressureMatrix& matrix, std::span<const std::int32_t> cell_of,
                       std::span<const std::int32_t> cell_extent) = 0;
  /// Improves `x` until |b - A x| <= tolerance |b|. `x` comes in as the first guess.
  virtual SolveReport solve(const PressureMatrix& matrix, std::span<const double> b,
                            std::span<double> x, double tolerance) = 0;
};

/// Conjugate gradients, preconditioned by one symmetric Gauss-Seidel sweep and a piecewise constant
/// coarse grid of search cells that CHOLMOD solves directly.
std::unique_ptr<PressureSolver> make_two_level_solver();
/// BiCGSTAB with the diagonal, the paper's choice (van der Vorst 1992).
std::unique_ptr<PressureSolver> make_bicgstab_solver();

/// Dot product summed in blocks of fixed size: the same bits for any number of threads.
double dot(std::span<const double> a, std::span<const double> b);

}  // namespace sprung::sph
