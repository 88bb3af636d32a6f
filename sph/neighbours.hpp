#pragma once
/// The support domain of each particle (ACTION 3 and 9): all particles and images closer than 2h.

#include "sph/kernel.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace sprung::sph {

/// Owners are blocked by this many, in the order of their indices: what a smoother of the pressure
/// equation sweeps through in one go.
inline constexpr std::size_t support_block = 2048;

/// Where each part of a particle's list ends, counted from its begin.
struct SupportEnds {
  std::int32_t before_block, lower, in_block, inner, all;
};

/// For every particle that has an equation: its neighbours and the kernel's gradient factor of
/// each. Indices run over the particles and then the images.
template <int dim>
class Support {
 public:
  struct Neighbours {
    std::span<const std::int32_t> index;
    std::span<const double> gradient_factor;  ///< F_ij, the gradient at i is F_ij (x_i - x_j)
  };
  /// Neighbours of particle `i`, itself not among them. The list has five parts: owners of smaller
  /// index in the blocks before i's own, then those in its block; owners of larger index in its
  /// block, then those in the blocks after it; points that are no owners.
  Neighbours of(std::size_t i) const { return between(i, 0, ends_[i].all); }
  /// Those among the owners only, of smaller and of larger index, and those that are no owners.
  Neighbours lower(std::size_t i) const { return between(i, 0, ends_[i].lower); }
  Neighbours upper(std::size_t i) const { return between(i, ends_[i].lower, ends_[i].inner); }
  Neighbours inner(std::size_t i) const { return between(i, 0, ends_[i].inner); }
  Neighbours outer(std::size_t i) const { return between(i, ends_[i].inner, ends_[i].all); }
  /// The arrays themselves: list i begins at starts()[i].
  const std::int32_t* indices() const { return index_.get(); }
  const double* gradient_factors() const { return factor_.get(); }
  std::span<const std::size_t> starts() const { return first_; }
  std::span<const SupportEnds> ends() const { return ends_; }
  /// S_i = sum of V W over the support, self included: how densely the neighbourhood is filled.
  const std::vector<double>& partition() const { return partition_; }
  std::size_t size() const { return ends_.size(); }
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
  Neighbours between(std::size_t i, std::int32_t begin, std::int32_t end) const {
    const auto first = first_[i] + begin;
    const auto count = static_cast<std::size_t>(end - begin);
    return {{index_.get() + first, count}, {factor_.get() + first, count}};
  }
  void collect(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
               std::span<const Vector<dim>> points, double volume, std::span<const double> weights);
  bool fill(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
            std::span<const Vector<dim>> points, double volume, std::span<const double> weights);
  void reserve(std::size_t owners);
  void sort_into_cells(std::span<const Vector<dim>> points, double cell);
  std::vector<std::size_t> first_;
  std::vector<SupportEnds> ends_;
  std::unique_ptr<std::int32_t[]> index_;
  std::unique_ptr<double[]> factor_;
  std::size_t capacity_ = 0;        ///< pairs
  std::size_t chunk_capacity_ = 0;  ///< pairs that a chunk of owners has room for
  std::vector<double> partition_;
  std::array<std::vector<double>, dim> sorted_;  ///< [axis], in the order of the cells
  std::vector<std::int32_t> sorted_index_;
  std::vector<std::int32_t> cell_begin_;
  std::vector<std::int32_t> cell_of_;
};

}  // namespace sprung::sph
