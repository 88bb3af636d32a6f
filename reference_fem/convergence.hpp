#pragma once
/// The reference's own error bar: the scene on three nested meshes and with three time steps,
/// extrapolated.

#include "reference_fem/simulation.hpp"

#include <optional>

namespace sprung::reference {

/// A quantity from three discretisations, each twice as fine as the one before.
struct Extrapolation {
  std::optional<double> observed_order;  ///< none if the differences do not shrink with one sign
  double order = 1.0;                    ///< the order the extrapolation trusts
  double limit = 0.0;                    ///< the value at vanishing size
  double error_of_middle = 0.0;          ///< half-width for the middle one, with its safety factor
  double index_of_finest = 0.0;  ///< grid convergence index of the finest, in the quantity's unit
};

/// Richardson extrapolation with Roache's grid convergence index (safety factor 1.25), for sizes
/// 2h, h, h/2. The order is what the three values show, kept between 1 and `highest`: an order
/// below one, or values that do not converge with one sign, count as first order, which widens the
/// bar.
Extrapolation extrapolate(double coarse, double middle, double fine, double highest);

/// Runs the scene into `options.out` and its variants into `options.out`/convergence, writes
/// error_bar.json and error_bar.csv beside the record, and prints the table. `file` and `overrides`
/// are the scene's own. With `options.resume`, runs that stand there finished are kept and others
/// taken up.
void run_convergence(const std::filesystem::path& file, const std::vector<std::string>& overrides,
                     const RunOptions& options);

}  // namespace sprung::reference
