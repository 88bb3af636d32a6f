#pragma once
/// The plane of an open side, and how a pressure prescribed on it acts.

#include "scene/problem.hpp"
#include "sph/vector.hpp"

#include <algorithm>
#include <vector>

namespace sprung::sph {

/// One side of the box seen from inside: `depth` is the distance beyond the side.
template <int dim>
struct OpenPlane {
  int axis = 0;
  int outward = -1;
  double place = 0.0;
  double depth(const Vector<dim>& x) const { return outward * (x[axis] - place); }
};

template <int dim>
OpenPlane<dim> open_plane(const Box& channel, Side side);

/// A prescribed pressure holds at the side itself, while the particles that carry it stand in
/// columns behind. Taken as linear from a particle i through the side to column particle j,
/// psi_i - psi_j = (psi_i - psi_side) (1 + d_j / d_i) with d the distances to the side (the manner
/// of Morris, Fox & Zhu 1997 for velocities). Without it a linear pressure would have a kink at the
/// side, which the Laplacian sees and a flow that passes does not.
template <int dim>
struct PressurePlanes {
  std::vector<OpenPlane<dim>> planes;
  double least_distance = 0.0;  ///< m; a particle at the side itself counts as this far from it
  /// 1 + d_j / d_i.
  double reach(const Vector<dim>& x_i, const Vector<dim>& x_j) const {
    for (const auto& plane : planes) {
      const double behind = plane.depth(x_j);
      if (behind > 0.0) return 1.0 + behind / std::max(-plane.depth(x_i), least_distance);
    }
    return 1.0;
  }
};

}  // namespace sprung::sph
