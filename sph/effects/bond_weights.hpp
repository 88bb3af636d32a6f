#pragma once
/// Surface correction of bond stiffness: bonds as quadrature points over the true body.

#include "sph/effects/elastic_network.hpp"

namespace sprung::sph {

/// For displacements up to quadratic, a bond's extension over its length is the exact directional strain
/// at its midpoint, so each group of bonds (along the axes; diagonal) is a quadrature rule for its part of
/// the strain energy. For each particle whose lattice cell is not wholly filled with neighbours, the area
/// A and centroid c of the true body nearest to it are taken, and weights delta >= 0 on the group's bonds
/// near it are found with sum delta = 2A and sum delta m = 2A c (m: midpoint from the particle; areas in
/// units of dx^2), closest to the bulk rule (1/2 on each of its own bonds). A bond's stiffness is
/// multiplied by the sum of the weights that particles gave it, at least 0.3. Bonds to the ghosts of a clamp
/// count twice: half their length is material. Nothing is fitted. Bulk bonds keep weight 1.
/// `first_bond`: where the body's bonds begin; particles `first` to `last`.
void weigh_bonds(ElasticNetwork<2>& network, std::size_t first_bond, std::size_t first,
                 std::size_t last, const Solid& solid, double spacing);

}  // namespace sprung::sph
