#include "sph/neighbours.hpp"

#include "sph/counting_sort.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
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

/// Memory for `count` numbers, in the processor's large pages where Linux has them to give: the
/// sweeps run through all lists, and with pages of 4 kB they wait for addresses too.
template <typename Number>
std::unique_ptr<Number[]> on_large_pages(std::size_t count) {
  auto memory = std::make_unique_for_overwrite<Number[]>(count);
  constexpr std::size_t page = std::size_t{1} << 21;
  void* begin = memory.get();
  std::size_t bytes = count * sizeof(Number);
  if (std::align(page, page, begin, bytes)) madvise(begin, bytes / page * page, MADV_HUGEPAGE);
  return memory;
}

}  // namespace

template <int dim>
std::size_t Support<dim>::pairs() const {
  std::size_t sum = 0;
  for (const SupportEnds& ends : ends_) sum += static_cast<std::size_t>(ends.all);
  return sum;
}

template <int dim>
void Support<dim>::reserve(std::size_t owners) {
  first_.resize(owners);
  ends_.resize(owners);
  partition_.resize(owners);
  const std::size_t pairs = (owners + chunk - 1) / chunk * chunk_capacity_;
  if (pairs <= capacity_) return;
  capacity_ = pairs + pairs / 16;
  index_ = on_large_pages<std::int32_t>(capacity_);
  factor_ = on_large_pages<double>(capacity_);
}

template <int dim>
std::vector<std::int32_t> Support<dim>::cell_order(std::span<const Vector<dim>> points,
                                                   std::size_t first, std::size_t last,
                                                   double cell) {
  const CellGrid<dim> grid(points, cell);
  std::vector<std::int32_t> begin, cell_of(last - first), order(last - first);
  for (std::size_t i = first; i < last; ++i)
    cell_of[i - first] = grid.number(grid.coordinates(points[i]));
  counting_sort(cell_of, grid.cells(), begin, [&](std::size_t i, std::int32_t place) {
    order[place] = static_cast<std::int32_t>(first + i);
  });
  return order;
}

/// Fills cell_begin_, sorted_ and sorted_index_.
template <int dim>
void Support<dim>::sort_into_cells(std::span<const Vector<dim>> points, double cell) {
  const CellGrid<dim> grid(points, cell);
  const std::size_t n = points.size();
  cell_of_.resize(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) cell_of_[i] = grid.number(grid.coordinates(points[i]));
  constexpr std::size_t read_beyond = 3;  // by Found::add_row, which takes four at a time
  for (auto& coordinate : sorted_) coordinate.resize(n + read_beyond);
  sorted_index_.resize(n + read_beyond);
  counting_sort(cell_of_, grid.cells(), cell_begin_, [&](std::size_t i, std::int32_t place) {
    for (int d = 0; d < dim; ++d) sorted_[d][place] = points[i][d];
    sorted_index_[place] = static_cast<std::int32_t>(i);
  });
}

namespace {

/// The points closer than a radius to one place.
template <int dim>
struct Found {
  /// A row of cells with more points than this is clumped beyond use, too.
  static constexpr std::int32_t most_in_row = 256;
  static constexpr std::size_t room = most_neighbours<dim> + most_in_row + 4;
  std::array<std::int32_t, room> index, shift;
  std::array<double, room> distance2, factor, value;
  std::size_t count = 0;
  bool overfull = false;

