#pragma once
/// The matrix of the pressure Poisson equation (left side of Eq. 3), one row per unknown particle.

#include "sph/boundary/images.hpp"
#include "sph/boundary/open_plane.hpp"
#include "sph/neighbours.hpp"

namespace sprung::sph {

/// sum_j a_ij (psi_i - psi_j) with a_ij = -2 V F_ij >= 0. An image's coefficient is folded into its
/// source, so a mirrored pressure gives dpsi/dn = 0. Pairs with particles of an inflow column are
/// left out (the velocity is prescribed there, so the pressure has no say: again dpsi/dn = 0);
/// those of a pressure column bring the psi of their side to the right side. Symmetric: volumes are
/// equal, and the coefficient of a pair across a curved wall is the mean of both sides'.
///
/// Pairs of particles are read from the support lists, which must stay as they are while the matrix
/// is in use; only what the images fold is stored here.
class PressureMatrix {
 public:
  /// `full_weight` (1/m2): where neighbours are missing, sum_j a_ij is topped up to it with
  /// particles of zero pressure, as at a free surface; 0 leaves the rows as they are.
  template <int dim>
  void assemble(const Particles<dim>& particles, const Images<dim>& images,
                const Support<dim>& support, const Kernel<dim>& kernel,
                const PressurePlanes<dim>& sides = {}, double full_weight = 0.0);

  std::size_t rows() const { return diagonal_.size(); }
  /// True when no row has a prescribed pressure beside it: psi is known up to a constant only.
  bool singular() const { return singular_; }
  const std::vector<double>& diagonal() const { return diagonal_; }
  /// What the prescribed pressures add to the right side.
  const std::vector<double>& boundary_source() const { return boundary_source_; }

  void multiply(std::span<const double> x, std::span<double> y) const;

  /// Entries of row i with columns below it and above it: calls visit(column, a_ij), a_ij to be
  /// subtracted. A column may come twice.
  template <typename Visit>
  void for_each_lower(std::size_t i, Visit&& visit) const {
    visit_pairs(first_[i], first_[i] + lower_[i], visit);
    const Folded& f = folded_[i];
    for (std::int32_t k = f.begin; k < f.upper; ++k) visit(folded_column_[k], folded_value_[k]);
  }
  template <typename Visit>
  void for_each_upper(std::size_t i, Visit&& visit) const {
    visit_pairs(first_[i] + lower_[i], first_[i] + inner_[i], visit);
    const Folded& f = folded_[i];
    for (std::int32_t k = f.upper; k < f.end; ++k) visit(folded_column_[k], folded_value_[k]);
  }
  template <typename Visit>
  void for_each(std::size_t i, Visit&& visit) const {
    visit_pairs(first_[i], first_[i] + inner_[i], visit);
    const Folded& f = folded_[i];
    for (std::int32_t k = f.begin; k < f.end; ++k) visit(folded_column_[k], folded_value_[k]);
  }

 private:
  /// Where the entries folded into row i stand: columns below i, then above.
  struct Folded {
    std::int32_t begin = 0, upper = 0, end = 0;
  };
  template <typename Visit>
  void visit_pairs(std::size_t begin, std::size_t end, Visit&& visit) const {
    for (std::size_t k = begin; k < end; ++k) visit(column_[k], scale_ * factor_[k]);
  }
  // The pairs of particles, in the support's own arrays.
  const std::int32_t* column_ = nullptr;
  const double* factor_ = nullptr;
  double scale_ = 0.0;
  std::span<const std::size_t> first_;
  std::span<const std::int32_t> lower_, inner_;

  std::vector<Folded> folded_;
  std::vector<std::int32_t> folded_column_;
  std::vector<double> folded_value_;
  std::vector<double> diagonal_;
  std::vector<double> boundary_source_;
  bool singular_ = false;
};

}  // namespace sprung::sph
