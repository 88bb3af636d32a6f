#include "sph/pressure/matrix.hpp"

#include <algorithm>

namespace sprung::sph {

template <int dim>
void PressureMatrix::assemble(const Particles<dim>& particles, const Images<dim>& images,
                              const Support<dim>& support, double full_weight) {
  const std::size_t n = particles.unknowns;
  first_.resize(n + 1);
  lower_.resize(n);
  upper_.resize(n);
  diagonal_.resize(n);
  boundary_source_.resize(n);
  first_[0] = 0;
  for (std::size_t i = 0; i < n; ++i) first_[i + 1] = first_[i] + support.of(i).index.size();
  if (column_.size() < first_[n]) {
    column_.resize(first_[n] + first_[n] / 16);
    value_.resize(first_[n] + first_[n] / 16);
  }
  const double scale = -2.0 * particles.volume;
  bool pinned = false;
#pragma omp parallel for schedule(static) reduction(|| : pinned)
  for (std::size_t i = 0; i < n; ++i) {
    const auto neighbours = support.of(i);
    std::size_t front = first_[i], back = first_[i + 1];
    double diagonal = 0.0, source = 0.0;
    for (std::size_t k = 0; k < neighbours.index.size(); ++k) {
      const std::int32_t j = images.source(neighbours.index[k]);
      const double a = scale * neighbours.gradient_factor[k];
      if (static_cast<std::size_t>(j) >= n) {
        if (particles.role[j] == Role::inflow) continue;
        diagonal += a;
        source += a * particles.pseudo_pressure[j];
        pinned = true;
        continue;
      }
      if (static_cast<std::size_t>(j) == i) continue;
      diagonal += a;
      // Lower entries grow from the row's begin, upper ones from its end; where nothing was left
      // out they meet.
      const std::size_t place = static_cast<std::size_t>(j) < i ? front++ : --back;
      column_[place] = j;
      value_[place] = a;
    }
    if (diagonal < full_weight) {
      diagonal = full_weight;
      pinned = true;
    }
    lower_[i] = static_cast<std::int32_t>(front - first_[i]);
    upper_[i] = static_cast<std::int32_t>(first_[i + 1] - back);
    std::copy(&column_[back], &column_[first_[i + 1]], &column_[front]);
    std::copy(&value_[back], &value_[first_[i + 1]], &value_[front]);
    diagonal_[i] = diagonal;
    boundary_source_[i] = source;
  }
  singular_ = !pinned;
}

void PressureMatrix::multiply(std::span<const double> x, std::span<double> y) const {
  const std::size_t n = rows();
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    double sum = diagonal_[i] * x[i];
    const Row row = off_diagonal(i);
    for (std::int32_t k = 0; k < row.count; ++k) sum -= row.value[k] * x[row.column[k]];
    y[i] = sum;
  }
}

template void PressureMatrix::assemble<2>(const Particles<2>&, const Images<2>&, const Support<2>&,
                                          double);
template void PressureMatrix::assemble<3>(const Particles<3>&, const Images<3>&, const Support<3>&,
                                          double);

}  // namespace sprung::sph