  /// Those of the sorted points `first` to `last`, a row of cells, that are closer than the radius.
  void add_row(const std::array<std::vector<double>, dim>& sorted, const std::int32_t* number,
               std::int32_t first, std::int32_t last, const Vector<dim>& x, double radius2) {
    if (count > most_neighbours<dim> || last - first > most_in_row) [[unlikely]] {
      overfull = true;
      return;
    }
    for (std::int32_t s = first; s < last; s += 4) {
      std::array<double, 4> d2;
#pragma omp simd
      for (int q = 0; q < 4; ++q) {
        double sum = 0.0;
        for (int d = 0; d < dim; ++d) {
          const double r = x[d] - sorted[d][s + q];
          sum += r * r;
        }
        d2[q] = sum;
      }
      // Written before it is known to count: a branch here would be taken one time in two.
      for (int q = 0; q < 4; ++q) {
        index[count] = number[s + q];
        distance2[count] = d2[q];
        count += static_cast<int>(d2[q] < radius2) & static_cast<int>(s + q < last);
      }
    }
  }
  /// Takes one point out of those found from `first` on, if it is there.
  void remove(std::int32_t point, std::size_t first) {
    for (std::size_t k = first; k < count; ++k)
      if (index[k] == point) {
        --count;
        index[k] = index[count];
        distance2[k] = distance2[count];
        return;
      }
  }
};

/// Factor and value of the kernel at those found. A square root takes as long in wide registers as
/// in narrow ones, so it is compiled for each width (-ffp-contract=off keeps the bits the same).
template <int dim>
[[gnu::target_clones("default", "avx2", "avx512f")]] void evaluate(const Kernel<dim> kernel,
                                                                   double volume,
                                                                   Found<dim>& found) {
  const std::size_t n = found.count;
  for (std::size_t k = 0; k < n; ++k) {
    const double r = std::sqrt(found.distance2[k]);
    found.factor[k] = kernel.gradient_factor(r);
    found.value[k] = volume * kernel.value(r);
  }
}

/// Cells of half the radius: five rows of five hold fewer points that are too far than three rows
/// of three.
constexpr int reach = 2;

/// The rows of cells about a place that come closer to it than the radius, each cut to the cells
/// that do.
template <int dim>
class RowsAbout {
 public:
  explicit RowsAbout(const CellGrid<dim>& grid) : grid_(grid) {
    for (int k = 0; k < all; ++k)
      step_[k] = grid.extent[0] *
                 (dim == 2 ? k - reach : k / rows - reach + grid.extent[1] * (k % rows - reach));
  }
  /// Calls visit(first cell, last cell, whether it is the place's own row).
  template <typename Visit>
  void for_each(const Vector<dim>& x, Visit&& visit) const {
    // In cells and in single precision from here on; the radius is taken a little too large, so
    // that rounding loses no cell.
    constexpr float radius2 = reach * reach * 1.0001f;
    std::array<int, dim> c;
    std::array<float, dim> in_cell;
    for (int d = 0; d < dim; ++d) {
      // A place far off the grid is as good as one that is just too far from every cell.
      const double place = std::clamp((x[d] - grid_.origin[d]) * grid_.inverse_cell, -1.0 - reach,
                                      grid_.extent[d] + 1.0 + reach);
      c[d] = static_cast<int>(std::floor(place));
      in_cell[d] = static_cast<float>(place - c[d]);
    }
    // Squared distance of x from the slabs of cells along each axis; infinite where there are none.
    std::array<std::array<float, rows>, dim> gap2;
    for (int d = 1; d < dim; ++d)
      for (int k = 0; k < rows; ++k) {
        const int step = k - reach;
        const float gap = step == 0 ? 0.0f : in_cell[d] - step - (step < 0 ? 1 : 0);
        gap2[d][k] = gap * gap;
        if (c[d] + step < 0 || c[d] + step >= grid_.extent[d])
          gap2[d][k] = std::numeric_limits<float>::infinity();
      }
    // Squared distance of x from each row, and the cells that half the row's chord reaches on both
    // sides, in loops without branches.
    std::array<float, all> off2;
    std::array<int, all> first, last;
    for (int k = 0; k < all; ++k)
      off2[k] = dim == 2 ? gap2[1][k] : gap2[1][k / rows] + gap2[dim - 1][k % rows];
    const int own = grid_.number(c), to_first = -c[0], to_last = grid_.extent[0] - 1 - c[0];
    for (int k = 0; k < all; ++k) {
      const float half = std::sqrt(std::max(radius2 - off2[k], 0.0f));
      // Rounded down by the conversion, of numbers that are not negative.
      constexpr int up = reach + 1;
      const int low = static_cast<int>(in_cell[0] - half + up) - up;
      const int high = static_cast<int>(in_cell[0] + half);
      first[k] = own + step_[k] + std::clamp(low, to_first, to_last);
      last[k] = own + step_[k] + std::clamp(high, to_first, to_last);
    }
    for (int k = 0; k < all; ++k)
      if (off2[k] < radius2) visit(first[k], last[k], k == all / 2);
  }

