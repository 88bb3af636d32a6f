#pragma once
/// A block of incompressible, or nearly incompressible, elastic solid in space: equilibrium at
/// finite strain under given stresses on its faces or a given shear. It is the judge of the spring
/// lattice's cube, independent of the particles and of the plane solver.
///
/// The block fills 0 < X < size. Unknown are displacement u and pressure p, F = I + grad u,
/// J = det F; the solid is the plane solver's in space (material.hpp), neo-Hookean with
/// W = G/2 (tr F^T F - 3 - 2 ln J) + lambda/2 (J - 1)^2. For all (phi, q):
///
///   (G (F - F^-T) - p J F^-T, grad phi) = < t, phi >,     (q, J - 1 + p/lambda) = 0.
///
/// Face 0 of every axis is a plane of symmetry (no displacement across it), so the block is an
/// eighth of a body under the same stresses; face 1 carries t.

#include <array>
#include <vector>

namespace sprung::reference {

struct SolidBlock {
  std::array<double, 3> size = {0.1, 0.1, 0.1};  ///< m
  std::array<int, 3> cells = {2, 2, 2};
  double youngs_modulus = 0.0;  ///< Pa, at small strain
  double poisson_ratio = 0.5;   ///< 0.5: incompressible, 1/lambda = 0
  /// Tensile stress (Pa) on face 1 of every axis; a pressure is negative.
  std::array<double, 3> stress{};
  /// The stress is per deformed area and stays normal to the face (a fluid's pressure); else it is
  /// nominal: per undeformed area, in a fixed direction (a dead load).
  bool follows = false;
  /// Both faces of axis 0 are glued to rigid plates: no displacement within them.
  bool glued = false;
  /// Simple shear u_0 = shear X_1, prescribed on the faces of axes 0 and 1 (face 1 of axis 2 is
  /// free, which sets the pressure's level); excludes stress.
  double shear = 0.0;
  int increments = 10;
};

/// One converged load increment.
struct BlockState {
  double load = 0.0;                ///< fraction of the whole
  std::array<double, 3> stretch{};  ///< 1 + mean displacement of face 1 over size
  std::array<double, 3> nominal{};  ///< Pa, mean of P_ii over the undeformed block
  double shear_stress = 0.0;        ///< Pa, mean of P_01
  double volume_ratio = 1.0;        ///< deformed over undeformed volume
  double mean_pressure = 0.0;       ///< Pa
  double energy = 0.0;              ///< J, stored
  std::array<double, 3> spread{};   ///< largest less smallest displacement of face 1, over size
  int iterations = 0;
};

/// Displacement by quadratic, pressure by discontinuous linear elements; Newton's method with line
/// search, its matrix factorised by UMFPACK. Throws std::invalid_argument for senseless data,
/// std::runtime_error when a load increment finds no equilibrium.
std::vector<BlockState> solve_block(const SolidBlock& block);

/// G (s - s^-2) with G = E/3: nominal stress of incompressible uniaxial tension at stretch s.
double uniaxial_stress(double youngs_modulus, double stretch);

}  // namespace sprung::reference
