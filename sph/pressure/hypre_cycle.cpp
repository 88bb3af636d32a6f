#include "sph/pressure/hypre_cycle.hpp"

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <vector>

namespace sprung::sph {

struct HypreCycle {
  std::vector<HYPRE_BigInt> rows;
  HYPRE_Solver solver = nullptr;
  HYPRE_IJMatrix matrix = nullptr;
  HYPRE_IJVector right = nullptr, solution = nullptr;

  HYPRE_ParCSRMatrix csr() const {
    void* object = nullptr;
    HYPRE_IJMatrixGetObject(matrix, &object);
    return static_cast<HYPRE_ParCSRMatrix>(object);
  }
};

namespace {

/// hypre speaks MPI, even to itself. Started once, ended with the program.
void start_libraries() {
  static const bool started = [] {
    int there = 0;
    MPI_Initialized(&there);
    if (!there) {
      MPI_Init(nullptr, nullptr);
      std::atexit([] { MPI_Finalize(); });
    }
    HYPRE_Init();
    return true;
  }();
  (void)started;
}

HYPRE_ParVector vector(HYPRE_IJVector v) {
  void* object = nullptr;
  HYPRE_IJVectorGetObject(v, &object);
  return static_cast<HYPRE_ParVector>(object);
}

}  // namespace

HypreCycle* make_hypre_cycle(int n, int* counts, const int* columns, const double* values) {
  start_libraries();
  auto* cycle = new HypreCycle;
  auto& c = *cycle;
  c.rows.resize(n);
  std::iota(c.rows.begin(), c.rows.end(), 0);
  HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, n - 1, 0, n - 1, &c.matrix);
  HYPRE_IJMatrixSetObjectType(c.matrix, HYPRE_PARCSR);
  HYPRE_IJMatrixInitialize(c.matrix);
  HYPRE_IJMatrixSetValues(c.matrix, n, counts, c.rows.data(), columns, values);
  HYPRE_IJMatrixAssemble(c.matrix);
  for (HYPRE_IJVector* v : {&c.right, &c.solution}) {
    HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, n - 1, v);
    HYPRE_IJVectorSetObjectType(*v, HYPRE_PARCSR);
    HYPRE_IJVectorInitialize(*v);
    HYPRE_IJVectorAssemble(*v);
  }
  HYPRE_BoomerAMGCreate(&c.solver);
  HYPRE_BoomerAMGSetMaxIter(c.solver, 1);
  HYPRE_BoomerAMGSetTol(c.solver, 0.0);
  HYPRE_BoomerAMGSetCoarsenType(c.solver, 8);  // PMIS: the rows are long
  HYPRE_BoomerAMGSetInterpType(c.solver, 6);   // extended+i
  HYPRE_BoomerAMGSetPMaxElmts(c.solver, 4);
  HYPRE_BoomerAMGSetAggNumLevels(c.solver, 1);  // one aggressive level
  HYPRE_BoomerAMGSetRelaxType(c.solver, 6);     // symmetric Gauss-Seidel, as CG asks for
  HYPRE_BoomerAMGSetup(c.solver, c.csr(), vector(c.right), vector(c.solution));
  return cycle;
}

void apply_hypre_cycle(HypreCycle* cycle, const double* r, double* z) {
  auto& c = *cycle;
  const auto n = static_cast<HYPRE_Int>(c.rows.size());
  std::fill_n(z, n, 0.0);
  HYPRE_IJVectorSetValues(c.right, n, c.rows.data(), r);
  HYPRE_IJVectorSetValues(c.solution, n, c.rows.data(), z);
  HYPRE_BoomerAMGSolve(c.solver, c.csr(), vector(c.right), vector(c.solution));
  HYPRE_IJVectorGetValues(c.solution, n, c.rows.data(), z);
}

void free_hypre_cycle(HypreCycle* cycle) {
  HYPRE_BoomerAMGDestroy(cycle->solver);
  HYPRE_IJMatrixDestroy(cycle->matrix);
  HYPRE_IJVectorDestroy(cycle->right);
  HYPRE_IJVectorDestroy(cycle->solution);
  delete cycle;
}

}  // namespace sprung::sph