 private:
  static constexpr int rows = 2 * reach + 1;
  static constexpr int all = dim == 2 ? rows : rows * rows;
  const CellGrid<dim>& grid_;
  std::array<int, all> step_;  ///< from the own row to each, in numbers of cells
};

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

namespace {

/// Writes what was found as a list of five parts: part p holds the indices from limit[p-1] on that
/// are below limit[p]. Returns the sum of V W.
template <bool weighted, int dim>
double distribute(Found<dim>& found, const std::array<std::int32_t, 4>& limit,
                  std::span<const double> weights, SupportEnds& ends, std::int32_t* index,
                  double* factor) {
  // The next place of each part stands in its own bits of one register: in memory each neighbour
  // would wait until the place that the one before has moved on is written and read again.
  constexpr int bits = 12;
  static_assert(Found<dim>::room < 1 << bits && 5 * bits <= 64);
  const std::size_t n = found.count;
  std::array<std::int32_t, 4> below{};
  for (std::size_t k = 0; k < n; ++k) {
    std::int32_t part = 0;
    for (int p = 0; p < 4; ++p) {
      below[p] += found.index[k] < limit[p];
      part += found.index[k] >= limit[p];
    }
    found.shift[k] = bits * part;
  }
  ends = {below[0], below[1], below[2], below[3], static_cast<std::int32_t>(n)};
  std::uint64_t place = 0;
  for (int p = 0; p < 4; ++p) place |= static_cast<std::uint64_t>(below[p]) << (bits * (p + 1));
  double sum = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const int shift = found.shift[k];
    const std::size_t to = place >> shift & ((1u << bits) - 1);
    place += std::uint64_t{1} << shift;
    const std::int32_t j = found.index[k];
    index[to] = j;
    factor[to] = weighted ? weights[j] * found.factor[k] : found.factor[k];
    sum += weighted ? weights[j] * found.value[k] : found.value[k];
  }
  return sum;
}

}  // namespace

/// `centres` are the first points, or places of their own.
template <int dim>
void Support<dim>::collect(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
                           std::span<const Vector<dim>> points, double volume,
                           std::span<const double> weights) {
  const double radius = kernel.support_radius();
  // A tenth more than on the lattice, on average over a chunk, is room for nearly all; half as many
  // again is more than any sound distribution has.
  const double on_lattice = lattice_neighbours<dim>(radius, volume);
  const std::size_t usual = chunk * static_cast<std::size_t>(4.0 + 1.1 * on_lattice);
  const std::size_t most = chunk * static_cast<std::size_t>(16.0 + 1.5 * on_lattice);
  chunk_capacity_ = std::max(chunk_capacity_, usual);
  sort_into_cells(points, radius / reach);
  while (!fill(kernel, centres, points, volume, weights)) {
    if (chunk_capacity_ >= most)
      throw std::runtime_error(
          "a particle has more than " + std::to_string(most_neighbours<dim>) +
          " neighbours, or a region half as many again as it should: particles have clumped; use "
          "shifting or a smaller time step");
    chunk_capacity_ = most;
  }
}

/// The lists of all centres, from the points in their cells; false where there is no room for them.
template <int dim>
bool Support<dim>::fill(const Kernel<dim>& kernel, std::span<const Vector<dim>> centres,
                        std::span<const Vector<dim>> points, double volume,
                        std::span<const double> weights) {
  const std::size_t all = centres.size();
  const auto owners = static_cast<std::int32_t>(centres.data() == points.data() ? all : 0);
  const double radius = kernel.support_radius();
  reserve(all);
  const CellGrid<dim> grid(points, radius / reach);
  const RowsAbout<dim> rows_about(grid);

  const double radius2 = radius * radius;
  const double own_value = owners > 0 ? volume * kernel.value(0.0) : 0.0;
  const auto chunks = static_cast<std::ptrdiff_t>((all + chunk - 1) / chunk);
  bool overfull = false;
#pragma omp parallel for schedule(dynamic, 1) reduction(|| : overfull)
  for (std::ptrdiff_t chunk_number = 0; chunk_number < chunks; ++chunk_number) {
    Found<dim> found;
    std::size_t write = chunk_number * chunk_capacity_;
    const std::size_t room = write + chunk_capacity_;
    const std::size_t end = std::min(all, (chunk_number + 1) * chunk);
    for (std::size_t i = chunk_number * chunk; i < end; ++i) {
      const std::int32_t self = owners > 0 ? static_cast<std::int32_t>(i) : -1;
      found.count = 0;
      rows_about.for_each(centres[i], [&](int first_cell, int last_cell, bool own_row) {
        const std::size_t before = found.count;
        found.add_row(sorted_, sorted_index_.data(), cell_begin_[first_cell],
                      cell_begin_[last_cell + 1], centres[i], radius2);
        if (own_row && self >= 0) found.remove(self, before);
      });
      if (write + found.count > room) {
        found.overfull = true;
        found.count = 0;
      }
      evaluate(kernel, volume, found);
      const auto block_first = static_cast<std::int32_t>(i - i % support_block);
      const std::array<std::int32_t, 4> limit{
          std::min(block_first, owners), self,
          std::min(block_first + static_cast<std::int32_t>(support_block), owners), owners};
      first_[i] = write;
      const auto write_list = weights.empty() ? distribute<false, dim> : distribute<true, dim>;
      partition_[i] =
          own_value + write_list(found, limit, weights, ends_[i], &index_[write], &factor_[write]);
      write += found.count;
    }
    overfull = overfull || found.overfull;
  }
  return !overfull;
}

template class Support<2>;
template class Support<3>;

}  // namespace sprung::sph
