#pragma once
/// lambda = E/k_e of a material without boundaries, from blocks of growing size.

#include "calibration/fit.hpp"
#include "calibration/tensile_test.hpp"

#include <functional>
#include <string>
#include <vector>

namespace sprung::calibration {

/// One pulled block and what each gauge makes of it, stress on the area (n dx)^(dim-1). On another
/// area A the value is multiplied by (n dx)^(dim-1) / A.
struct SizedPull {
  Material material;
  int layers = 0;
  double load = 0.0;
  PulledBlock block;
  double lambda_ends = 0.0, lambda_inner = 0.0, lambda_core = 0.0;
};

struct BulkModulus {
  Material material;
  double lambda = 0.0;  ///< strain between the centres of the end layers, extrapolated in 1/n
  /// Half width: the fit's 95 %, or the distance to another gauge if that is larger.
  double interval = 0.0;
  double residual = 0.0;      ///< of the fit, root mean square
  double lambda_inner = 0.0;  ///< by the other two gauges, extrapolated alike
  double lambda_core = 0.0;
  /// Of the core of the largest block; in the plane r/(1+r), r the ratio of strains.
  double poisson_ratio = 0.0;
  double strain = 0.0;  ///< of the largest block
  int fewest_layers = 0, most_layers = 0;
  double seconds = 0.0;  ///< wall time
  std::vector<SizedPull> pulls;
};

/// Young's modulus over k_e from `load` (force per particle / (k_e dx^(dim-1))) and strain. In
/// space stress is E strain; in the plane E is that of the incompressible solid in plane strain,
/// stress = 4/3 E strain.
double modulus_per_stiffness(int dimension, double load, double strain);

/// What the incompressible lattice gives along an axis: 3 in space, 3/2 in the plane. With volume
/// springs kappa G (isotropic bonds: Lame constant (1 + kappa) G) in space that of the cubic
/// crystal, (5 + 3 kappa)/(2 + kappa) for isotropic bonds, and in plane strain 3/2 (2 + kappa)/(3 +
/// kappa).
double theoretical_lambda(const Material& material);

/// `advance(done, remark)`: 0 to 1.
using Watcher = std::function<void(double, const std::string&)>;

/// By the particle solver where the material has no area springs, else by its network of springs
/// alone.
BulkModulus measure_bulk(const Material& material, const Watcher& advance);

/// One block pulled by the way that suits the material.
SizedPull pull_block(const Material& material, const Pull& pull);

}  // namespace sprung::calibration
