#pragma once
/// Where the pressure equation does not keep a solid incompressible: the layer below a free face.
///
/// The equation's left side L is not the divergence D of the gradient G (an approximate
/// projection). At rest D u = 0, so L psi = D G psi + (rate/dt)(S0/S - 1): the density feedback's
/// volume error is (dt/rate)(D G - L) psi. It vanishes where the pressure is smooth, not where it
/// falls from its value in the body to zero within the kernel's support.
#include "calibration/tensile_test.hpp"

#include <complex>

namespace sprung::calibration {

/// A block pulled by the particle solver, layer by layer.
struct SurfaceLayer {
  PulledBlock block;
  double courant = 0.0;  ///< wave_speed() x time step / spacing of the run
  /// Kernel sum over that at rest less 1, over the core's axial strain: of the particles on the
  /// line from the middle of a lateral face to the centre, outermost first.
  std::vector<double> density_error;
  /// Of the core that begins m layers below every face (mean over its cells), m = 0, 1, ...
  std::vector<double> poisson_ratio;
};

/// Throws as pull_by_particle_solver.
template <int dim>
SurfaceLayer measure_surface_layer(const Material& material, const Pull& pull);

/// Factor by which that error changes from one layer to the next, below a plane face of a solid in
/// space: the root z = e^ik, |z| < 1, of largest modulus of
///   sigma g(k)^2 / l_C(k) + (dt/rate)(l(k) - g(k)^2) = 0,
/// with g, l the symbols of G and L for fields of the depth alone, l_C = C11/density x
/// 2 (1 - cos k)/dx^2 that of the springs, and sigma = -d ln S / d(div u). At h = dx, 0.5, courant
/// 0.387 and the paper's bonds 0.489 e^{0.747 i}: a tenth after 3.2 layers, a hundredth after 6.4.
std::complex<double> surface_layer_decay(const Material& material, double smoothing_length_ratio,
                                         double courant, double density_feedback);

}  // namespace sprung::calibration
