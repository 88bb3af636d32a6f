#include "reference_fem/mesh_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sprung::reference {

namespace {

/// Squared distance from a point to the nearest of `points`.
double nearest(const std::vector<Vec2>& points, const Vec2& x) {
  double best = std::numeric_limits<double>::max();
  for (const Vec2& p : points)
    best = std::min(best, (p[0] - x[0]) * (p[0] - x[0]) + (p[1] - x[1]) * (p[1] - x[1]));
  return best;
}

}  // namespace

MeshMotion::MeshMotion(const Space& space, double reach, double stiffening)
    : space_(&space), reach_(reach), stiffening_(stiffening) {
  unknown_.assign(static_cast<std::size_t>(space.nodes()), -1);
  for (int n = 0; n < space.nodes(); ++n) {
    if (space.in_fluid(n) && space.in_solid(n)) wetted_.push_back(space.position(n));
    if (space.in_fluid(n) && !space.in_solid(n) && !space.on_any_boundary(n)) {
      unknown_[static_cast<std::size_t>(n)] = size_;
      size_ += 2;
    }
  }
  cholmod_start(&cholmod_);
  if (wetted_.empty()) return;
  std::vector<std::map<int, double>> columns(static_cast<std::size_t>(size_));
  for (int c = 0; c < space.cells(); ++c)
    if (space.body(c) == 0) assemble(c, columns);
  factorize(columns);
}

void MeshMotion::assemble(int cell, std::vector<std::map<int, double>>& columns) {
  const int na = space_->nodes_per_cell(), nq = space_->points_per_cell();
  std::vector<double> weight;
  for (int q = 0; q < nq; ++q) {
    Vec2 x{};
    for (int a = 0; a < na; ++a)
      for (std::size_t d = 0; d < 2; ++d)
        x[d] += space_->value(q)[a] * space_->position(space_->cell_nodes(cell)[a])[d];
    const double s = nearest(wetted_, x) / (reach_ * reach_) + regularisation * regularisation;
    weight.push_back(space_->weight(cell)[q] * std::pow(s, -0.5 * stiffening_));
  }
  for (int a = 0; a < na; ++a) {
    const int row = unknown_[static_cast<std::size_t>(space_->cell_nodes(cell)[a])];
    if (row < 0) continue;
    for (int b = 0; b < na; ++b) {
      double k[4] = {0, 0, 0, 0};
      for (int q = 0; q < nq; ++q) {
        const double w = weight[static_cast<std::size_t>(q)];
        const double ax = space_->grad_x(cell)[q * na + a], ay = space_->grad_y(cell)[q * na + a];
        const double bx = space_->grad_x(cell)[q * na + b], by = space_->grad_y(cell)[q * na + b];
        const double same = ax * bx + ay * by;
        k[0] += w * (same + (1.0 + dilatation) * ax * bx);
        k[1] += w * (ay * bx + dilatation * ax * by);
        k[2] += w * (ax * by + dilatation * ay * bx);
        k[3] += w * (same + (1.0 + dilatation) * ay * by);
      }
      const int node = space_->cell_nodes(cell)[b];
      const int column = unknown_[static_cast<std::size_t>(node)];
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
          if (column >= 0)
            columns[static_cast<std::size_t>(column + j)][row + i] += k[2 * i + j];
          else if (space_->in_solid(node))
            coupling_.push_back({row + i, 2 * node + j, k[2 * i + j]});
        }
    }
  }
}

MeshMotion::~MeshMotion() {
  if (factor_ != nullptr) cholmod_free_factor(&factor_, &cholmod_);
  cholmod_finish(&cholmod_);
}

void MeshMotion::factorize(const std::vector<std::map<int, double>>& columns) {
  std::size_t entries = 0;
  for (const auto& column : columns) entries += column.size();
  const auto n = static_cast<std::size_t>(size_);
  // stype -1: the lower triangle stands for the whole; CHOLMOD ignores what lies above it.
  cholmod_sparse* matrix =
      cholmod_allocate_sparse(n, n, entries, 1, 1, -1, CHOLMOD_REAL, &cholmod_);
  if (matrix == nullptr) throw std::runtime_error("mesh motion: out of memory");
  int* start = static_cast<int*>(matrix->p);
  int* rows = static_cast<int*>(matrix->i);
  double* values = static_cast<double*>(matrix->x);
  int place = 0;
  for (std::size_t j = 0; j < n; ++j) {
    start[j] = place;
    for (const auto& [row, value] : columns[j]) {
      rows[place] = row;
      values[place++] = value;
    }
  }
  start[n] = place;
  factor_ = cholmod_analyze(matrix, &cholmod_);
  const bool done = factor_ != nullptr && cholmod_factorize(matrix, factor_, &cholmod_) != 0 &&
                    cholmod_.status == CHOLMOD_OK;
  cholmod_free_sparse(&matrix, &cholmod_);
  if (!done) throw std::runtime_error("mesh motion: CHOLMOD could not factorise the extension");
}

void MeshMotion::extend(std::vector<double>& field) const {
  const auto n = static_cast<std::size_t>(size_);
  std::vector<double> right(n, 0.0);
  for (const Coupling& k : coupling_)
    right[static_cast<std::size_t>(k.row)] -=
        k.value * field[static_cast<std::size_t>(k.component)];
  cholmod_dense* solution = nullptr;
  if (factor_ != nullptr) {
    cholmod_dense b{};
    b.nrow = b.d = b.nzmax = n;
    b.ncol = 1;
    b.x = right.data();
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    solution = cholmod_solve(CHOLMOD_A, factor_, &b, &cholmod_);
    if (solution == nullptr) throw std::runtime_error("mesh motion: CHOLMOD could not solve");
  }
  const double* x = solution == nullptr ? right.data() : static_cast<const double*>(solution->x);
  for (std::size_t node = 0; node < unknown_.size(); ++node)
    for (std::size_t d = 0; d < 2; ++d) {
      if (unknown_[node] >= 0)
        field[2 * node + d] = x[static_cast<std::size_t>(unknown_[node]) + d];
      else if (!space_->in_solid(static_cast<int>(node)))
        field[2 * node + d] = 0.0;
    }
  if (solution != nullptr) cholmod_free_dense(&solution, &cholmod_);
}

}  // namespace sprung::reference
