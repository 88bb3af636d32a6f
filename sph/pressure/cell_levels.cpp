#include "sph/pressure/cell_levels.hpp"

#include "sph/counting_sort.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sprung::sph {

namespace {

/// Grids of at most this many cells are solved directly: up to here CHOLMOD's factors cost less
/// than the iterations that further levels would add.
constexpr std::size_t largest_direct = 4000;

/// Piecewise constant functions make the next level's matrix too stiff for smooth errors, by a
/// factor that tends to 2 for cells halved in each direction; its correction is scaled up by a
/// little less (over-correction, Braess 1995).
constexpr double over_correction = 1.7;

std::array<std::int32_t, 3> coordinates(const std::array<std::int32_t, 3>& extent,
                                        std::int32_t cell) {
  return {cell % extent[0], cell / extent[0] % extent[1], cell / (extent[0] * extent[1])};
}

}  // namespace

template <int dim>
void CellMap::assign(std::span<const Vector<dim>> positions, const Vector<dim>& origin,
                     const Vector<dim>& inverse_cell) {
  cell_of.resize(positions.size());
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::int32_t number = 0;
    for (int d = dim - 1; d >= 0; --d) {
      const auto c =
          static_cast<std::int32_t>(std::floor((positions[i][d] - origin[d]) * inverse_cell[d]));
      number = number * extent[d] + std::clamp(c, 0, extent[d] - 1);
    }
    cell_of[i] = number;
  }
}

template void CellMap::assign<2>(std::span<const Vector<2>>, const Vector<2>&, const Vector<2>&);
template void CellMap::assign<3>(std::span<const Vector<3>>, const Vector<3>&, const Vector<3>&);

/// The place of `to` among the neighbours of `from`, by the steps -1, 0, 1 along each axis.
int CellLevels::slot(const Level& level, std::int32_t from, std::int32_t to) {
  const auto& a = level.place[from];
  const auto& b = level.place[to];
  int slot = 0;
  const int axes = level.slots == 9 ? 2 : 3;
  for (int d = axes - 1; d >= 0; --d) {
    std::int32_t step = b[d] - a[d];
    if (level.periodic[d] && (step > 1 || step < -1))
      step += step > 0 ? -level.extent[d] : level.extent[d];
    slot = 3 * slot + step + 1;
  }
  return slot;
}

void CellLevels::lay_out(Level& level, int dimension) const {
  level.slots = dimension == 2 ? 9 : 27;
  const std::int32_t cells = level.extent[0] * level.extent[1] * level.extent[2];
  level.neighbour.resize(static_cast<std::size_t>(cells) * level.slots);
  level.parent.resize(cells);
  level.place.resize(cells);
  std::array<std::int32_t, 3> coarse;
  for (int d = 0; d < 3; ++d) coarse[d] = (level.extent[d] + 1) / 2;
  for (std::int32_t c = 0; c < cells; ++c) {
    const auto at = level.place[c] = coordinates(level.extent, c);
    level.parent[c] = at[0] / 2 + coarse[0] * (at[1] / 2 + coarse[1] * (at[2] / 2));
    for (int s = 0; s < level.slots; ++s) {
      const std::array<int, 3> step{s % 3 - 1, s / 3 % 3 - 1, dimension == 3 ? s / 9 - 1 : 0};
      std::array<std::int32_t, 3> to;
      bool there = true;
      for (int d = 0; d < 3; ++d) {
        to[d] = at[d] + step[d];
        if (level.periodic[d]) to[d] = (to[d] + level.extent[d]) % level.extent[d];
        there = there && to[d] >= 0 && to[d] < level.extent[d];
      }
      level.neighbour[static_cast<std::size_t>(c) * level.slots + s] =
          there ? to[0] + level.extent[0] * (to[1] + level.extent[1] * to[2]) : c;
    }
  }
}

void CellLevels::build(const PressureMatrix& matrix, const CellMap& map) {
  if (levels_.empty() || laid_out_ != map.extent || levels_[0].periodic != map.periodic) {
    laid_out_ = map.extent;
    levels_.clear();
    const int dimension = map.extent[2] > 1 || map.periodic[2] ? 3 : 2;
    auto extent = map.extent;
    while (true) {
      Level& level = levels_.emplace_back();
      level.extent = extent;
      level.periodic = map.periodic;
      lay_out(level, dimension);
      if (level.cells() <= largest_direct) break;
      for (auto& e : extent) e = (e + 1) / 2;
    }
    last_.resize(0, 0);
  }
  for (auto& level : levels_) level.coefficient.assign(level.neighbour.size(), 0.0);
  collect_pairs(matrix, map);
  for (std::size_t l = 1; l < levels_.size(); ++l) coarsen(levels_[l - 1], levels_[l]);
  for (auto& level : levels_) {
    level.residual.resize(level.cells());
    level.correction.resize(level.cells());
    // An empty cell stands alone.
    const int self = level.slots / 2;
    for (std::size_t c = 0; c < level.cells(); ++c) {
      double& diagonal = level.coefficient[c * level.slots + self];
      if (!(diagonal > 0.0)) diagonal = 1.0;
    }
  }
  factorise(matrix.singular());
}

