#include "sph/neighbours.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
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
    for (int d = 0; d < dim; ++d)
      c[d] = static_cast<int>(std::floor((x[d] - origin[d]) * inverse_cell));
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

/// Neighbours on the lattice whose cells have this volume.
template <int dim>
double lattice_neighbours(double radius, double volume) {
  constexpr double unit_ball = dim == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi;
  return unit_ball * std::pow(radius, dim) / volume;
}

}  // namespace

template <int dim>
std::size_t Support<dim>::pairs() const {
  return std::accumulate(count_.begin(), count_.end(), std::size_t{0});
}

template <int dim>
void Support<dim>::reserve(std::size_t owners) {
  first_.resize(owners);
  for (auto* ends : {&lower_, &inner_, &count_}) ends->resize(owners);
  partition_.resize(owners);
  const std::size_t pairs = (owners + chunk - 1) / chunk * chunk_capacity_;
  if (pairs <= capacity_) return;
  capacity_ = pairs + pairs / 16;
  index_ = std::make_unique_for_overwrite<std::int32_t[]>(capacity_);
  factor_ = std::make_unique_for_overwrite<double[]>(capacity_);
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

/// Fills cell_begin_, sorted_points_ and sorted_index_.
template <int dim>
void Support<dim>::sort_into_cells(std::span<const Vector<dim>> points, double cell) {
  const CellGrid<dim> grid(points, cell);
  const std::size_t n = points.size();
  const int cells = grid.cells();
  cell_begin_.assign(cells + 1, 0);
  cell_of_.resize(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) cell_of_[i] = grid.number(grid.coordinates(points[i]));
  for (std::size_t i = 0; i < n; ++i) ++cell_begin_[cell_of_[i] + 1];
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
}

namespace {

/// The points closer than a radius to one place, not itself.
template <int dim>
struct Found {
  std::array<std::int32_t, most_neighbours<dim> + 1> index;
  std::array<double, most_neighbours<dim> + 1> distance2, factor, value;
  std::size_t count;
};

/// Cells of half the radius: five rows of five hold fewer points that are too far than three rows
/// of three.
constexpr int reach = 2;

}  // namespace

template <int dim>
void Support<dim>::build(const Kernel<dim>& kernel, std::span<const Vector<dim>> points,
                         std::size_t owners, double volume, std::span<const double> weights) {
  collect(kernel, points.first(owners), points, volume, weights);
}

template <int dim>
void Support<dim>::build_around(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
                                std::span<const Vector<dim>> points, double volume,
                                std::span<const double> weights) {
  collect(kernel, centres, points, volume, weights);
}

/// `centres` are the first points, or places of their own.
template <int dim>
void Support<dim>::collect(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
                           std::span<const Vector<dim>> points, double volume,
                           std::span<const double> weights) {
  const std::size_t all = centres.size();
  const auto owners = static_cast<std::int32_t>(centres.data() == points.data() ? all : 0);
  const double radius = kernel.support_radius();
  // Half as many again as on the lattice, on average over a chunk, is more than any sound
  // distribution has.
  chunk_capacity_ =
      chunk * static_cast<std::size_t>(16.0 + 1.5 * lattice_neighbours<dim>(radius, volume));
  reserve(all);
  const CellGrid<dim> grid(points, radius / reach);
  sort_into_cells(points, radius / reach);

  const double radius2 = radius * radius;
  const double own_value = owners > 0 ? volume * kernel.value(0.0) : 0.0;
  const auto chunks = static_cast<std::ptrdiff_t>((all + chunk - 1) / chunk);
  bool overfull = false;
#pragma omp parallel for schedule(dynamic, 1) reduction(|| : overfull)
  for (std::ptrdiff_t block = 0; block < chunks; ++block) {
    Found<dim> found;
    std::size_t write = block * chunk_capacity_;
    const std::size_t room = write + chunk_capacity_;
    const std::size_t end = std::min(all, (block + 1) * chunk);
    for (std::size_t i = block * chunk; i < end; ++i) {
      const std::int32_t self = owners > 0 ? static_cast<std::int32_t>(i) : -1;
      const Vector<dim> x = centres[i];
      const auto c = grid.coordinates(x);
      std::size_t count = 0;
      auto scan_row = [&](std::array<int, dim> row) {
        row[0] = std::clamp(c[0] - reach, 0, grid.extent[0] - 1);
        const int first_cell = grid.number(row);
        row[0] = std::clamp(c[0] + reach, 0, grid.extent[0] - 1);
        const std::int32_t last = cell_begin_[grid.number(row) + 1];
        for (std::int32_t s = cell_begin_[first_cell]; s < last; ++s) {
          const double d2 = (x - sorted_points_[s]).squaredNorm();
          // Written before it is known to count: a branch here would be taken one time in three.
          found.index[count] = sorted_index_[s];
          found.distance2[count] = d2;
          count += (d2 < radius2) & (sorted_index_[s] != self);
          if (count > most_neighbours<dim>) [[unlikely]] {
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
      if (write + count > room) {
        overfull = true;
        count = 0;
      }
      // Where each part of the list begins; then every neighbour to its part.
      std::array<std::size_t, 3> place{write, write, write};
      const auto part = [&](std::int32_t j) { return j < self ? 0 : j < owners ? 1 : 2; };
      for (std::size_t k = 0; k < count; ++k) {
        const int p = part(found.index[k]);
        place[1] += p < 1;
        place[2] += p < 2;
      }
      first_[i] = write;
      lower_[i] = static_cast<std::int32_t>(place[1] - write);
      inner_[i] = static_cast<std::int32_t>(place[2] - write);
      count_[i] = static_cast<std::int32_t>(count);
      // In a loop of its own, which the compiler turns into vector instructions.
      for (std::size_t k = 0; k < count; ++k) {
        const double r = std::sqrt(found.distance2[k]);
        found.factor[k] = kernel.gradient_factor(r);
        found.value[k] = volume * kernel.value(r);
      }
      double partition = own_value;
      for (std::size_t k = 0; k < count; ++k) {
        const std::int32_t j = found.index[k];
        const double weight = weights.empty() ? 1.0 : weights[j];
        const std::size_t to = place[part(j)]++;
        index_[to] = j;
        factor_[to] = weight * found.factor[k];
        partition += weight * found.value[k];
      }
      partition_[i] = partition;
      write += count;
    }
  }
  if (overfull)
    throw std::runtime_error(
        "a particle has more than " + std::to_string(most_neighbours<dim>) +
        " neighbours, or a region half as many again as it should: particles have clumped; use "
        "shifting or a smaller time step");
}

template class Support<2>;
template class Support<3>;

}  // namespace sprung::sph
