#pragma once
/// The Wendland C2 kernel (section 2 of the paper, k = 2: support radius 2h) and its gradient.

#include "sph/vector.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace sprung::sph {

/// W(r) = alpha (1 - q/2)^4 (1 + 2q), q = r/h, of unit integral in `dim` dimensions.
/// Wendland 1995; alpha = 7/(4 pi h^2) in the plane, 21/(16 pi h^3) in space.
template <int dim>
class Kernel {
 public:
  /// `smoothing_length` in metres.
  explicit Kernel(double smoothing_length);

  double smoothing_length() const { return h_; }
  double support_radius() const { return 2.0 * h_; }

  /// Value at distance `r` < support_radius(), 1/m^dim.
  double value(double r) const {
    const double s = 1.0 - half_inverse_h_ * r;
    const double s2 = s * s;
    return alpha_ * s2 * s2 * (1.0 + 4.0 * half_inverse_h_ * r);
  }

  /// F = (dW/dr)/r, so that the gradient at i is F (x_i - x_j); regular at r = 0. 1/m^(dim+2).
  double gradient_factor(double r) const {
    const double s = 1.0 - half_inverse_h_ * r;
    return gradient_scale_ * s * s * s;
  }

  /// Divides the gradient by `factor`; see lattice_gradient_factor.
  void normalise_gradient(double factor) { gradient_scale_ /= factor; }

 private:
  double h_;
  double half_inverse_h_;
  double alpha_;
  double gradient_scale_;
};

template <int dim>
Kernel<dim>::Kernel(double smoothing_length)
    : h_(smoothing_length), half_inverse_h_(0.5 / smoothing_length) {
  constexpr double pi = std::numbers::pi;
  alpha_ = dim == 2 ? 7.0 / (4.0 * pi * h_ * h_) : 21.0 / (16.0 * pi * h_ * h_ * h_);
  gradient_scale_ = -5.0 * alpha_ / (h_ * h_);
}

/// Sums of the kernel over the undisturbed lattice of the given spacing.
struct LatticeSums {
  double partition;        ///< sum of V W, self included: 1 in the limit of many neighbours
  double gradient;         ///< discrete over exact gradient of a linear field: -sum V F x^2
  double gradient_weight;  ///< sum of -V F over the neighbours, 1/m^2
  /// Largest eigenvalue of u -> sum of -V F (u_i - u_j), 1/m^2, over the waves at the corners of the
  /// lattice's Brillouin zone; no other wave decays faster by more than 1 % (h = 1 to 2 dx).
  double fastest_decay;
  double decay_along_axis;  ///< that of the wave which turns its sign along one axis
};

template <int dim>
LatticeSums lattice_sums(const Kernel<dim>& kernel, double spacing) {
  const int reach = static_cast<int>(kernel.support_radius() / spacing) + 1;
  const double volume = std::pow(spacing, dim);
  LatticeSums sums{};
  std::array<double, 1 << dim> decay{};  // bit d of the corner: the wave turns its sign along d
  const int depth = dim == 3 ? reach : 0;
  for (int i = -reach; i <= reach; ++i)
    for (int j = -reach; j <= reach; ++j)
      for (int k = -depth; k <= depth; ++k) {
        const double r = spacing * std::sqrt(double(i * i + j * j + k * k));
        if (r >= kernel.support_radius()) continue;
        sums.partition += volume * kernel.value(r);
        if (r == 0.0) continue;
        const double x = spacing * i;
        sums.gradient -= volume * kernel.gradient_factor(r) * x * x;
        sums.gradient_weight -= volume * kernel.gradient_factor(r);
        const unsigned odd = (i & 1) | (j & 1) << 1 | (k & 1) << 2;
        for (unsigned corner = 0; corner < decay.size(); ++corner)
          if (std::popcount(corner & odd) % 2 == 1)
            decay[corner] -= 2.0 * volume * kernel.gradient_factor(r);
      }
  sums.decay_along_axis = decay[1];
  sums.fastest_decay = *std::max_element(decay.begin(), decay.end());
  return sums;
}

}  // namespace sprung::sph
