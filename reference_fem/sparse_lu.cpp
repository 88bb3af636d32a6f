#include "reference_fem/sparse_lu.hpp"

#include <suitesparse/umfpack.h>

#include <array>
#include <stdexcept>
#include <string>

namespace sprung::reference {
namespace {

std::array<double, UMFPACK_CONTROL> settings() {
  std::array<double, UMFPACK_CONTROL> control{};
  umfpack_di_defaults(control.data());
  // The pattern is symmetric and the diagonal is strong: pivots stay on it unless they are far too
  // small.
  control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  control[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
  // The Newton iteration is the refinement.
  control[UMFPACK_IRSTEP] = 0;
  return control;
}

void check(int status, const char* what) {
  if (status == UMFPACK_WARNING_singular_matrix)
    throw std::runtime_error(std::string("UMFPACK: the matrix is singular (") + what + ")");
  if (status == UMFPACK_ERROR_out_of_memory)
    throw std::runtime_error(std::string("UMFPACK: out of memory (") + what +
                             "); use larger cells (reference_fem.cell_size)");
  if (status != UMFPACK_OK)
    throw std::runtime_error(std::string("UMFPACK: ") + what + " failed with status " +
                             std::to_string(status));
}

}  // namespace

SparseLU::~SparseLU() {
  release();
}

void SparseLU::release() {
  if (numeric_ != nullptr) umfpack_di_free_numeric(&numeric_);
  if (symbolic_ != nullptr) umfpack_di_free_symbolic(&symbolic_);
  numeric_ = symbolic_ = nullptr;
}

void SparseLU::factorize(const SparseColumns& matrix) {
  auto control = settings();
  std::array<double, UMFPACK_INFO> info{};
  if (matrix_ != &matrix) release();
  matrix_ = &matrix;
  if (symbolic_ == nullptr)
    check(umfpack_di_symbolic(matrix.size, matrix.size, matrix.start.data(), matrix.row.data(),
                              matrix.value.data(), &symbolic_, control.data(), info.data()),
          "symbolic analysis");
  if (numeric_ != nullptr) umfpack_di_free_numeric(&numeric_);
  check(umfpack_di_numeric(matrix.start.data(), matrix.row.data(), matrix.value.data(), symbolic_,
                           &numeric_, control.data(), info.data()),
        "factorisation");
  factor_entries_ = info[UMFPACK_LNZ] + info[UMFPACK_UNZ];
}

void SparseLU::solve(const std::vector<double>& b, std::vector<double>& x) const {
  auto control = settings();
  std::array<double, UMFPACK_INFO> info{};
  x.resize(b.size());
  check(
      umfpack_di_solve(UMFPACK_A, matrix_->start.data(), matrix_->row.data(), matrix_->value.data(),
                       x.data(), b.data(), numeric_, control.data(), info.data()),
      "solution");
}

}  // namespace sprung::reference
