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
  /// Neighbours of particle `i`, itself not among them.
  Neighbours of(std::size_t i) const {
    const auto first = first_[i];
    const std::size_t count = count_[i];
    return {{index_.get() + first, count}, {factor_.get() + first, count}};
  }
  /// S_i = sum of V W over the support, self included: how densely the neighbourhood is filled.
  const std::vector<double>& partition() const { return partition_; }
  std::size_t size() const { return count_.size(); }
  std::size_t pairs() const;

  /// Rebuilds the lists of the first `owners` of `points`. Throws std::runtime_error when a
  /// particle has more neighbours than a sound distribution can give.
  void build(const Kernel<dim>& kernel, std::span<const Vector<dim>> points, std::size_t owners,
             double volume);

  /// Order of `points[first..last)` by search cell: neighbours in space are neighbours in memory.
  static std::vector<std::int32_t> cell_order(std::span<const Vector<dim>> points,
                                              std::size_t first, std::size_t last, double cell);

 private:
  void reserve(std::size_t owners);
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> count_;
  std::unique_ptr<std::int32_t[]> index_;
  std::unique_ptr<double[]> factor_;
  std::size_t capacity_ = 0;
  std::vector<double> partition_;
  std::vector<Vector<dim>> sorted_points_;
  std::vector<std::int32_t> sorted_index_;
  std::vector<std::int32_t> cell_begin_;
  std::vector<std::int32_t> cell_of_;
};

}  // namespace sprung::sph
