#pragma once
/// The first guess of the pressure equation: each particle's psi of the step before.

#include "sph/neighbours.hpp"
#include "sph/particles.hpp"

namespace sprung::sph {

/// Gives the particles that have no psi of a step before the mean of their neighbours', each
/// counting by its coefficient of the pressure matrix. Those are the ones that an inflow column let
/// go: a column's psi is 0, to the last bit. Left at 0 among neighbours at the pressure of the
/// inflow, the ten of a step made the first residual a hundred times as large.
template <int dim>
void guess_newcomers(Particles<dim>& particles, const Support<dim>& support);

}  // namespace sprung::sph
