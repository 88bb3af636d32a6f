#pragma once
/// Surface correction of bond stiffness: bonds as quadrature points over the true body.

#include "sph/effects/elastic_network.hpp"

namespace sprung::sph {

/// For displacements up to quadratic, a bond's extension over its length is the exact directional
/// strain at its midpoint, so each group of bonds (along the axes; diagonal) is a quadrature rule
/// for its part of the strain energy, and a beam bends rightly if the rule is exact for quadratics
/// of the place.
///
/// In the bulk each particle gives 1/2 to each of its four bonds of the group, which for the bonds
/// along the axes integrates 2 f + c lap f over its cell instead of 2 f (c = 1/24; lengths in dx).
/// Summed over the body the excess is c times the flux of grad f through its surface, and the bonds
/// that are missing there spoil the rule further. So each particle at a free surface (or with a cut
/// cell) must find weights delta on the bonds within 1.6 dx with
///   sum delta f(m) = 2 int_cell f + c (int_cell lap f - int_surface df/dn)   for f = 1, m_k, m_k
///   m_l,
/// closest to the bulk's; m is a bond's midpoint from the particle, the cell is what of the true
/// body lies nearest to the particle. A flat plate of n >= 3 layers then has exactly the
/// continuum's EA and EI; two rows cannot carry both. For the diagonals, which carry the shear,
/// only f = 1 is asked (within 1.3 dx): the flow of shear between two layers is given by
/// equilibrium, so a rule that raises one layer at its neighbour's cost would make the plate too
/// soft in shear, however well it integrates. A bond's stiffness is multiplied by the sum of the
/// weights it was given, at least 0.3. Bonds to the ghosts of a clamp count twice: half their
/// length is material. Nothing is fitted. `first_bond`: where the body's bonds begin; particles
/// `first` to `last`.
void weigh_bonds(ElasticNetwork<2>& network, std::size_t first_bond, std::size_t first,
                 std::size_t last, const Solid& solid, double spacing);

}  // namespace sprung::sph
