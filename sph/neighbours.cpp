#include "sph/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

namespace sprung::sph {

namespace {

/// A box of cubic cells that holds all points; cells are numbered with x running fastest.
template <int dim>
struct CellGrid {
  Vector<dim> origin;
  double inverse_cell;
  std::array<int, dim> extent;

  CellGrid(std::span<const Vector<dim>> points, double cell) : inverse_cell(1.0 / cell) {
    Vector<dim> low = points[0], high = points[0];
    for (const auto& x : points) {
      if (!x.allFinite()) throw std::runtime_error("a particle's position is not a number");
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    double cells = 1.0;
    origin = low - Vector<dim>::Constant(1e-9 * cell);
    for (int d = 0; d < dim; ++d) {
      const double n = std::floor((high[d] - origin[d]) * inverse_cell) + 1.0;
      cells *= n;
      if (!(cells < 1e9))
        throw std::runtime_error(
            "a particle has flown far out of the domain (or its position is not a number): the "
            "search "
            "grid would need more than a thousand million cells");
      extent[d] = static_cast<int>(n);
    }
  }
  int cells() const {
    int n = 1;
    for (int d = 0; d < dim; ++d) n *= extent[d];
    return n;
  }
  std::array<int, dim> coordinates(const Vector<dim>& x) const {
    std::array<int, dim> c;
    for (int d = 0; d < dim; ++d) c[d] = static_cast<int>((x[d] - origin[d]) * inverse_cell);
    return c;
  }
  int number(const std::array<int, dim>& c) const {
    int n = c[dim - 1];
    for (int d = dim - 2; d >= 0; --d) n = n * extent[d] + c[d];
    return n;
  }
};

/// More neighbours than this means that particles have clumped beyond use (the lattice has 20 in
/// the plane and 80 in space at h = 1.3 dx; 48 and 256 at h = 2 dx).
template <int dim>
constexpr std::size_t most_neighbours = dim == 2 ? 96 : 448;

/// Owners are worked on in chunks of fixed size, so that the work does not depend on the threads.
constexpr std::size_t chunk = 256;

}  // namespace

template <int dim>
std::size_t Support<dim>::pairs() const {
  return std::accumulate(count_.begin(), count_.end(), std::size_t{0});
}

template <int dim>
void Support<dim>::reserve(std::size_t owners) {
  first_.resize(owners);
  count_.resize(owners);
  partition_.resize(owners);
  if (owners <= capacity_) return;
  capacity_ = owners + owners / 16 + chunk;
  // Untouched pages cost nothing, so each particle may have room for the most neighbours.
  index_ = std::make_unique_for_overwrite<std::int32_t[]>(capacity_ * most_neighbours<dim>);
  factor_ = std::make_unique_for_overwrite<double[]>(capacity_ * most_neighbours<dim>);
}

template <int dim>
std::vector<std::int32_t> Support<dim>::cell_order(std::span<const Vector<dim>> points,
                                                   std::size_t first, std::size_t last,
                                                   double cell) {
  const CellGrid<dim> grid(points, cell);
  std::vector<std::int32_t> begin(grid.cells() + 1, 0);
  std::vector<std::int32_t> order(last - first);
  std::vector<std::int32_t> cell_of(last - first);
  for (std::size_t i = first; i < last; ++i)
    ++begin[(cell_of[i - first] = grid.number(grid.coordinates(points[i]))) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::size_t i = first; i < last; ++i)
    order[begin[cell_of[i - first]]++] = static_cast<std::int32_t>(i);
  return order;
}

template <int dim>
void Support<dim>::build(const Kernel<dim>& kernel, std::span<const Vector<dim>> points,
                         std::size_t owners, double volume) {
  reserve(owners);
  const double radius = kernel.support_radius();
  // Cells of half the radius: five rows of five hold fewer points that are too far than three rows
  // of three.
  constexpr int reach = 2;
  const CellGrid<dim> grid(points, radius / reach);
  const std::size_t n = points.size();
  const int cells = grid.cells();

  cell_begin_.assign(cells + 1, 0);
  cell_of_.resize(n);
  for (std::size_t i = 0; i < n; ++i)
    ++cell_begin_[(cell_of_[i] = grid.number(grid.coordinates(points[i]))) + 1];
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
  sorted_points_.resize(n);
  sorted_index_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t place = cell_begin_[cell_of_[i]]++;
    sorted_points_[place] = points[i];
    sorted_index_[place] = static_cast<std::int32_t>(i);
  }
  for (int c = cells; c > 0; --c) cell_begin_[c] = cell_begin_[c - 1];
  cell_begin_[0] = 0;

  const double radius2 = radius * radius;
  const double self = volume * kernel.value(0.0);
  const auto chunks = static_cast<std::ptrdiff_t>((owners + chunk - 1) / chunk);
  bool overfull = false;
#pragma omp parallel for schedule(dynamic, 1) reduction(|| : overfull)
  for (std::ptrdiff_t block = 0; block < chunks; ++block) {
    std::array<double, most_neighbours<dim> + 1> distance2;
    std::size_t write = block * chunk * most_neighbours<dim>;
    const std::size_t end = std::min(owners, (block + 1) * chunk);
    for (std::size_t i = block * chunk; i < end; ++i) {
      const Vector<dim> x = points[i];
      const auto c = grid.coordinates(x);
      std::int32_t* const index = index_.get() + write;
      std::size_t count = 0;
      auto scan_row = [&](std::array<int, dim> row) {
        row[0] = std::max(c[0] - reach, 0);
        const int first_cell = grid.number(row);
        row[0] = std::min(c[0] + reach, grid.extent[0] - 1);
        const std::int32_t last = cell_begin_[grid.number(row) + 1];
        for (std::int32_t s = cell_begin_[first_cell]; s < last; ++s) {
          const double d2 = (x - sorted_points_[s]).squaredNorm();
          // Written before it is known to count: a branch here would be taken one time in three.
          index[count] = sorted_index_[s];
          distance2[count] = d2;
          count += (d2 < radius2) & (sorted_index_[s] != static_cast<std::int32_t>(i));
          if (count == most_neighbours<dim>) [[unlikely]] {
            overfull = true;
            count = 0;
          }
        }
      };
      for (int dy = -reach; dy <= reach; ++dy) {
        if (c[1] + dy < 0 || c[1] + dy >= grid.extent[1]) continue;
        if constexpr (dim == 2) {
          scan_row({c[0], c[1] + dy});
        } else {
          for (int dz = -reach; dz <= reach; ++dz)
            if (c[2] + dz >= 0 && c[2] + dz < grid.extent[2])
              scan_row({c[0], c[1] + dy, c[2] + dz});
        }
      }
      double* const factor = factor_.get() + write;
      double partition = self;
      for (std::size_t k = 0; k < count; ++k) {
        const double r = std::sqrt(distance2[k]);
        factor[k] = kernel.gradient_factor(r);
        partition += volume * kernel.value(r);
      }
      partition_[i] = partition;
      first_[i] = write;
      count_[i] = static_cast<std::int32_t>(count);
      write += count;
    }
  }
  if (overfull)
    throw std::runtime_error(
        "a particle has more than " + std::to_string(most_neighbours<dim>) +
        " neighbours: particles have clumped; use shifting or a smaller time step");
}

template class Support<2>;
template class Support<3>;

}  // namespace sprung::sph
