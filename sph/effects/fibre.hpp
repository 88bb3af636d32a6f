#pragma once
/// Fibres in a body: an additional modulus along one direction.

#include "scene/problem.hpp"
#include "sph/effects/elastic_network.hpp"

namespace sprung::sph {

/// Adds the energy E_f (a . strain . a)2 / 2 per volume to the bonds of one body, a the fibres'
/// direction at rest in the body's own axes. At each particle the strain along a is read off its
/// bonds: the smallest numbers p with sum p_b n_b n_b = a a give a . strain . a = sum p_b strain_b
/// for any even strain, so any direction is met exactly; E_f V (sum p_b strain_b)2 / 2 ties the
/// bonds (BondTie). Across n rows bending along the fibres gets (1 - 1/n2) of its share.
template <int dim>
void add_fibres(ElasticNetwork<dim>& network, const Particles<dim>& particles, std::size_t first,
                std::size_t last, const Solid& solid);

}  // namespace sprung::sph
