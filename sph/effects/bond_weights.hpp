#pragma once
/// Surface correction of bond stiffness: bonds as quadrature points over the true body.

#include "sph/effects/elastic_network.hpp"

namespace sprung::sph {

/// For displacements up to quadratic, a bond's extension over its length is the exact strain along
/// it at its midpoint. The energy of the incompressible solid is G (sum e_aa^2 + 2 sum e_ab^2) per
/// volume, and each term is measured by a group of bonds, whose strains m (lengths in places) are
///   normal, axis a:  bonds along a: +e_aa; and the other sign, of the same amount because the
///                    volume is kept: in the plane the bonds along the other axis; in space the
///                    sum of the two diagonals of each lattice square normal to a;
///   shear, axes ab:  the difference of the two diagonals of a square of a and b: 2 e_ab;
///   (plane only)     the sum of the two diagonals: the dilation, 0 but for the area springs' give.
/// In the bulk a particle gives each bond along an axis 1/2 and each square 1/4 (1/8 in the plane,
/// whose diagonals weigh half), which integrates types x f + D_kl d_k d_l f over its cell for f =
/// m^2: half the squared offset of the midpoints less 1/24 of the cell's own extent. Summed over
/// the body the excess is D times the flux of grad f through its surface; the bonds that are
/// missing there spoil the rule further. So a particle at a free surface gets what a strain that
/// varies linearly stores:
///   Q(m, m) = types int_cell m^2 + D_kl (int_cell d_k d_l m^2 - int_surface n_k d_l m^2),
/// where value and gradient of m are those of the line through the measures of the particle and of
/// its neighbours inwards (least squares, its own first), and the cell is what of the true body is
/// nearest to the particle. What the line does not hold keeps the bulk's weights on the particle's
/// own measures, so no motion loses its stiffness. The energy is a sum of squares of linear
/// combinations of bond strains: near a surface a bond also feels its neighbours (BondTie). A
/// plate of two layers or more then has exactly the continuum's stiffness in stretching, bending
/// and twisting, for strains up to linear; nothing is fitted. Where no measure tells a gradient (one
/// layer) the strain is taken as even, so one layer does not resist bending.
/// Bonds to the ghosts of a clamp: half their length is material, so the strain is twice what the
/// bond shows. `first_bond`: where the body's bonds begin.
template <int dim>
void weigh_bonds(ElasticNetwork<dim>& network, std::size_t first_bond,
                 const BodyLattice<dim>& lattice, double k_e);

}  // namespace sprung::sph
