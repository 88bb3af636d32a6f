/// Conjugate gradients with one V-cycle of hypre's BoomerAMG.

#include "sph/pressure/assembled.hpp"
#include "sph/pressure/conjugate_gradients.hpp"

#include <HYPRE.h>
#include <HYPRE_IJ_mv.h>
#include <HYPRE_parcsr_ls.h>
#include <mpi.h>

#include <cstdlib>
#include <numeric>

namespace sprung::sph {

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

class BoomerAmg final : public Preconditioner {
 public:
  BoomerAmg() { start_libraries(); }
  ~BoomerAmg() override { release(); }
  BoomerAmg(const BoomerAmg&) = delete;
  BoomerAmg& operator=(const BoomerAmg&) = delete;

  void prepare(const PressureMatrix& matrix, const CellMap&) override {
    release();
    rows_.resize(matrix.rows());
    std::iota(rows_.begin(), rows_.end(), 0);
    const auto last = static_cast<HYPRE_BigInt>(matrix.rows()) - 1;
    HYPRE_IJMatrixCreate(MPI_COMM_SELF, 0, last, 0, last, &matrix_);
    HYPRE_IJMatrixSetObjectType(matrix_, HYPRE_PARCSR);
    HYPRE_IJMatrixInitialize(matrix_);
    auto all = assembled(matrix, Part::all, 1e-6);
    std::vector<HYPRE_Int> counts(matrix.rows());
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] = all.outerIndexPtr()[i + 1] - all.outerIndexPtr()[i];
    HYPRE_IJMatrixSetValues(matrix_, last + 1, counts.data(), rows_.data(), all.innerIndexPtr(),
                            all.valuePtr());
    HYPRE_IJMatrixAssemble(matrix_);
    for (HYPRE_IJVector* v : {&right_, &solution_}) {
      HYPRE_IJVectorCreate(MPI_COMM_SELF, 0, last, v);
      HYPRE_IJVectorSetObjectType(*v, HYPRE_PARCSR);
      HYPRE_IJVectorInitialize(*v);
      HYPRE_IJVectorAssemble(*v);
    }
    HYPRE_BoomerAMGCreate(&solver_);
    HYPRE_BoomerAMGSetMaxIter(solver_, 1);
    HYPRE_BoomerAMGSetTol(solver_, 0.0);
    HYPRE_BoomerAMGSetCoarsenType(solver_, 8);  // PMIS: the rows are long
    HYPRE_BoomerAMGSetInterpType(solver_, 6);   // extended+i
    HYPRE_BoomerAMGSetPMaxElmts(solver_, 4);
    HYPRE_BoomerAMGSetAggNumLevels(solver_, 1);  // one aggressive level
    HYPRE_BoomerAMGSetRelaxType(solver_, 6);     // symmetric Gauss-Seidel, as CG asks for
    HYPRE_BoomerAMGSetup(solver_, csr(), vector(right_), vector(solution_));
  }

  void apply(const PressureMatrix& matrix, const std::vector<double>& r,
             std::vector<double>& z) override {
    const auto n = static_cast<HYPRE_Int>(rows_.size());
    std::fill(z.begin(), z.end(), 0.0);
    without_mean_ = r;
    // Constants, which a singular matrix does not see, would come back multiplied by the inverse of
    // the shift.
    if (matrix.singular()) remove_mean(without_mean_);
    HYPRE_IJVectorSetValues(right_, n, rows_.data(), without_mean_.data());
    HYPRE_IJVectorSetValues(solution_, n, rows_.data(), z.data());
    HYPRE_BoomerAMGSolve(solver_, csr(), vector(right_), vector(solution_));
    HYPRE_IJVectorGetValues(solution_, n, rows_.data(), z.data());
    if (matrix.singular()) remove_mean(z);
  }

 private:
  HYPRE_ParCSRMatrix csr() const {
    void* object = nullptr;
    HYPRE_IJMatrixGetObject(matrix_, &object);
    return static_cast<HYPRE_ParCSRMatrix>(object);
  }
  static HYPRE_ParVector vector(HYPRE_IJVector v) {
    void* object = nullptr;
    HYPRE_IJVectorGetObject(v, &object);
    return static_cast<HYPRE_ParVector>(object);
  }
  void release() {
    if (!solver_) return;
    HYPRE_BoomerAMGDestroy(solver_);
    HYPRE_IJMatrixDestroy(matrix_);
    HYPRE_IJVectorDestroy(right_);
    HYPRE_IJVectorDestroy(solution_);
    solver_ = nullptr;
  }

  std::vector<HYPRE_BigInt> rows_;
  std::vector<double> without_mean_;
  HYPRE_Solver solver_ = nullptr;
  HYPRE_IJMatrix matrix_ = nullptr;
  HYPRE_IJVector right_ = nullptr, solution_ = nullptr;
};

}  // namespace

std::unique_ptr<PressureSolver> make_boomeramg_solver() {
  return conjugate_gradients(std::make_unique<BoomerAmg>());
}

}  // namespace sprung::sph