/// Each cell sums the rows of its own particles, so that threads never meet: of each pair only the
/// entry above the diagonal, the other half by symmetry.
void CellLevels::collect_pairs(const PressureMatrix& matrix, const CellMap& map) {
  Level& level = levels_[0];
  const std::size_t n = matrix.rows();
  member_.resize(n);
  counting_sort(map.cell_of, level.cells(), begin_, [&](std::size_t i, std::int32_t place) {
    member_[place] = static_cast<std::int32_t>(i);
  });
  upper_.assign(level.coefficient.size(), 0.0);
  const int slots = level.slots, self = slots / 2;
  const auto cells = static_cast<std::ptrdiff_t>(level.cells());
#pragma omp parallel
  {
    // Of the cells about the one at work: their place among its neighbours.
    std::vector<std::int8_t> slot_of(level.cells());
#pragma omp for schedule(dynamic, 64)
    for (std::ptrdiff_t c = 0; c < cells; ++c) {
      const std::size_t first = static_cast<std::size_t>(c) * slots;
      double* const row = &upper_[first];
      // Where there is no neighbour its entry names the cell itself, whose own slot comes last.
      for (int s = 0; s < slots; ++s)
        slot_of[level.neighbour[first + s]] = static_cast<std::int8_t>(s);
      slot_of[c] = static_cast<std::int8_t>(self);
      // Four sums in turn, since most pairs have the slot of the one before.
      std::array<std::array<double, 32>, 4> part{};
      std::size_t turn = 0;
      for (std::int32_t m = begin_[c]; m < begin_[c + 1]; ++m) {
        if (static_cast<std::size_t>(m) + 2 < n) matrix.prefetch_upper(member_[m + 2]);
        row[self] += 0.5 * matrix.diagonal()[member_[m]];
        matrix.for_each_upper(member_[m], [&](std::int32_t j, double a) {
          part[turn++ % 4][slot_of[map.cell_of[j]]] += a;
        });
      }
      for (int s = 0; s < slots; ++s)
        row[s] -= (part[0][s] + part[1][s]) + (part[2][s] + part[3][s]);
    }
#pragma omp for schedule(static)
    for (std::ptrdiff_t c = 0; c < cells; ++c)
      for (int s = 0; s < slots; ++s) {
        const std::size_t at = static_cast<std::size_t>(c) * slots + s;
        const std::size_t other = level.neighbour[at];
        if (s != self && other == static_cast<std::size_t>(c)) continue;
        level.coefficient[at] = upper_[at] + upper_[other * slots + (slots - 1 - s)];
      }
  }
}

void CellLevels::coarsen(const Level& fine, Level& coarse) const {
  for (std::size_t c = 0; c < fine.cells(); ++c)
    for (int s = 0; s < fine.slots; ++s) {
      const double a = fine.coefficient[c * fine.slots + s];
      if (a == 0.0) continue;
      const std::int32_t from = fine.parent[c];
      const std::int32_t to = fine.parent[fine.neighbour[c * fine.slots + s]];
      coarse.coefficient[static_cast<std::size_t>(from) * coarse.slots + slot(coarse, from, to)] +=
          a;
    }
}

void CellLevels::factorise(bool singular) {
  const Level& level = levels_.back();
  const auto cells = static_cast<std::int32_t>(level.cells());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(level.coefficient.size() / 2 + cells);
  for (std::int32_t c = 0; c < cells; ++c)
    for (int s = 0; s < level.slots; ++s) {
      const std::size_t at = static_cast<std::size_t>(c) * level.slots + s;
      const std::int32_t other = level.neighbour[at];
      const double a = level.coefficient[at];
      if (s == level.slots / 2) {
        // A pure Neumann problem is made definite by a slight shift.
        entries.emplace_back(c, c, singular ? a * (1.0 + 1e-6) : a);
      } else if (other < c) {
        entries.emplace_back(c, other, a);  // only the lower triangle is kept
      }
    }
  const bool first = last_.rows() != cells;
  last_.resize(cells, cells);
  last_.setFromTriplets(entries.begin(), entries.end());
  // The pattern is the grid's: analysed once.
  if (first) factor_.analyzePattern(last_);
  factor_.factorize(last_);
  if (factor_.info() != Eigen::Success)
    throw std::runtime_error(
        "the coarse pressure matrix is not positive definite: particles overlap or have left the "
        "domain");
}

void CellLevels::cycle(std::size_t l) {
  Level& level = levels_[l];
  const std::size_t n = level.cells();
  if (l + 1 == levels_.size()) {
    right_ = Eigen::Map<const Eigen::VectorXd>(level.residual.data(), static_cast<long>(n));
    solution_ = factor_.solve(right_);
    std::copy(solution_.data(), solution_.data() + n, level.correction.begin());
    return;
  }
  const int slots = level.slots, self = slots / 2;
  auto& x = level.correction;
  const auto& b = level.residual;
  const auto row_sum = [&](std::size_t c) {
    const double* const a = &level.coefficient[c * slots];
    const std::int32_t* const j = &level.neighbour[c * slots];
    double sum = 0.0;
    for (int s = 0; s < slots; ++s)
      if (s != self) sum += a[s] * x[j[s]];
    return sum;
  };
  std::fill(x.begin(), x.end(), 0.0);
  for (std::size_t c = 0; c < n; ++c)
    x[c] = (b[c] - row_sum(c)) / level.coefficient[c * slots + self];
  Level& next = levels_[l + 1];
  std::fill(next.residual.begin(), next.residual.end(), 0.0);
  for (std::size_t c = 0; c < n; ++c)
    next.residual[level.parent[c]] +=
        b[c] - row_sum(c) - level.coefficient[c * slots + self] * x[c];
  cycle(l + 1);
  for (std::size_t c = 0; c < n; ++c) x[c] += over_correction * next.correction[level.parent[c]];
  for (std::size_t c = n; c-- > 0;)
    x[c] = (b[c] - row_sum(c)) / level.coefficient[c * slots + self];
}

void CellLevels::solve(const std::vector<double>& residual, std::vector<double>& correction) {
  levels_[0].residual = residual;
  cycle(0);
  correction = levels_[0].correction;
}

}  // namespace sprung::sph
