#pragma once
/// The solid as a network: particles tied by springs (ACTIONs 1 and 2, Eq. 5) and, if the numerics
/// ask for it, area springs (in space: volume springs) that keep the cells of the body's lattice
/// incompressible.

#include "scene/problem.hpp"
#include "sph/numerics.hpp"
#include "sph/particles.hpp"

#include <array>
#include <map>
#include <span>

namespace sprung::sph {

/// A linear spring between two nodes; force = stiffness x (rest_length - length).
struct Bond {
  std::int32_t a, b;
  double rest_length;  ///< m
  double stiffness;    ///< k_e dx w, N/m (per metre of depth in the plane: k_e w)
};

/// Two bonds of which each also feels the other's strain: stored energy stiffness x strain_first x
/// strain_second, strain = extension / rest length. The surface correction makes them.
struct BondTie {
  std::int32_t first, second;  ///< numbers of the bonds
  double stiffness;            ///< J (J/m in the plane), of either sign
};

/// The corners of one cell of a body's lattice, whose area (in space: volume) is kept by p =
/// -modulus (V/V_0 - 1). Corners: in the plane counter-clockwise; in space the four of the lower
/// face, counter-clockwise seen from above, then those above them.
template <int dim>
struct VolumeCell {
  std::array<std::int32_t, 1 << dim> corner;
  double rest_volume;  ///< m2 or m3
  double modulus;      ///< kappa G, Pa
};

/// Nodes are the solid particles (in their order in Particles) and then the fixed ghosts of the
/// clamps.
template <int dim>
struct ElasticNetwork {
  std::vector<Vector<dim>> reference;  ///< positions at rest, solids then ghosts, m
  std::size_t movable = 0;             ///< number of solids
  std::vector<double> volume;          ///< of each solid's cell at rest, m2 or m3
  std::vector<Bond> bonds;
  std::vector<VolumeCell<dim>> cells;
  /// Lattice cells between solid particles, with or without a spring: they measure the body's
  /// volume.
  std::vector<std::array<std::int32_t, 1 << dim>> body_cells;
  std::vector<BondTie> ties = {};
  /// Of each bond, N/m (Pa in the plane): without surface correction.
  std::vector<double> bulk_stiffness = {};
};

/// A body's particles on the body's own lattice. Its pitch is the particle spacing, or for a body
/// with fitted places a little off so that a whole number fits.
template <int dim>
struct BodyLattice {
  using Place = std::array<int, dim>;
  std::map<Place, std::int32_t> node;  ///< ghosts of the clamp included
  Place lowest{}, highest{};           ///< places of the particles
  /// The body's faces, in places: half a place beyond the outer particles where the body fills its
  /// cells.
  Vector<dim> low_face, high_face;
  /// In the order of Side: whether the face is free (not held by a clamp).
  std::array<bool, 2 * dim> free{};
  /// Volume of a cell at a node, m2 or m3.
  std::vector<double> cell_volume;
  std::int32_t find(const Place& place) const {
    const auto found = node.find(place);
    return found == node.end() ? -1 : found->second;
  }
};

/// Particles of a body fitted to its own lattice, each at the centre of a cell; `spacing` is the
/// pitch aimed at.
template <int dim>
std::vector<Vector<dim>> fitted_places(const Solid& solid, double spacing);

/// Volume of the cell at each of a body's `places` at rest, m2 or m3. `fitted`: see
/// Numerics::fitted_bodies.
template <int dim>
std::vector<double> cell_volumes(const Solid& solid, std::span<const Vector<dim>> places,
                                 double spacing, bool fitted);

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
/// of `particles`, at rest on the body's lattice. Ghosts are one row beyond the clamp. Throws
/// std::invalid_argument for a single particle, and for a surface correction of bonds in space that
/// are not isotropic.
template <int dim>
void append_body(ElasticNetwork<dim>& network, const Particles<dim>& particles, std::size_t first,
                 std::size_t last, const Solid& solid, const Numerics& numerics,
                 const SpringStiffness& stiffness);

/// Tension of every bond at `position`, N (per metre in the plane), + pulls.
template <int dim>
void bond_tensions(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position,
                   std::vector<double>& tension);

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

/// Volume (in the plane: area) of all cells between solid particles over that at rest; 1 where
/// there are none.
template <int dim>
double volume_ratio(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position);

/// Area of a quadrilateral, or volume of a hexahedron (that of the trilinear map), and its gradient
/// with respect to each corner; corners as in VolumeCell.
double cell_volume(const std::array<Vector<2>, 4>& corner, std::array<Vector<2>, 4>& gradient);
double cell_volume(const std::array<Vector<3>, 8>& corner, std::array<Vector<3>, 8>& gradient);

}  // namespace sprung::sph
