#pragma once
/// Thin plates: how stiff they are compared with the continuum. In the plane a plate in plane
/// strain, in space a bar of rectangular section; along the lattice, turned, or bent to an arc.

#include "calibration/specimen.hpp"

namespace sprung::calibration {

/// A plate of `layers` rows of particles, 16 times as long as thick (in space 8 times; at least 24
/// particles).
struct Plate {
  int layers = 4;
  Material material;
  bool surface_correction = false;
  int width = 1;       ///< in space: particles across the third axis
  double angle = 0.0;  ///< rad, to the axes; the particles are fitted to the plate
  double bend = 0.0;   ///< thickness over the radius of the middle line; 0: straight
};

/// Young's modulus of the pull that the plate feels, Pa. In the plane stress/strain in plane
/// strain, 4 G (2 + kappa)/(3 + kappa) with area springs kappa G, 4 G without, where the continuum
/// meant is the incompressible one. In space G (5 + 3 kappa)/(2 + kappa), 3 G without.
double plate_modulus(const Material& material);

/// EA over the continuum's, of thickness n dx: pull by equal forces on the end rows, strain of the
/// middle half. Of straight plates. Static, by the network of springs alone. Throws
/// std::invalid_argument for fewer than 2 layers: one row of springs is a mechanism in bending.
double stretching_ratio(const Plate& plate);

/// EI over the continuum's: pure bending by couples on the end rows, change of the sections' slope
/// along the middle half. A bent plate is compared with the exact solution of the curved bar
/// (Golovin; Timoshenko & Goodier, Theory of Elasticity, art. 29): the ends of a bar of radii a < b
/// turn by 8 M (b2 - a2)/(E' N) per radian, N = (b2 - a2)2 - 4 a2 b2 ln(b/a)2.
double bending_ratio(const Plate& plate);

/// EI over the continuum's that follows from counting the bonds of a plate without surface
/// correction whose cells keep their volume, for the strains of the bent continuum: (n-1)(2n-1)/(2
/// n2) in the plane and for a wide plate in space; for a bar of w particles across
/// (n-1) ((n+1)(3w-1)/2 + (n-2)(3w-2)/2) / (3 w n2).
double uncorrected_bending_law(const Plate& plate);

/// First angular frequency of the same straight plate, 10 times as long as thick, clamped at one
/// end, over that of the Timoshenko beam.
double frequency_ratio(const Plate& plate);

/// First root b of the cantilever's frequency equation, omega = b sqrt(E'I/(rho A L^4)), Huang
/// (1961), J. Appl. Mech. 28, 579: r2 = I/(A L2), s2 = E'I/(k A G L2). b = 3.516 for r2 = s2 = 0.
double timoshenko_root(double r2, double s2);

}  // namespace sprung::calibration
