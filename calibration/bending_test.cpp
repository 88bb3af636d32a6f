#include "calibration/bending_test.hpp"

#include "calibration/equilibrium.hpp"
#include "scene/body_shape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sprung::calibration {

namespace {

constexpr double spacing = 1e-3;  // m; cancels

/// `count`: across, along and, in space, in width.
template <int dim>
struct LaidPlate {
  std::array<int, dim> count;
  Solid shape;
  sph::Particles<dim> particles;
  sph::ElasticNetwork<dim> network;

  int along(std::size_t i) const { return lattice_place<dim>(i, count)[1]; }
  /// Distance from the middle line, m.
  double across(std::size_t i) const {
    return (lattice_place<dim>(i, count)[0] - 0.5 * (count[0] - 1)) * spacing;
  }
  Vector<dim> direction(std::size_t i, int axis) const {
    Point own{};
    const auto place = lattice_place<dim>(i, count);
    for (int d = 0; d < dim; ++d) own[d] = (place[d] + 0.5) * spacing;
    return sph::as_vector<dim>(own_direction(shape, own, axis));
  }
};

template <int dim>
LaidPlate<dim> lay(const Plate& plate, int rows, bool clamped) {
  if (plate.layers < 2)
    throw std::invalid_argument("a plate of one layer does not resist bending; use two or more");
  LaidPlate<dim> laid;
  laid.count[0] = plate.layers;
  laid.count[1] = rows;
  if constexpr (dim == 3) laid.count[2] = plate.width;
  laid.shape = shape_of<dim>(laid.count, spacing);
  laid.shape.angle = plate.angle;
  if (plate.bend > 0.0) {
    const double thickness = plate.layers * spacing, radius = thickness / plate.bend;
    laid.shape.arc = Arc{{},
                         radius - 0.5 * thickness,
                         radius + 0.5 * thickness,
                         plate.angle,
                         plate.angle + rows * spacing / radius};
  }
  if (clamped) laid.shape.clamped = Side::bottom;
  laid.particles =
      is_oblique(laid.shape) ? fitted<dim>(laid.shape, spacing) : block<dim>(laid.count, spacing);
  laid.network =
      network_of<dim>(laid.particles, laid.shape, plate.material, plate.surface_correction);
  return laid;
}

/// Slope of the least-squares line through (x, y).
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  double mean_x = 0.0, mean_y = 0.0, product = 0.0, square = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mean_x += x[k] / static_cast<double>(x.size());
    mean_y += y[k] / static_cast<double>(x.size());
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    product += (x[k] - mean_x) * (y[k] - mean_y);
    square += (x[k] - mean_x) * (x[k] - mean_x);
  }
  return product / square;
}

int rows_of(const Plate& plate) {
  const int rows = std::max((plate.material.dimension == 2 ? 16 : 8) * plate.layers, 24);
  // An arc of 5 rad at most: its ends do not meet.
  return plate.bend > 0.0 ? std::min(rows, static_cast<int>(5.0 * plate.layers / plate.bend))
                          : rows;
}

/// Resultant of the end rows' load (force; of bending, couple) over what it does to the middle half
/// per length (strain; change of slope).
template <int dim>
double stiffness(const Plate& plate, bool bend) {
  const int rows = rows_of(plate);
  LaidPlate<dim> laid = lay<dim>(plate, rows, false);
  const double thickness = plate.layers * spacing;
  // Strains of the order 1e-5: linear, and well above rounding.
  const double scale = 1e-5 * spring_stiffness * std::pow(spacing, dim - 1);
  std::vector<Vector<dim>> load(laid.particles.size(), Vector<dim>::Zero());
  double resultant = 0.0;
  for (std::size_t i = 0; i < load.size(); ++i) {
    if (laid.along(i) != 0 && laid.along(i) != rows - 1) continue;
    const double force = bend ? scale * laid.across(i) / thickness : scale;
    load[i] = (laid.along(i) == 0 ? -force : force) * laid.direction(i, 1);
    if (laid.along(i) == 0) resultant += bend ? force * laid.across(i) : force;
  }
  const auto rest = laid.particles.position;
  find_equilibrium<dim>(laid.network, laid.particles, load);
  std::vector<std::vector<double>> across(rows), displacement(rows);
  for (std::size_t i = 0; i < rest.size(); ++i) {
    across[laid.along(i)].push_back(laid.across(i));
    displacement[laid.along(i)].push_back(
        laid.direction(i, 1).dot(laid.particles.position[i] - rest[i]));
  }
  std::vector<double> place, value;
  for (int j = rows / 4; j < rows - rows / 4; ++j) {
    place.push_back(j * spacing);
    double mean = 0.0;
    for (const double u : displacement[j]) mean += u / static_cast<double>(displacement[j].size());
    value.push_back(bend ? slope(across[j], displacement[j]) : mean);
  }
  return resultant / slope(place, value);
}

}  // namespace

