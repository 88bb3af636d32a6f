#pragma once
/// UMFPACK with the analysis of the pattern kept, so that a new factorisation costs only its
/// numbers.

#include <vector>

namespace sprung::reference {

/// Square matrix in compressed columns (Ap, Ai sorted per column).
struct SparseColumns {
  int size = 0;
  std::vector<int> start;
  std::vector<int> row;
  std::vector<double> value;
};

class SparseLU {
 public:
  SparseLU() = default;
  ~SparseLU();
  SparseLU(const SparseLU&) = delete;
  SparseLU& operator=(const SparseLU&) = delete;

  /// Factorises; the first call, or one with another pattern, also orders the unknowns.
  /// Throws std::runtime_error if the matrix is singular or memory runs out.
  void factorize(const SparseColumns& matrix);
  /// x = A^-1 b.
  void solve(const std::vector<double>& b, std::vector<double>& x) const;
  double factor_entries() const { return factor_entries_; }

 private:
  void release();
  const SparseColumns* matrix_ = nullptr;
  void* symbolic_ = nullptr;
  void* numeric_ = nullptr;
  double factor_entries_ = 0.0;
};

}  // namespace sprung::reference
