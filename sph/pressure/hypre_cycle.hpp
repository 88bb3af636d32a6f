#pragma once
/// What the module sprung-hypre does; see sph/on_demand.hpp.

namespace sprung::sph {

struct HypreCycle;  ///< BoomerAMG's levels for one matrix

extern "C" {

/// The levels for `n` rows of `counts` entries each, row after row in `columns` and `values`.
HypreCycle* make_hypre_cycle(int n, int* counts, const int* columns, const double* values);

/// z = one V-cycle for A z = r, from zero.
void apply_hypre_cycle(HypreCycle* cycle, const double* r, double* z);

void free_hypre_cycle(HypreCycle* cycle);
}

}  // namespace sprung::sph
