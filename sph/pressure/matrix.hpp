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

  /// Entries of row i, all, with columns below it, above it: calls visit(column, a_ij), a_ij to be
  /// subtracted. A column may come twice.
  template <typename Visit>
  void for_each(std::size_t i, Visit&& visit) const {
    visit_pairs(i, 0, ends_[i].inner, visit);
    visit_folded(i, 0, folded_[i].ends.inner, visit);
  }
  template <typename Visit>
  void for_each_lower(std::size_t i, Visit&& visit) const {
    visit_pairs(i, 0, ends_[i].lower, visit);
    visit_folded(i, 0, folded_[i].ends.lower, visit);
  }
  template <typename Visit>
  void for_each_upper(std::size_t i, Visit&& visit) const {
    visit_pairs(i, ends_[i].lower, ends_[i].inner, visit);
    visit_folded(i, folded_[i].ends.lower, folded_[i].ends.inner, visit);
  }

  /// Asks memory for the pairs above row i: worth it where rows are taken in no order of memory.
  void prefetch_upper(std::size_t i) const {
    constexpr std::int32_t line = 64;  // bytes
    for (std::int32_t k = ends_[i].lower; k < ends_[i].inner; k += line / sizeof(std::int32_t))
      __builtin_prefetch(column_ + first_[i] + k);
    for (std::int32_t k = ends_[i].lower; k < ends_[i].inner; k += line / sizeof(double))
      __builtin_prefetch(factor_ + first_[i] + k);
  }

  /// The sum of a_ij x_j over the columns of row i from one bound to the other: the begin, the end
  /// of the support's blocks of owners before i's own, i itself, the end of its block, the end. A
  /// sweep that takes the rows in descending order reads the pairs of each in descending order too:
  /// memory is then read ahead; mixed orders took three times as long.
  enum class Bound { begin, before_block, self, in_block, end };
  enum class Order { ascending, descending };
  template <Order order, Bound from, Bound to>
  double sum(std::size_t i, const double* x) const {
    return pair_sum<order>(i, place(ends_[i], from), place(ends_[i], to), x) +
           folded_sum(i, place(folded_[i].ends, from), place(folded_[i].ends, to), x);
  }

 private:
  /// Where the entries folded into row i stand, and where their parts end, as those of the pairs.
  struct Folded {
    std::int32_t begin = 0;
    SupportEnds ends{};
  };
  static std::int32_t place(const SupportEnds& ends, Bound bound) {
    switch (bound) {
      case Bound::begin:
        return 0;
      case Bound::before_block:
        return ends.before_block;
      case Bound::self:
        return ends.lower;
      case Bound::in_block:
        return ends.in_block;
      case Bound::end:
        break;
    }
    return ends.inner;
  }
  template <typename Visit>
  void visit_pairs(std::size_t i, std::int32_t begin, std::int32_t end, Visit&& visit) const {
    const std::int32_t* const column = column_ + first_[i];
    const double* const factor = factor_ + first_[i];
    for (std::int32_t k = begin; k < end; ++k) visit(column[k], scale_ * factor[k]);
  }
  template <typename Visit>
  void visit_folded(std::size_t i, std::int32_t begin, std::int32_t end, Visit&& visit) const {
    const std::int32_t first = folded_[i].begin;
    for (std::int32_t k = first + begin; k < first + end; ++k)
      visit(folded_column_[k], folded_value_[k]);
  }
  /// Four sums side by side: in one, each addition would wait for the one before.
  template <Order order>
  double pair_sum(std::size_t i, std::int32_t begin, std::int32_t end, const double* x) const {
    constexpr std::int32_t step = order == Order::ascending ? 1 : -1;
    const std::int32_t first = order == Order::ascending ? begin : end - 1;
    const std::int32_t* column = column_ + first_[i] + first;
    const double* factor = factor_ + first_[i] + first;
    std::array<double, 4> part{};
    std::int32_t left = end - begin;
    for (; left >= 4; left -= 4, column += 4 * step, factor += 4 * step)
      for (int p = 0; p < 4; ++p) part[p] += factor[p * step] * x[column[p * step]];
    for (; left > 0; --left, column += step, factor += step) part[0] += *factor * x[*column];
    return scale_ * ((part[0] + part[1]) + (part[2] + part[3]));
  }
  /// The same of the factors alone.
  double factor_sum(std::size_t i) const {
    const double* factor = factor_ + first_[i];
    std::array<double, 4> part{};
    std::int32_t left = ends_[i].inner;
    for (; left >= 4; left -= 4, factor += 4)
      for (int p = 0; p < 4; ++p) part[p] += factor[p];
    for (; left > 0; --left, ++factor) part[0] += *factor;
    return (part[0] + part[1]) + (part[2] + part[3]);
  }
  double folded_sum(std::size_t i, std::int32_t begin, std::int32_t end, const double* x) const {
    double sum = 0.0;
    visit_folded(i, begin, end, [&](std::int32_t j, double a) { sum += a * x[j]; });
    return sum;
  }
  void sort_into_parts(std::size_t i, std::int32_t entries);
  // The pairs of particles, in the support's own arrays.
  const std::int32_t* column_ = nullptr;
  const double* factor_ = nullptr;
  double scale_ = 0.0;
  std::span<const std::size_t> first_;
  std::span<const SupportEnds> ends_;

  std::vector<Folded> folded_;
  std::vector<std::int32_t> folded_column_;
  std::vector<double> folded_value_;
  std::vector<double> diagonal_;
  std::vector<double> boundary_source_;
  bool singular_ = false;
};

}  // namespace sprung::sph
