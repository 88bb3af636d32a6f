#pragma once
/// Coarse levels of the pressure equation: functions that are constant on cubic cells of particles,
/// then on blocks of 2^dim such cells, and so on, down to a grid that CHOLMOD solves directly.

#include "sph/pressure/matrix.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCore>

#include <array>
#include <vector>

namespace sprung::sph {

/// Which cell each unknown lies in. Cells are numbered with x running fastest; a pair of particles
/// never reaches past the next cell.
struct CellMap {
  std::array<std::int32_t, 3> extent{1, 1, 1};
  std::array<bool, 3> periodic{};
  std::vector<std::int32_t> cell_of;
  std::int32_t cells() const { return extent[0] * extent[1] * extent[2]; }
  /// Fills cell_of for `positions`: cell d of a place is (x_d - origin_d) inverse_cell_d, places
  /// outside the grid belonging to its outermost cells. extent is set before.
  template <int dim>
  void assign(std::span<const Vector<dim>> positions, const Vector<dim>& origin,
              const Vector<dim>& inverse_cell);
};

class CellLevels {
 public:
  /// Galerkin matrices of all levels, and the factors of the last.
  void build(const PressureMatrix& matrix, const CellMap& map);
  /// One V-cycle: `correction` (one per cell) for the residual summed over each cell. Symmetric and
  /// positive definite as a map.
  void solve(const std::vector<double>& residual, std::vector<double>& correction);

 private:
  struct Level {
    std::array<std::int32_t, 3> extent;
    std::array<bool, 3> periodic;
    int slots;                                       ///< 3^dim: a cell and its neighbours
    std::vector<std::array<std::int32_t, 3>> place;  ///< [cell], its coordinates
    std::vector<std::int32_t> neighbour;  ///< [cell][slot], the cell itself where there is none
    std::vector<double> coefficient;      ///< [cell][slot], 0 where there is none
    std::vector<std::int32_t> parent;     ///< cell of the next level
    std::vector<double> residual, correction;
    std::size_t cells() const { return parent.size(); }
  };
  void lay_out(Level& level, int dimension) const;
  void collect_pairs(const PressureMatrix& matrix, const CellMap& map);
  void coarsen(const Level& fine, Level& coarse) const;
  void factorise(bool singular);
  void cycle(std::size_t level);
  static int slot(const Level& level, std::int32_t from, std::int32_t to);

  std::vector<Level> levels_;
  std::array<std::int32_t, 3> laid_out_{};
  std::vector<std::int32_t> begin_, member_;  ///< particles of each cell
  std::vector<double> upper_;  ///< [cell][slot], the pairs' entries above the diagonal
  Eigen::SparseMatrix<double> last_;
  Eigen::CholmodSimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
  Eigen::VectorXd right_, solution_;
};

}  // namespace sprung::sph
