#pragma once
/// Blocks of lattice particles as specimens of the material, and their networks of springs.

#include "sph/effects/elastic_network.hpp"

#include <array>

namespace sprung::calibration {

template <int dim>
using Vector = sph::Vector<dim>;

/// Properties of every specimen. lambda does not depend on them (tested): only on ratios to k_e.
inline constexpr double density = 1000.0;          ///< kg/m3
inline constexpr double spring_stiffness = 1.0e6;  ///< k_e, Pa
inline constexpr double side = 0.1;  ///< extent along the first axis, m: the paper's cube

/// A lattice material: bonds, and area springs of modulus `area_stiffness` x G where that is not 0.
struct Material {
  int dimension = 2;
  sph::Bonds bonds = sph::Bonds::equal;
  double area_stiffness = 0.0;
};

/// Word of the scene file and of the table: "equal", "isotropic".
const char* to_string(sph::Bonds bonds);

/// `count` particles along each axis at the centres of cubes of side `spacing` (m); the block's
/// corner is the origin. Number of a particle: first axis fastest.
template <int dim>
sph::Particles<dim> block(const std::array<int, dim>& count, double spacing);

/// Particles fitted to an oblique body, the first own axis fastest.
template <int dim>
sph::Particles<dim> fitted(const Solid& shape, double spacing);

/// The shape that block() fills, `count` x spacing along each axis.
template <int dim>
Solid shape_of(const std::array<int, dim>& count, double spacing);

/// Springs of stiffness `spring_stiffness` between the particles of a block.
template <int dim>
sph::ElasticNetwork<dim> network_of(const sph::Particles<dim>& particles, const Solid& shape,
                                    const Material& material, bool surface_correction = false);

/// Place of particle `i` of a block on the lattice.
template <int dim>
std::array<int, dim> lattice_place(std::size_t i, const std::array<int, dim>& count) {
  std::array<int, dim> place;
  for (int d = 0; d < dim; ++d) {
    place[d] = static_cast<int>(i % count[d]);
    i /= count[d];
  }
  return place;
}

}  // namespace sprung::calibration
