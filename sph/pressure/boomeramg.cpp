/// Conjugate gradients with one V-cycle of hypre's BoomerAMG.

#include "sph/on_demand.hpp"
#include "sph/pressure/assembled.hpp"
#include "sph/pressure/conjugate_gradients.hpp"
#include "sph/pressure/hypre_cycle.hpp"

namespace sprung::sph {

namespace {

class BoomerAmg final : public Preconditioner {
 public:
  void prepare(const PressureMatrix& matrix, const CellMap&) override {
    auto all = assembled(matrix, Part::all, 1e-6);
    std::vector<int> counts(matrix.rows());
    for (std::size_t i = 0; i < counts.size(); ++i)
      counts[i] = all.outerIndexPtr()[i + 1] - all.outerIndexPtr()[i];
    cycle_.reset(
        make_(static_cast<int>(counts.size()), counts.data(), all.innerIndexPtr(), all.valuePtr()));
  }

  void apply(const PressureMatrix& matrix, const std::vector<double>& r,
             std::vector<double>& z) override {
    without_mean_ = r;
    // Constants, which a singular matrix does not see, would come back multiplied by the inverse of
    // the shift.
    if (matrix.singular()) remove_mean(without_mean_);
    apply_(cycle_.get(), without_mean_.data(), z.data());
    if (matrix.singular()) remove_mean(z);
  }

 private:
  decltype(make_hypre_cycle)* make_ =
      on_demand<decltype(make_hypre_cycle)>("sprung-hypre", "make_hypre_cycle");
  decltype(apply_hypre_cycle)* apply_ =
      on_demand<decltype(apply_hypre_cycle)>("sprung-hypre", "apply_hypre_cycle");
  std::unique_ptr<HypreCycle, decltype(free_hypre_cycle)*> cycle_{
      nullptr, on_demand<decltype(free_hypre_cycle)>("sprung-hypre", "free_hypre_cycle")};
  std::vector<double> without_mean_;
};

}  // namespace

std::unique_ptr<PressureSolver> make_boomeramg_solver() {
  return conjugate_gradients(std::make_unique<BoomerAmg>());
}

}  // namespace sprung::sph
