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

}  // namespace sprung::calibration
