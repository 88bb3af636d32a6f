#pragma once
/// Conjugate gradients with a choice of preconditioner (Hestenes & Stiefel 1952).

#include "sph/pressure/solver.hpp"

namespace sprung::sph {

/// A symmetric positive definite approximation of the inverse. One virtual call per application.
class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void prepare(const PressureMatrix& matrix, const CellMap& map) = 0;
  /// z = M^-1 r; both of the matrix's size.
  virtual void apply(const PressureMatrix& matrix, const std::vector<double>& r,
                     std::vector<double>& z) = 0;
};

std::unique_ptr<PressureSolver> conjugate_gradients(std::unique_ptr<Preconditioner> preconditioner);

}  // namespace sprung::sph
