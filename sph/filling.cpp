#include "sph/filling.hpp"

#include <algorithm>
#include <cmath>

#include <omp.h>

namespace sprung::sph {

namespace {

/// The three nodes along one axis that a point feeds, and its parts.
struct Parts {
  std::ptrdiff_t first;
  std::array<double, 3> weight;
};

/// `place`: in spacings from the first node.
Parts parts_at(double place) {
  const double nearest = std::floor(place + 0.5), e = place - nearest;
  return {static_cast<std::ptrdiff_t>(nearest) - 1,
          {0.5 * (0.5 - e) * (0.5 - e), 0.75 - e * e, 0.5 * (0.5 + e) * (0.5 + e)}};
}

/// Calls act(node, weight) for the nodes of `extent` that a point feeds and whose place along the
/// last axis lies in [from, to).
template <int dim, typename Act>
void for_each_fed(const std::array<Parts, dim>& parts,
                  const std::array<std::ptrdiff_t, dim>& extent, std::ptrdiff_t from,
                  std::ptrdiff_t to, Act&& act) {
  const auto along = [&](int axis, std::ptrdiff_t low, std::ptrdiff_t high, auto&& next) {
    for (int k = 0; k < 3; ++k)
      if (const std::ptrdiff_t at = parts[axis].first + k; at >= low && at < high)
        next(at, parts[axis].weight[k]);
  };
  const auto in_plane = [&](std::ptrdiff_t above, double weight) {
    along(1, dim == 2 ? from : 0, dim == 2 ? to : extent[1], [&](std::ptrdiff_t y, double wy) {
      along(0, 0, extent[0], [&](std::ptrdiff_t x, double wx) {
        act((above + y) * extent[0] + x, weight * wy * wx);
      });
    });
  };
  if constexpr (dim == 2)
    in_plane(0, 1.0);
  else
    along(2, from, to, [&](std::ptrdiff_t z, double wz) { in_plane(z * extent[1], wz); });
}

}  // namespace

template <int dim>
FillingGrid<dim>::FillingGrid(const Vector<dim>& low, const Vector<dim>& high, double spacing)
    : first_node_(low - Vector<dim>::Constant(0.5 * spacing)), spacing_(spacing) {
  std::ptrdiff_t nodes = 1;
  for (int d = 0; d < dim; ++d) {
    extent_[d] = std::lround((high[d] - low[d]) / spacing) + 2;
    nodes *= extent_[d];
  }
  filling_.resize(static_cast<std::size_t>(nodes));
  missing_.resize(filling_.size());
}

template <int dim>
void FillingGrid<dim>::lacking(std::span<const Vector<dim>> points, std::span<const double> volume,
                               std::span<double> lacking) {
  const double per_spacing = 1.0 / spacing_;
  const auto parts_of = [&](std::size_t i) {
    std::array<Parts, dim> parts;
    for (int d = 0; d < dim; ++d)
      parts[d] = parts_at((points[i][d] - first_node_[d]) * per_spacing);
    return parts;
  };
  const double per_cube = 1.0 / std::pow(spacing_, dim);
  const std::ptrdiff_t rows = extent_[dim - 1];
  // Each thread has rows of nodes of its own and looks at every point: a node's sum runs over the
  // points in their order, so it is the same for any number of threads.
#pragma omp parallel
  {
    const std::ptrdiff_t threads = omp_get_num_threads(), thread = omp_get_thread_num();
    const std::ptrdiff_t from = rows * thread / threads, to = rows * (thread + 1) / threads;
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(filling_.size()) / rows;
    std::fill(filling_.begin() + from * row, filling_.begin() + to * row, 0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double place = (points[i][dim - 1] - first_node_[dim - 1]) * per_spacing;
      if (place < static_cast<double>(from) - 2.0 || place > static_cast<double>(to) + 1.0)
        continue;
      const double part = volume[i] * per_cube;
      for_each_fed<dim>(parts_of(i), extent_, from, to, [&](std::ptrdiff_t node, double weight) {
        filling_[node] += part * weight;
      });
    }
    for (std::ptrdiff_t node = from * row; node < to * row; ++node)
      missing_[node] = filling_[node] > 0.0 ? 1.0 / filling_[node] - 1.0 : 0.0;
  }
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < lacking.size(); ++i) {
    double sum = 0.0;
    for_each_fed<dim>(parts_of(i), extent_, 0, rows,
                      [&](std::ptrdiff_t node, double weight) { sum += weight * missing_[node]; });
    lacking[i] = sum;
  }
}

template class FillingGrid<2>;
template class FillingGrid<3>;

}  // namespace sprung::sph
