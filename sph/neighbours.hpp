#pragma once
/// The support domain of each particle (ACTION 3 and 9): all particles and images closer than 2h.

#include "sph/kernel.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sprung::sph {

/// For every particle that has an equation: its neighbours and the kernel's gradient factor of
/// each. Indices run over the particles and then the images.
template <int dim>
class Support {
 public:
  struct Neighbours {
    std::span<const std::int32_t> index;
    std::span<const double> gradient_factor;  ///< F_ij, the gradient at i is F_ij (x_i - x_j)
  };
  /// Neighbours of particle `i`, itself not among them: owners of smaller index, owners of larger
  /// index, then the rest.
  Neighbours of(std::size_t i) const { return part(i, 0, count_[i]); }
  /// Those among the owners only, of smaller and of larger index, and those that are no owners.
  Neighbours lower(std::size_t i) const { return part(i, 0, lower_[i]); }
  Neighbours upper(std::size_t i) const { return part(i, lower_[i], inner_[i]); }
  Neighbours inner(std::size_t i) const { return part(i, 0, inner_[i]); }
  Neighbours outer(std::size_t i) const { return part(i, inner_[i], count_[i]); }
  /// The arrays themselves: list i begins at starts()[i]; its lower and inner parts end at
  /// lower_counts()[i] and inner_counts()[i] from there.
  const std::int32_t* indices() const { return index_.get(); }
  const double* gradient_factors() const { return factor_.get(); }
  std::span<const std::size_t> starts() const { return first_; }
  std::span<const std::int32_t> lower_counts() const { return lower_; }
  std::span<const std::int32_t> inner_counts() const { return inner_; }
  /// S_i = sum of V W over the support, self included: how densely the neighbourhood is filled.
  const std::vector<double>& partition() const { return partition_; }
  std::size_t size() const { return count_.size(); }
  std::size_t pairs() const;

  /// Rebuilds the lists of the first `owners` of `points`. `weights`: what each point's gradient
  /// factor and kernel value count for; empty: 1. Throws std::runtime_error when a particle has
  /// more neighbours than a sound distribution can give.
  void build(const Kernel<dim>& kernel, std::span<const Vector<dim>> points, std::size_t owners,
             double volume, std::span<const double> weights = {});
  /// The same for `centres` that are not among the points: all neighbours are outer ones.
  void build_around(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
                    std::span<const Vector<dim>> points, double volume,
                    std::span<const double> weights = {});

  /// Order of `points[first..last)` by search cell: neighbours in space are neighbours in memory.
  static std::vector<std::int32_t> cell_order(std::span<const Vector<dim>> points,
                                              std::size_t first, std::size_t last, double cell);

 private:
  Neighbours part(std::size_t i, std::int32_t begin, std::int32_t end) const {
    const auto first = first_[i] + begin;
    const auto count = static_cast<std::size_t>(end - begin);
    return {{index_.get() + first, count}, {factor_.get() + first, count}};
  }
  void collect(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
               std::span<const Vector<dim>> points, double volume, std::span<const double> weights);
  void reserve(std::size_t owners);
  void sort_into_cells(std::span<const Vector<dim>> points, double cell);
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> lower_, inner_, count_;  ///< ends of the parts of each list
  std::unique_ptr<std::int32_t[]> index_;
  std::unique_ptr<double[]> factor_;
  std::size_t capacity_ = 0;        ///< pairs
  std::size_t chunk_capacity_ = 0;  ///< pairs that a chunk of owners has room for
  std::vector<double> partition_;
  std::vector<Vector<dim>> sorted_points_;
  std::vector<std::int32_t> sorted_index_;
  std::vector<std::int32_t> cell_begin_;
  std::vector<std::int32_t> cell_of_;
};

}  // namespace sprung::sph
