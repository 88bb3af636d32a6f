#pragma once
/// The solid as a network: particles tied by springs (ACTIONs 1 and 2, Eq. 5) and, if the numerics
/// ask for it, area springs that keep the cells of the lattice incompressible.

#include "scene/problem.hpp"
#include "sph/numerics.hpp"
#include "sph/particles.hpp"

#include <array>

namespace sprung::sph {

/// A linear spring between two nodes; force = stiffness x (rest_length - length).
struct Bond {
  std::int32_t a, b;
  double rest_length;  ///< m
  double stiffness;    ///< k_e dx w, N/m (per metre of depth in the plane: k_e w)
};

/// Four lattice neighbours in the plane, counter-clockwise, whose area is kept by p = -modulus
/// (A/A_0 - 1).
struct AreaCell {
  std::array<std::int32_t, 4> corner;
  double rest_area;  ///< m2
  double modulus;    ///< kappa G, Pa
};

/// Nodes are the solid particles (in their order in Particles) and then the fixed ghosts of the
/// clamps.
template <int dim>
struct ElasticNetwork {
  std::vector<Vector<dim>> reference;  ///< positions at rest, solids then ghosts, m
  std::size_t movable = 0;             ///< number of solids
  std::vector<Bond> bonds;
  std::vector<AreaCell> cells;
  /// Lattice cells between solid particles, with or without an area spring: they measure the body's
  /// area.
  std::vector<std::array<std::int32_t, 4>> body_cells;
};

/// Offsets of the bonds that a particle has on the lattice, one of each pair, and their weight.
template <int dim>
struct BondShell {
  std::array<int, dim> offset;
  double weight;
};

/// Shells closer than 2 dx with a cut well between shells: `<= 2 dx` would be decided by rounding
/// and admit the fourth shell. `equal`: 8 bonds in the plane and 26 in space, all of weight 1 (Fig.
/// 2). `isotropic`: weight 1 along the axes; 1/2 on the diagonals of the plane; in space 18 bonds
/// of weight 1. Condition for isotropy (from equating C11 - C12 and 2 C44): 2D w1 = 2 w2; 3D w1 =
/// w2 + 8/3 w3.
template <int dim>
std::vector<BondShell<dim>> bond_shells(Bonds bonds);

/// Shear modulus of the lattice without area springs, C44 of the bonds along its axes: k_e/2 ((C11
/// - C12)/2 = k_e/2 for both lattices of the plane); in space k_e.
template <int dim>
double network_shear_modulus(double k_e, Bonds) {
  return dim == 2 ? 0.5 * k_e : k_e;
}

/// C44 of the lattice along its axes, Pa: the sum of k_e w r_x^2 r_y^2 / (r dx)^2 over a particle's
/// bonds, each pair counted once.
template <int dim>
double shear_stiffness(double k_e, Bonds bonds) {
  double sum = 0.0;
  for (const auto& shell : bond_shells<dim>(bonds)) {
    double length2 = 0.0;
    for (const int o : shell.offset) length2 += o * o;
    sum += shell.weight * shell.offset[0] * shell.offset[0] * shell.offset[1] * shell.offset[1] /
           length2;
  }
  return k_e * sum;
}

struct SpringStiffness {
  double k_e = 0.0;            ///< spring stiffness, Pa
  double shear_modulus = 0.0;  ///< G of the network, Pa
};

/// A network without springs whose nodes are the solid particles where they are now.
template <int dim>
ElasticNetwork<dim> network_at_rest(const Particles<dim>& particles);

/// Adds the springs, cells and ghosts of one body whose particles are `first` to `last` (exclusive)
/// of `particles`, at rest on the lattice. Ghosts are one row beyond the clamp. Throws
/// std::invalid_argument for a body one particle thick.
template <int dim>
void append_body(ElasticNetwork<dim>& network, const Particles<dim>& particles, std::size_t first,
                 std::size_t last, const Solid& solid, const Numerics& numerics,
                 const SpringStiffness& stiffness);

/// Forces of bonds and cells on the nodes at `position` (ghosts stay at rest), N (per metre in the
/// plane).
template <int dim>
void elastic_forces(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position,
                    std::vector<Vector<dim>>& force);

/// Energy stored in bonds and cells, J (per metre in the plane).
template <int dim>
double elastic_energy(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position);

/// Largest and smallest length of a bond over its rest length.
template <int dim>
std::pair<double, double> stretch_range(const ElasticNetwork<dim>& network,
                                        std::span<const Vector<dim>> position);

/// Area of a quadrilateral and its gradient with respect to each corner.
double quadrilateral_area(const std::array<Vector<2>, 4>& corner,
                          std::array<Vector<2>, 4>& gradient);

}  // namespace sprung::sph
