#include "calibration/bending_test.hpp"

#include "calibration/equilibrium.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <Eigen/Dense>

namespace sprung::calibration {

namespace {

constexpr double spacing = 1e-3;  // m; cancels

struct LaidPlate {
  std::array<int, 2> count;  ///< thickness along x, length along y
  sph::Particles<2> particles;
  sph::ElasticNetwork<2> network;
};

LaidPlate lay(const Plate& plate, int rows, bool clamped) {
  if (plate.layers < 2)
    throw std::invalid_argument("a plate of one layer does not resist bending; use two or more");
  LaidPlate laid{{plate.layers, rows}, {}, {}};
  laid.particles = block<2>(laid.count, spacing);
  Solid shape = shape_of<2>(laid.count, spacing);
  if (clamped) shape.clamped = Side::bottom;
  laid.network = network_of<2>(laid.particles, shape, plate.material, plate.surface_correction);
  return laid;
}

/// Coefficients of the least-squares polynomial of degree 2 through the rows' means of `value`, in
/// the middle half.
Eigen::Vector3d fit_middle(const LaidPlate& laid, const std::vector<double>& value) {
  const int n = laid.count[0], rows = laid.count[1];
  const int from = rows / 4, to = rows - rows / 4;
  Eigen::MatrixX3d design(to - from, 3);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(to - from);
  for (int j = from; j < to; ++j) {
    const double y = (j - 0.5 * (rows - 1)) * spacing;
    design.row(j - from) << 1.0, y, y * y;
    for (int i = 0; i < n; ++i) mean[j - from] += value[j * n + i] / n;
  }
  return design.colPivHouseholderQr().solve(mean);
}

}  // namespace

double plane_strain_modulus(const Material& material) {
  const double g = sph::network_shear_modulus<2>(spring_stiffness, material.bonds);
  const double kappa = material.area_stiffness;
  return kappa > 0.0 ? 4.0 * g * (2.0 + kappa) / (3.0 + kappa) : 4.0 * g;
}

PlateStiffness measure_plate(const Plate& plate) {
  const int n = plate.layers, rows = std::max(16 * n, 24);
  const double thickness = n * spacing, modulus = plane_strain_modulus(plate.material);
  // Strains of the order 1e-5: linear, and well above rounding.
  const double scale = 1e-5 * spring_stiffness * spacing;
  PlateStiffness result;
  for (const bool bend : {false, true}) {
    LaidPlate laid = lay(plate, rows, false);
    std::vector<Vector<2>> load(laid.particles.size(), Vector<2>::Zero());
    double resultant = 0.0;  // N/m or, of the couple, N
    for (int i = 0; i < n; ++i) {
      const double x = (i - 0.5 * (n - 1)) * spacing;
      const double force = bend ? scale * x / thickness : scale;
      load[(rows - 1) * n + i][1] = force;
      load[i][1] = -force;
      resultant += bend ? force * x : force;
    }
    const auto rest = laid.particles.position;
    find_equilibrium<2>(laid.network, laid.particles, load);
    std::vector<double> displacement(rest.size());
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const Vector<2> u = laid.particles.position[k] - rest[k];
      displacement[k] = bend ? u[0] : u[1];
    }
    const Eigen::Vector3d fit = fit_middle(laid, displacement);
    if (bend)  // A couple that pulls the side of larger x bends the plate towards smaller x.
      result.bending = resultant / (-2.0 * fit[2]) / (modulus * std::pow(thickness, 3) / 12.0);
    else
      result.stretching = resultant / fit[1] / (modulus * thickness);
  }
  return result;
}

double timoshenko_root(double r2, double s2) {
  const auto equation = [&](double b) {
    const double root = std::sqrt((r2 - s2) * (r2 - s2) + 4.0 / (b * b));
    const double alpha = std::sqrt(0.5 * (root - (r2 + s2)));
    const double beta = std::sqrt(0.5 * (root + (r2 + s2)));
    const double mixed = b * (r2 + s2) / std::sqrt(1.0 - b * b * r2 * s2);
    return 2.0 + (b * b * (r2 - s2) * (r2 - s2) + 2.0) * std::cosh(b * alpha) * std::cos(b * beta) -
           mixed * std::sinh(b * alpha) * std::sin(b * beta);
  };
  double low = 1.0, high = 3.6;  // positive at the lower end, negative beyond the first root
  for (int k = 0; k < 80; ++k) {
    const double middle = 0.5 * (low + high);
    (equation(middle) > 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double frequency_ratio(const Plate& plate) {
  const int n = plate.layers, rows = 10 * n;
  const LaidPlate laid = lay(plate, rows, true);
  const auto& rest = laid.particles.position;
  const double mass = laid.particles.mass();
  std::vector<Vector<2>> mode(rest.size(), Vector<2>::Zero());
  for (std::size_t i = 0; i < rest.size(); ++i) mode[i][0] = rest[i][1] * rest[i][1];
  double frequency2 = 0.0;
  // Inverse iteration: the second mode is 6 times higher, so each sweep gains a factor 40.
  for (int sweep = 0; sweep < 6; ++sweep) {
    double largest = 0.0;
    for (const auto& u : mode) largest = std::max(largest, u.norm());
    std::vector<Vector<2>> load(mode.size());
    for (std::size_t i = 0; i < mode.size(); ++i)
      load[i] = 1e-5 * spring_stiffness * spacing / rows * mode[i] / largest;
    sph::Particles<2> particles = laid.particles;
    // A slender plate is soft: rounding in its stiff bonds is a larger part of so small a load.
    find_equilibrium<2>(laid.network, particles, load, 1e-7);
    double work = 0.0, inertia = 0.0;
    for (std::size_t i = 0; i < mode.size(); ++i) {
      mode[i] = particles.position[i] - rest[i];
      work += mode[i].dot(load[i]);
      inertia += mass * mode[i].squaredNorm();
    }
    frequency2 = work / inertia;  // Rayleigh's quotient: K u = load
  }
  const double thickness = n * spacing, length = rows * spacing;
  const double modulus = plane_strain_modulus(plate.material);
  const double shear = sph::network_shear_modulus<2>(spring_stiffness, plate.material.bonds);
  const double r2 = thickness * thickness / (12.0 * length * length);
  const double s2 = r2 * modulus / (5.0 / 6.0 * shear);
  const double beam = timoshenko_root(r2, s2) *
                      std::sqrt(modulus * thickness * thickness / (12.0 * density)) /
                      (length * length);
  return std::sqrt(frequency2) / beam;
}

}  // namespace sprung::calibration
