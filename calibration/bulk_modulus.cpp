#include "calibration/bulk_modulus.hpp"

#include "scene/progress.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace sprung::calibration {

double modulus_per_stiffness(int dimension, double load, double strain) {
  return (dimension == 2 ? 0.75 : 1.0) * load / strain;
}

double theoretical_lambda(const Material& material) {
  const double kappa = material.area_stiffness;
  if (material.dimension == 3) {
    if (kappa == 0.0) return 3.0;
    // E along an axis of the cubic crystal, from C11 and C12 over k_e.
    const double bonds = material.bonds == sph::Bonds::equal ? 4.0 / 3.0 : 0.0;
    const double c11 = 3.0 + bonds + kappa, c12 = 1.0 + bonds + kappa;
    return (c11 - c12) * (c11 + 2.0 * c12) / (c11 + c12);
  }
  return kappa > 0.0 ? 1.5 * (2.0 + kappa) / (3.0 + kappa) : 1.5;
}

SizedPull pull_block(const Material& material, const Pull& pull) {
  SizedPull result{material, pull.layers, pull.load, {}, 0.0, 0.0, 0.0};
  if (material.area_stiffness > 0.0)
    result.block =
        material.dimension == 3 ? pull_network<3>(material, pull) : pull_network<2>(material, pull);
  else
    result.block = material.dimension == 3 ? pull_by_particle_solver<3>(material, pull)
                                           : pull_by_particle_solver<2>(material, pull);
  const auto lambda = [&](double strain) {
    return modulus_per_stiffness(material.dimension, pull.load, strain);
  };
  result.lambda_ends = lambda(result.block.strain_ends);
  result.lambda_inner = lambda(result.block.strain_inner);
  result.lambda_core = lambda(result.block.core_axial);
  return result;
}

BulkModulus measure_bulk(const Material& material, const Watcher& advance) {
  // Blocks small enough to end in minutes, large enough for the quadratic term of 1/n to be seen.
  // Multiples of 4, so that the gauge at n/4 is the same part of every block.
  // The network in space is solved by a factorisation, whose cost grows with the sixth power.
  const std::vector<int> sizes = material.dimension == 2 ? std::vector{20, 28, 40, 56, 80, 112}
                                 : material.area_stiffness > 0 ? std::vector{8, 12, 16, 20}
                                                               : std::vector{12, 16, 20, 28, 40};
  // Strain of about 3e-5: what the finite strain adds is of that relative size.
  const double load = 1e-4;
  const double began = wall_seconds();
  double whole = 0.0, done = 0.0;
  const auto cost = [&](int n) { return std::pow(n, material.dimension + 1); };
  for (const int n : sizes) whole += cost(n);
  BulkModulus result;
  result.material = material;
  std::vector<double> ends, inner, core;
  for (const int n : sizes) {
    advance(done / whole, fmt::format("{} layers", n));
    Pull pull;
    pull.layers = n;
    pull.load = load;
    pull.smoothing_length_ratio = 1.0;
    result.pulls.push_back(pull_block(material, pull));
    ends.push_back(result.pulls.back().lambda_ends);
    inner.push_back(result.pulls.back().lambda_inner);
    core.push_back(result.pulls.back().lambda_core);
    done += cost(n);
  }
  advance(1.0, "");
  // The end gauge extrapolates best: its values lie on the smoothest curve.
  const Extrapolation bulk = extrapolate(sizes, ends, 2);
  const PulledBlock& largest = result.pulls.back().block;
  result.lambda = bulk.value;
  result.lambda_inner = extrapolate(sizes, inner, 2).value;
  result.lambda_core = extrapolate(sizes, core, 2).value;
  result.interval = std::max({bulk.half_width, std::abs(result.lambda_inner - bulk.value),
                              std::abs(result.lambda_core - bulk.value)});
  result.residual = bulk.residual;
  const double ratio = -largest.core_lateral / largest.core_axial;
  result.poisson_ratio = material.dimension == 2 ? ratio / (1.0 + ratio) : ratio;
  result.strain = largest.strain_ends;
  result.fewest_layers = sizes.front();
  result.most_layers = sizes.back();
  result.seconds = wall_seconds() - began;
  return result;
}

}  // namespace sprung::calibration
