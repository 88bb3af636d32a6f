#include "sph/pressure/matrix.hpp"

#include <algorithm>

namespace sprung::sph {

namespace {

/// a_ij of particle i and image `index`. In a curved wall i's distance to the mirror of j is not
/// quite j's to the mirror of i, nor are the mirrored volumes equal: the mean of both makes the
/// matrix symmetric. A pair that only one of them sees is at the kernel's rim and left out.
template <int dim>
double coefficient(const Images<dim>& images, std::size_t i, std::int32_t index, double a,
                   const Kernel<dim>& kernel, double scale) {
  if (!images.by_shaped_wall(index)) return a;
  const auto opposite = images.opposite(static_cast<std::int32_t>(i), index);
  if (opposite.distance < 0.0 || opposite.distance >= kernel.support_radius()) return 0.0;
  return 0.5 * (a + scale * opposite.weight * kernel.gradient_factor(opposite.distance));
}

}  // namespace

template <int dim>
void PressureMatrix::assemble(const Particles<dim>& particles, const Images<dim>& images,
                              const Support<dim>& support, const Kernel<dim>& kernel,
                              const PressurePlanes<dim>& sides, double full_weight) {
  const auto& points = images.points();
  const std::size_t n = particles.unknowns;
  column_ = support.indices();
  factor_ = support.gradient_factors();
  first_ = support.starts();
  ends_ = support.ends();
  scale_ = -2.0 * particles.volume;
  diagonal_.resize(n);
  boundary_source_.resize(n);
  folded_.resize(n);
  std::int32_t outer = 0;
  for (std::size_t i = 0; i < n; ++i) {
    folded_[i].begin = outer;
    outer += static_cast<std::int32_t>(support.outer(i).index.size());
  }
  folded_column_.resize(outer);
  folded_value_.resize(outer);
  bool pinned = false;
#pragma omp parallel for schedule(static) reduction(|| : pinned)
  for (std::size_t i = 0; i < n; ++i) {
    double diagonal = scale_ * factor_sum(i), source = 0.0;
    const auto outside = support.outer(i);
    std::int32_t folded = folded_[i].begin;
    for (std::size_t k = 0; k < outside.index.size(); ++k) {
      const std::int32_t j = images.source(outside.index[k]);
      double a = scale_ * outside.gradient_factor[k];
      if (static_cast<std::size_t>(j) >= n) {
        if (particles.role[j] == Role::inflow) continue;
        a *= sides.reach(points[i], points[outside.index[k]]);
        diagonal += a;
        source += a * particles.pseudo_pressure[j];
        pinned = true;
        continue;
      }
      if (static_cast<std::size_t>(j) == i) continue;
      a = coefficient(images, i, outside.index[k], a, kernel, scale_);
      diagonal += a;
      folded_column_[folded] = j;
      folded_value_[folded++] = a;
    }
    if (diagonal < full_weight) {
      diagonal = full_weight;
      pinned = true;
    }
    sort_into_parts(i, folded - folded_[i].begin);
    diagonal_[i] = diagonal;
    boundary_source_[i] = source;
  }
  singular_ = !pinned;
}

/// The entries folded into row i.
void PressureMatrix::sort_into_parts(std::size_t i, std::int32_t entries) {
  const std::int32_t begin = folded_[i].begin, end = begin + entries;
  const auto self = static_cast<std::int32_t>(i);
  const auto block_first = static_cast<std::int32_t>(i - i % support_block);
  std::int32_t place = begin;
  // A row has few of them: what lies below a limit is moved to the front, one limit after another.
  const auto gather_below = [&](std::int32_t limit) {
    for (std::int32_t k = place; k < end; ++k)
      if (folded_column_[k] < limit) {
        std::swap(folded_column_[k], folded_column_[place]);
        std::swap(folded_value_[k], folded_value_[place++]);
      }
    return place - begin;
  };
  SupportEnds& row = folded_[i].ends;
  row.before_block = gather_below(block_first);
  row.lower = gather_below(self);
  row.in_block = gather_below(block_first + static_cast<std::int32_t>(support_block));
  row.inner = row.all = entries;
}

void PressureMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  const std::size_t n = rows();
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i)
    y[i] = diagonal_[i] * x[i] - sum<Order::ascending, Bound::begin, Bound::end>(i, x.data());
}

template void PressureMatrix::assemble<2>(const Particles<2>&, const Images<2>&, const Support<2>&,
                                          const Kernel<2>&, const PressurePlanes<2>&, double);
template void PressureMatrix::assemble<3>(const Particles<3>&, const Images<3>&, const Support<3>&,
                                          const Kernel<3>&, const PressurePlanes<3>&, double);

}  // namespace sprung::sph
