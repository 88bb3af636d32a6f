#include "calibration/surface_layer.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace sprung::calibration {

namespace {

/// What the kernel does to fields of one coordinate y on the cubic lattice of unit spacing.
struct LayerSums {
  std::vector<double> weight;  ///< of layer m: sum of -F over its sites, gradient normalised
  double sigma = 0.0;          ///< -d ln S / d(div u)
};

LayerSums layer_sums(double smoothing_length_ratio) {
  sph::Kernel<3> kernel(smoothing_length_ratio);
  const sph::LatticeSums lattice = sph::lattice_sums(kernel, 1.0);
  kernel.normalise_gradient(lattice.gradient);
  const int reach = static_cast<int>(std::ceil(kernel.support_radius())) - 1;
  LayerSums sums;
  sums.sigma = lattice.gradient / lattice.partition;
  for (int m = 0; m <= reach; ++m) {
    double weight = 0.0;
    for (int i = -reach; i <= reach; ++i)
      for (int k = -reach; k <= reach; ++k) {
        const double r = std::sqrt(double(m * m + i * i + k * k));
        if (r > 0.0 && r < kernel.support_radius()) weight -= kernel.gradient_factor(r);
      }
    sums.weight.push_back(weight);
  }
  return sums;
}

/// The condition of surface_layer_decay, a polynomial in x = cos k, times dx^2/c^2: cos(m k) and
/// sin(m k)/sin(k) are Chebyshev's polynomials T_m and U_(m-1).
double condition(const LayerSums& sums, double c11, double ratio, double x) {
  double gradient = 0.0, laplacian = 0.0;  // g / sin k, l
  double t_before = 1.0, t = x, u_before = 0.0, u = 1.0;
  for (std::size_t m = 1; m < sums.weight.size(); ++m) {
    gradient += 2.0 * sums.weight[m] * static_cast<double>(m) * u;
    laplacian += 4.0 * sums.weight[m] * (1.0 - t);
    const double t_next = 2.0 * x * t - t_before, u_next = 2.0 * x * u - u_before;
    t_before = t, t = t_next, u_before = u, u = u_next;
  }
  const double square = gradient * gradient;
  return sums.sigma * (1.0 + x) * square / (2.0 * c11) +
         ratio * (laplacian - (1.0 - x * x) * square);
}

}  // namespace

std::complex<double> surface_layer_decay(const Material& material, double smoothing_length_ratio,
                                         double courant, double density_feedback) {
  const LayerSums sums = layer_sums(smoothing_length_ratio);
  const double c11 = material.bonds == sph::Bonds::equal ? 13.0 / 3.0 : 3.0;
  // The polynomial's coefficients from its values, its roots as eigenvalues.
  const auto degree = static_cast<Eigen::Index>(2 * (sums.weight.size() - 1));
  Eigen::MatrixXd powers(degree + 1, degree + 1);
  Eigen::VectorXd values(degree + 1);
  for (Eigen::Index row = 0; row <= degree; ++row) {
    const double x = -1.0 + 2.0 * static_cast<double>(row) / static_cast<double>(degree);
    for (Eigen::Index power = 0; power <= degree; ++power)
      powers(row, power) = std::pow(x, static_cast<double>(power));
    values[row] = condition(sums, c11, courant / density_feedback, x);
  }
  const Eigen::VectorXd coefficient = powers.colPivHouseholderQr().solve(values);
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  companion.diagonal(-1).setOnes();
  companion.col(degree - 1) = -coefficient.head(degree) / coefficient[degree];
  std::complex<double> slowest = 0.0;
  for (const std::complex<double>& x : companion.eigenvalues()) {
    const std::complex<double> root = std::sqrt(x * x - 1.0);
    for (const std::complex<double> z : {x + root, x - root})
      if (std::abs(z) < 1.0 && z.imag() >= 0.0 && std::abs(z) > std::abs(slowest)) slowest = z;
  }
  return slowest;
}

}  // namespace sprung::calibration
