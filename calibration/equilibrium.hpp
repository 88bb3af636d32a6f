#pragma once
/// Rest under dead loads.

#include "sph/effects/elastic_solid.hpp"

#include <functional>
#include <vector>

namespace sprung::calibration {

/// Static equilibrium of a network under dead forces (N, one per solid), found by Newton's method:
/// with a huge time step the implicit system of sph::ElasticSolid is its tangent stiffness, so the
/// solver's own springs are what is at rest here. Starts from `particles.position` and leaves the
/// equilibrium there. Returns the largest unbalanced force over the largest load: below
/// `tolerance`, or below 1e3 x tolerance where rounding allows no less. Throws std::runtime_error
/// without convergence. `keep`, if there, is applied to the positions after every step: what the
/// equilibrium's symmetry says of them.
template <int dim>
double find_equilibrium(sph::ElasticNetwork<dim> network, sph::Particles<dim>& particles,
                        const std::vector<sph::Vector<dim>>& load, double tolerance = 1e-8,
                        const std::function<void(std::vector<sph::Vector<dim>>&)>& keep = {});

/// What dead forces (N, one per solid) do to a clamped network at rest, to first order: K^-1 load,
/// m. The response is linear, so the load's size is free and no digits are lost to the rounding of
/// positions: that of a plate 10 n rows long and n thick, in its stiff cells, is 5e-4 of a load
/// that keeps 32 layers' deflection small.
template <int dim>
std::vector<sph::Vector<dim>> linear_response(const sph::ElasticNetwork<dim>& network,
                                              const sph::Particles<dim>& particles,
                                              const std::vector<sph::Vector<dim>>& load);

}  // namespace sprung::calibration
