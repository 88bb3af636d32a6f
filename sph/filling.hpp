#pragma once
/// How densely the particles fill the space, told from places that know nothing of the particles.

#include "sph/vector.hpp"

#include <array>
#include <span>
#include <vector>

namespace sprung::sph {

/// A grid of nodes, each at the centre of a cube of side one spacing. Every point gives its volume
/// to the nodes about it, by quadratic B-splines; what a node lacks of its cube goes back to the
/// points that feed it, in the same parts.
///
/// A kernel sum at the particles themselves depends on how orderly they lie: at one density a
/// disordered fluid has a sum 0.2 % larger than the lattice (h = 1.3 dx). A mean over places
/// spread evenly does not, whatever the order, and quadratic B-splines one spacing wide find
/// exactly 1 all over a lattice along the axes, for their transform is 0 at its wave numbers.
template <int dim>
class FillingGrid {
 public:
  FillingGrid() = default;
  /// Nodes for the box from `low` to `high` (m) and one row round it: a point inside the box feeds
  /// no node farther out.
  FillingGrid(const Vector<dim>& low, const Vector<dim>& high, double spacing);

  /// The relative rate at which each of the first `lacking.size()` points must grow to make up
  /// within unit time what its nodes lack: sum_n w_in (1 / f_n - 1), f_n the filling of node n.
  /// Their sum weighted with the volumes is the volume that the nodes lack, exactly, so nothing is
  /// won or lost by correcting it. `volume`: of each point, m2 or m3; points should reach two
  /// spacings beyond the box.
  void lacking(std::span<const Vector<dim>> points, std::span<const double> volume,
               std::span<double> lacking);

  /// Filling of every node, 1: full; the first axis runs fastest, the row round the box included.
  /// That of the last call.
  std::span<const double> filling() const { return filling_; }

 private:
  Vector<dim> first_node_ = Vector<dim>::Zero();
  double spacing_ = 1.0;
  std::array<std::ptrdiff_t, dim> extent_{};
  std::vector<double> filling_, missing_;
};

}  // namespace sprung::sph
