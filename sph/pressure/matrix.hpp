#pragma once
/// The matrix of the pressure Poisson equation (left side of Eq. 3), one row per unknown particle.

#include "sph/boundary/images.hpp"
#include "sph/neighbours.hpp"

namespace sprung::sph {

/// sum_j a_ij (psi_i - psi_j) with a_ij = -2 V F_ij >= 0. An image's coefficient is folded into its
/// source, so a mirrored pressure gives dpsi/dn = 0. Pairs with particles of an inflow column are
/// left out (the velocity is prescribed there, so the pressure has no say: again dpsi/dn = 0);
/// those of an outflow column bring their prescribed psi to the right side. Symmetric, since
/// volumes are equal and walls flat.
class PressureMatrix {
 public:
  /// `full_weight` (1/m2): where neighbours are missing, sum_j a_ij is topped up to it with
  /// particles of zero pressure, as at a free surface; 0 leaves the rows as they are.
  template <int dim>
  void assemble(const Particles<dim>& particles, const Images<dim>& images,
                const Support<dim>& support, double full_weight = 0.0);

  std::size_t rows() const { return diagonal_.size(); }
  /// True when no row has a prescribed pressure beside it: psi is known up to a constant only.
  bool singular() const { return singular_; }
  const std::vector<double>& diagonal() const { return diagonal_; }
  /// What the prescribed pressures add to the right side.
  const std::vector<double>& boundary_source() const { return boundary_source_; }

  void multiply(std::span<const double> x, std::span<double> y) const;

  struct Row {
    const std::int32_t* column;
    const double* value;  ///< a_ij, to be subtracted
    std::int32_t count;
  };
  /// Entries left (columns below i) and right (above i) of the diagonal, and both together.
  Row lower(std::size_t i) const { return {&column_[first_[i]], &value_[first_[i]], lower_[i]}; }
  Row upper(std::size_t i) const {
    const std::size_t begin = first_[i] + lower_[i];
    return {&column_[begin], &value_[begin], upper_[i]};
  }
  Row off_diagonal(std::size_t i) const {
    return {&column_[first_[i]], &value_[first_[i]], lower_[i] + upper_[i]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> lower_, upper_;
  std::vector<std::int32_t> column_;
  std::vector<double> value_;
  std::vector<double> diagonal_;
  std::vector<double> boundary_source_;
  bool singular_ = false;
};

}  // namespace sprung::sph
