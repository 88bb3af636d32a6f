#pragma once
/// Elastic constants of the lattice without boundaries, from the energy that the particle solver's
/// own springs store under a homogeneous deformation, and Young's modulus in any direction.

#include "calibration/specimen.hpp"

#include <Eigen/Dense>

namespace sprung::calibration {

/// Components of the symmetric strain tensor in Voigt's order: 3 in the plane (xx, yy, 2xy), 6 in
/// space (xx, yy, zz, 2yz, 2xz, 2xy).
template <int dim>
inline constexpr int voigt_size = dim*(dim + 1) / 2;

template <int dim>
using VoigtMatrix = Eigen::Matrix<double, voigt_size<dim>, voigt_size<dim>>;

/// The springs and area springs of one particle in the bulk, each counted by the share that is the
/// particle's.
template <int dim>
class BulkLattice {
 public:
  explicit BulkLattice(const Material& material);

  /// Stored energy per volume, Pa, when every particle moves from x to x + gradient x.
  double energy_density(const Eigen::Matrix<double, dim, dim>& gradient) const;

  /// C in units of k_e: second derivatives of the energy by central differences (steps of 1e-4,
  /// which leave 1e-8 of truncation and 1e-8 of rounding).
  VoigtMatrix<dim> elastic_constants() const;

  /// lambda = E/k_e for a pull along `direction` (need not be a unit vector) with the sides free.
  /// Without area springs the strain is held isochoric, as by the pressure equation. In the plane E
  /// is that of the incompressible solid in plane strain: stress = 4/3 E strain.
  double modulus_per_stiffness(const Vector<dim>& direction) const;

 private:
  Material material_;
  sph::ElasticNetwork<dim> patch_;
};

}  // namespace sprung::calibration
