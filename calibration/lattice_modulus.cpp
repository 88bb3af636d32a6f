#include "calibration/lattice_modulus.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::calibration {

namespace {

constexpr double spacing = 1e-3;  // m; cancels

/// Pairs of axes in Voigt's order.
template <int dim>
std::pair<int, int> axes_of(int component) {
  if (component < dim) return {component, component};
  if constexpr (dim == 2) return {0, 1};
  return component == 3 ? std::pair{1, 2} : component == 4 ? std::pair{0, 2} : std::pair{0, 1};
}

template <int dim>
Eigen::Matrix<double, dim, dim> strain_tensor(
    const Eigen::Matrix<double, voigt_size<dim>, 1>& voigt) {
  Eigen::Matrix<double, dim, dim> tensor;
  for (int c = 0; c < voigt_size<dim>; ++c) {
    const auto [a, b] = axes_of<dim>(c);
    tensor(a, b) = tensor(b, a) = a == b ? voigt[c] : 0.5 * voigt[c];
  }
  return tensor;
}

}  // namespace

template <int dim>
BulkLattice<dim>::BulkLattice(const Material& material) : material_(material) {
  std::array<int, dim> count;
  count.fill(5);
  const auto particles = block<dim>(count, spacing);
  patch_ = network_of<dim>(particles, shape_of<dim>(count, spacing), material);
  const auto centre = static_cast<std::int32_t>(particles.size() / 2);
  std::erase_if(patch_.bonds, [&](const sph::Bond& b) { return b.a != centre && b.b != centre; });
  for (auto& bond : patch_.bonds) bond.stiffness *= 0.5;
  std::erase_if(patch_.cells, [&](const auto& cell) {
    return std::find(cell.corner.begin(), cell.corner.end(), centre) == cell.corner.end();
  });
  for (auto& cell : patch_.cells) cell.modulus *= dim == 2 ? 0.25 : 0.125;
}

template <int dim>
double BulkLattice<dim>::energy_density(const Eigen::Matrix<double, dim, dim>& gradient) const {
  std::vector<Vector<dim>> position = patch_.reference;
  for (auto& x : position) x += (gradient * x).eval();
  return sph::elastic_energy<dim>(patch_, position) / std::pow(spacing, dim);
}

template <int dim>
VoigtMatrix<dim> BulkLattice<dim>::elastic_constants() const {
  using VoigtVector = Eigen::Matrix<double, voigt_size<dim>, 1>;
  constexpr double step = 1e-4;
  // W(e) = 1/2 C e e: the even part removes the cubic term.
  const auto curvature = [&](const VoigtVector& e) {
    const auto tensor = strain_tensor<dim>(step * e);
    return (energy_density(tensor) + energy_density(-tensor)) / (step * step) / spring_stiffness;
  };
  VoigtMatrix<dim> c;
  for (int a = 0; a < voigt_size<dim>; ++a) c(a, a) = curvature(VoigtVector::Unit(a));
  for (int a = 0; a < voigt_size<dim>; ++a)
    for (int b = 0; b < a; ++b) {
      const VoigtVector both = VoigtVector::Unit(a) + VoigtVector::Unit(b);
      c(a, b) = c(b, a) = 0.5 * (curvature(both) - c(a, a) - c(b, b));
    }
  return c;
}

template <int dim>
double BulkLattice<dim>::modulus_per_stiffness(const Vector<dim>& direction) const {
  const Vector<dim> d = direction.normalized();
  constexpr int n = voigt_size<dim>;
  Eigen::Matrix<double, n, 1> pull, volume = Eigen::Matrix<double, n, 1>::Zero();
  for (int c = 0; c < n; ++c) {
    const auto [a, b] = axes_of<dim>(c);
    pull[c] = d[a] * d[b];  // d . e . d = pull . e with the doubled shears of Voigt
    if (a == b) volume[c] = 1.0;
  }
  // Stationary point of e C e/2 - pull . e, with volume . e = 0 where the pressure holds the
  // volume.
  Eigen::Matrix<double, n, 1> strain;
  if (dim == 2 && material_.area_stiffness > 0.0) {
    strain = elastic_constants().ldlt().solve(pull);
  } else {
    Eigen::Matrix<double, n + 1, n + 1> system = Eigen::Matrix<double, n + 1, n + 1>::Zero();
    system.template topLeftCorner<n, n>() = elastic_constants();
    system.template block<n, 1>(0, n) = volume;
    system.template block<1, n>(n, 0) = volume.transpose();
    Eigen::Matrix<double, n + 1, 1> right = Eigen::Matrix<double, n + 1, 1>::Zero();
    right.template head<n>() = pull;
    strain = system.fullPivLu().solve(right).template head<n>();
  }
  return (dim == 2 ? 0.75 : 1.0) / pull.dot(strain);
}

template class BulkLattice<2>;
template class BulkLattice<3>;

}  // namespace sprung::calibration
