#pragma once
/// A block of the material pulled along its first axis: by the whole particle solver, or by the
/// network of springs alone.

#include "calibration/specimen.hpp"

#include <vector>

namespace sprung::calibration {

/// How the block is pulled. The load is a dead force, the same on every particle of the two end
/// layers normal to the first axis; all other faces are free.
struct Pull {
  int layers = 20;          ///< n: particles along each axis
  double load = 0.0;        ///< force on a particle of an end layer / (k_e dx^(dim-1)), + pulls
  double tolerance = 1e-6;  ///< change of strain over a decay time of the slowest mode / strain
  double smoothing_length_ratio = 1.3;  ///< h/dx of the pressure equation
  double density_feedback = 0.5;        ///< of the pressure equation, over wave speed / dx
  bool surface_correction = false;      ///< bonds weighted at the surface
  int load_steps = 1;                   ///< of pull_network: the load raised in so many equal parts
};

/// Strains are displacement over rest length, small or not.
struct PulledBlock {
  double strain_ends = 0.0;   ///< between the centres of the end layers, whole sections
  double strain_inner = 0.0;  ///< between the layers n/4 from either end, whole sections
  /// In the core (a quarter of the layers away from every face): least-squares gradient of
  /// displacement.
  double core_axial = 0.0;
  double core_lateral = 0.0;  ///< mean of the lateral directions
  /// Mean over the core's cells, by the displacement of its faces: what becomes of the core's
  /// volume.
  double mean_axial = 0.0, mean_lateral = 0.0;
  double unbalanced = 0.0;  ///< largest net force on a particle / load
  int steps = 0;
};

/// The particle solver (ACTIONs 4 to 9): springs, pressure equation with density feedback, free
/// surfaces at zero pressure; damped until at rest. The material has no area springs:
/// incompressibility is the pressure's. Throws std::runtime_error if it does not come to rest.
template <int dim>
PulledBlock pull_by_particle_solver(const Material& material, const Pull& pull);

/// The network of springs alone, by Newton steps of sph::ElasticSolid's implicit system; area
/// springs, if the material has them, carry the incompressibility.
template <int dim>
PulledBlock pull_network(const Material& material, const Pull& pull);

/// Stretches along the middle half of a corrected bar, `layers` thick and four times as long, under
/// each of `loads` (as Pull's) on its end layers, from the equilibrium under the one before. A
/// cube's core would not do: its ends hold it laterally, and its core strains 10 % more at 8
/// layers, 4 % at 16 (in the plane). Displacements are held even about the bar's middle planes:
/// pushed by forces of fixed direction it would turn over or buckle. The correction is exact for
/// small strains: at 30 % 4 layers are stretched by 26.5 % (in space 28.0 %), 8 by 28.1 % under the
/// stress at which the bulk is stretched by 30 %.
template <int dim>
std::vector<double> pull_bar(const Material& material, int layers,
                             const std::vector<double>& loads);

/// Poisson's ratio for finite strain, -ln(1 + lateral)/ln(1 + axial); in the plane r/(1+r) of that.
double poisson_ratio(int dimension, double axial, double lateral);

/// What the density feedback in vacuum keeps is the kernel's sum over the neighbours, and that is
/// the volume to first order only: Poisson's ratio of the uniformly stretched lattice whose sum is
/// the lattice's at rest. In space at h = dx 0.489 for a pull of 6.8 %, 0.507 for a push of 6 %.
template <int dim>
double kernel_sum_poisson_ratio(double smoothing_length_ratio, double axial);

/// A block that has been held under its load for some time after it came to rest.
struct HeldBlock {
  double poisson_ratio_before = 0.0, poisson_ratio_after = 0.0;  ///< of the core, finite strain
  double strain_before = 0.0, strain_after = 0.0;                ///< of the core, along the pull
  double volume_drift = 0.0;  ///< change of the cells' volume over their volume, per second
  double seconds = 0.0;       ///< of the hold
};

/// Pulls a block by the particle solver with steps of the wave's Courant number 0.7 (implicit
/// springs where the material has volume springs) and holds the load for `seconds`. Only the ratio
/// of stiffness to density matters: here k_e/density = 10 m2/s2, a solid of E = 15 kPa (in space 30
/// kPa) and the density of water. Throws as pull_by_particle_solver.
template <int dim>
HeldBlock hold_block(const Material& material, const Pull& pull, double seconds);

}  // namespace sprung::calibration