double plate_modulus(const Material& material) {
  const double kappa = material.area_stiffness;
  if (material.dimension == 3)
    return spring_stiffness * (kappa > 0.0 ? (5.0 + 3.0 * kappa) / (2.0 + kappa) : 3.0);
  const double g = sph::network_shear_modulus<2>(spring_stiffness, material.bonds);
  return kappa > 0.0 ? 4.0 * g * (2.0 + kappa) / (3.0 + kappa) : 4.0 * g;
}

double stretching_ratio(const Plate& plate) {
  const bool plane = plate.material.dimension == 2;
  const double section = plate.layers * spacing * (plane ? 1.0 : plate.width * spacing);
  return (plane ? stiffness<2>(plate, false) : stiffness<3>(plate, false)) /
         (plate_modulus(plate.material) * section);
}

double bending_ratio(const Plate& plate) {
  const bool plane = plate.material.dimension == 2;
  const double h = plate.layers * spacing;
  double continuum = std::pow(h, 3) / 12.0;
  if (plate.bend > 0.0) {
    const double radius = h / plate.bend, a = radius - 0.5 * h, b = radius + 0.5 * h;
    const double squares = b * b - a * a, log = std::log(b / a);
    continuum = radius * (squares * squares - 4.0 * a * a * b * b * log * log) / (8.0 * squares);
  }
  continuum *= plate_modulus(plate.material) * (plane ? 1.0 : plate.width * spacing);
  return (plane ? stiffness<2>(plate, true) : stiffness<3>(plate, true)) / continuum;
}

double uncorrected_bending_law(const Plate& plate) {
  const double n = plate.layers, w = plate.width;
  if (plate.material.dimension == 2) return (n - 1.0) * (2.0 * n - 1.0) / (2.0 * n * n);
  return (n - 1.0) * ((n + 1.0) * (1.5 * w - 0.5) + (n - 2.0) * (1.5 * w - 1.0)) /
         (3.0 * w * n * n);
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
  const auto laid = lay<2>(plate, rows, true);
  const auto& rest = laid.particles.position;
  const double mass = laid.particles.mass();
  std::vector<Vector<2>> mode(rest.size(), Vector<2>::Zero());
  for (std::size_t i = 0; i < rest.size(); ++i)
    mode[i] = std::pow((laid.along(i) + 0.5) * spacing, 2) * laid.direction(i, 0);
  double frequency2 = 0.0;
  // Inverse iteration: the second mode is 6 times higher, so each sweep gains a factor 40.
  for (int sweep = 0; sweep < 6; ++sweep) {
    double largest = 0.0;
    for (const auto& u : mode) largest = std::max(largest, u.norm());
    std::vector<Vector<2>> load(mode.size());
    for (std::size_t i = 0; i < mode.size(); ++i)
      load[i] = spring_stiffness * spacing * mode[i] / largest;
    mode = linear_response<2>(laid.network, laid.particles, load);
    double work = 0.0, inertia = 0.0;
    for (std::size_t i = 0; i < mode.size(); ++i) {
      work += mode[i].dot(load[i]);
      inertia += mass * mode[i].squaredNorm();
    }
    frequency2 = work / inertia;  // Rayleigh's quotient: K u = load
  }
  const double thickness = n * spacing, length = rows * spacing;
  const double modulus = plate_modulus(plate.material);
  const double shear = sph::network_shear_modulus<2>(spring_stiffness, plate.material.bonds);
  const double r2 = thickness * thickness / (12.0 * length * length);
  const double s2 = r2 * modulus / (5.0 / 6.0 * shear);
  const double beam = timoshenko_root(r2, s2) *
                      std::sqrt(modulus * thickness * thickness / (12.0 * density)) /
                      (length * length);
  return std::sqrt(frequency2) / beam;
}

}  // namespace sprung::calibration
