#pragma once
/// Rest under dead loads.

#include "sph/effects/elastic_solid.hpp"

namespace sprung::calibration {

/// Static equilibrium of a network under dead forces (N, one per solid), found by Newton's method:
/// with a huge time step the implicit system of sph::ElasticSolid is its tangent stiffness, so the
/// solver's own springs are what is at rest here. Starts from `particles.position` and leaves the
/// equilibrium there. Returns the largest unbalanced force over the largest load: below
/// `tolerance`, or below 1e3 x tolerance where rounding allows no less. Throws std::runtime_error
/// without convergence.
template <int dim>
double find_equilibrium(sph::ElasticNetwork<dim> network, sph::Particles<dim>& particles,
                        const std::vector<sph::Vector<dim>>& load, double tolerance = 1e-8);

}  // namespace sprung::calibration
