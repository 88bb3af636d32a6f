#pragma once
/// How the fluid's mesh follows the bodies: the mesh velocity g is the displacement of a fictitious
/// elastic sheet that fills the undeformed fluid, moves with the bodies where it touches them and
/// is held at the channel's sides and at obstacles,
///
///   div( a [grad g + grad g^T + div g I] ) = 0,   a = ((d/reach)^2 +
///   regularisation^2)^(-stiffening/2),
///
/// d being the distance to the nearest wetted face. The sheet is stiff near the bodies, so the
/// small cells at corners turn and move with them almost rigidly, and the distortion goes where the
/// cells are large. The operator is linear and constant: one factorisation serves the whole run,
/// and the extension of the displacement is the time integral of that of the velocity. It does not
/// depend on the cells, so finer meshes move by the same map.

#include "reference_fem/space.hpp"

#include <suitesparse/cholmod.h>

#include <map>
#include <vector>

namespace sprung::reference {

class MeshMotion {
 public:
  /// `reach` (m): the distance at which the sheet has softened, about the bodies' size.
  MeshMotion(const Space& space, double reach, double stiffening);
  ~MeshMotion();
  MeshMotion(const MeshMotion&) = delete;
  MeshMotion& operator=(const MeshMotion&) = delete;
  /// Overwrites the entries of `field` (interleaved per node) at fluid nodes off the bodies with
  /// the extension of the values at the bodies' nodes.
  void extend(std::vector<double>& field) const;

 private:
  static constexpr double regularisation = 0.02;
  static constexpr double dilatation = 1.0;  ///< first Lame constant over the second
  void assemble(int cell, std::vector<std::map<int, double>>& columns);
  void factorize(const std::vector<std::map<int, double>>& columns);

  const Space* space_;
  double reach_, stiffening_;
  std::vector<Vec2> wetted_;
  std::vector<int> unknown_;  ///< per node: the number of its x component, or -1
  int size_ = 0;
  struct Coupling {
    int row, component;
    double value;
  };
  std::vector<Coupling> coupling_;  ///< to the bodies' nodes
  mutable cholmod_common cholmod_{};
  cholmod_factor* factor_ = nullptr;
};

}  // namespace sprung::reference
