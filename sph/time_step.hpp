#pragma once
/// One time step of the method, ACTION by ACTION as in section 3.3 of the paper. ACTIONs 1 and 2
/// (solid particles, springs) belong to the set-up.

namespace sprung::sph {

template <int dim>
class Simulation;

/// Advances the simulation by its current time step.
template <int dim>
void advance(Simulation<dim>& simulation);

}  // namespace sprung::sph
