#pragma once
/// Thin plates in the plane, aligned with the lattice: how stiff they are compared with the
/// continuum.

#include "calibration/specimen.hpp"

namespace sprung::calibration {

/// A plate of `layers` rows of particles, 16 times as long as thick (at least 24 particles).
struct Plate {
  int layers = 4;
  Material material;
  bool surface_correction = false;
};

/// E' = stress/strain of the continuum in plane strain, Pa: 4 G (2 + kappa)/(3 + kappa) with area
/// springs kappa G, 4 G without, where the continuum meant is the incompressible one.
double plane_strain_modulus(const Material& material);

/// Each over the continuum's, of thickness n dx.
struct PlateStiffness {
  /// EA: pull by equal forces on the end rows, strain of the middle half.
  double stretching = 0.0;
  /// EI: pure bending by couples on the end rows, curvature of the middle half.
  double bending = 0.0;
};

/// Static, by the network of springs alone. Throws std::invalid_argument for fewer than 2 layers:
/// one row of springs is a mechanism in bending.
PlateStiffness measure_plate(const Plate& plate);

/// First angular frequency of the same plate, 10 times as long as thick, clamped at one end, over
/// that of the Timoshenko beam.
double frequency_ratio(const Plate& plate);

/// First root b of the cantilever's frequency equation, omega = b sqrt(E'I/(rho A L^4)), Huang
/// (1961), J. Appl. Mech. 28, 579: r2 = I/(A L2), s2 = E'I/(k A G L2). b = 3.516 for r2 = s2 = 0.
double timoshenko_root(double r2, double s2);

}  // namespace sprung::calibration
