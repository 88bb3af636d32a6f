#pragma once
/// The discrete space: Q_k velocities and displacements, continuous over the whole plane, and
/// pressures that are polynomials of degree k-1 in each cell, discontinuous. The pair is stable
/// (inf-sup), conserves mass cell by cell, and lets the pressure jump where fluid meets solid. All
/// integrals are taken over the reference configuration, whose shape functions and weights are
/// tabulated here once.

#include "reference_fem/mesh.hpp"
#include "scene/problem.hpp"

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/grid/tria.h>

#include <array>
#include <vector>

namespace sprung::reference {

using Vec2 = std::array<double, 2>;

/// One side of a cell on the boundary of the plane, with its own quadrature.
struct BoundaryFace {
  int cell = 0;
  unsigned boundary = 0;       ///< a Side, free_id, or an obstacle
  std::vector<double> value;   ///< [q][a]
  std::vector<double> grad_x;  ///< [q][a], 1/m
  std::vector<double> grad_y;
  std::vector<Vec2> normal_weight;  ///< [q], outward normal times ds (m)
  std::vector<Vec2> point;          ///< [q], m
};

class Space {
 public:
  /// Tabulates `mesh` with elements of `degree` 2 or 3. The mesh must outlive the space.
  Space(const dealii::Triangulation<2>& mesh, int degree);

  int degree() const { return degree_; }
  int cells() const { return static_cast<int>(body_.size()); }
  int nodes() const { return static_cast<int>(position_.size()); }
  int nodes_per_cell() const { return nodes_per_cell_; }
  int points_per_cell() const { return points_per_cell_; }
  int pressures_per_cell() const { return pressures_per_cell_; }
  /// 0: fluid; i + 1: Problem::solids[i].
  int body(int cell) const { return body_[static_cast<std::size_t>(cell)]; }
  const int* cell_nodes(int cell) const { return &cell_nodes_[index(cell, nodes_per_cell_)]; }
  const Vec2& position(int node) const { return position_[static_cast<std::size_t>(node)]; }

  const double* value(int q) const { return &value_[index(q, nodes_per_cell_)]; }
  const double* grad_x(int cell) const {
    return &grad_x_[index(cell, points_per_cell_ * nodes_per_cell_)];
  }
  const double* grad_y(int cell) const {
    return &grad_y_[index(cell, points_per_cell_ * nodes_per_cell_)];
  }
  const double* weight(int cell) const { return &weight_[index(cell, points_per_cell_)]; }
  const double* pressure_value(int cell) const {
    return &pressure_value_[index(cell, points_per_cell_ * pressures_per_cell_)];
  }
  const std::vector<BoundaryFace>& boundary() const { return boundary_; }

  bool in_fluid(int node) const { return in_fluid_[static_cast<std::size_t>(node)] != 0; }
  bool in_solid(int node) const { return solid_of_[static_cast<std::size_t>(node)] != 0; }
  /// Body of the solid cells around a node; 0 if there are none.
  int solid_of(int node) const { return solid_of_[static_cast<std::size_t>(node)]; }
  bool on_side(int node, Side side) const { return on_boundary(node, static_cast<unsigned>(side)); }
  bool on_obstacle(int node) const {
    return boundaries_[static_cast<std::size_t>(node)] >> obstacle_id != 0;
  }
  /// On the rim of Problem::curved_walls[wall].
  bool on_obstacle(int node, int wall) const {
    return on_boundary(node, obstacle_id + static_cast<unsigned>(wall));
  }
  bool on_any_boundary(int node) const { return boundaries_[static_cast<std::size_t>(node)] != 0; }

  /// Values of a cell's shape functions at a point of the unit square.
  void shape_values(const Vec2& unit, double* values) const;
  void shape_gradients(const Vec2& unit, double* d_xi, double* d_eta) const;
  /// Values of a cell's pressure modes at a reference position (m).
  void pressure_values(int cell, const Vec2& position, double* values) const;
  const dealii::FE_Q<2>& element() const { return fe_; }
  /// Unit coordinates of the element's nodes, in the order of cell_nodes.
  const std::vector<dealii::Point<2>>& unit_nodes() const { return fe_.get_unit_support_points(); }

 private:
  static std::size_t index(int i, int stride) {
    return static_cast<std::size_t>(i) * static_cast<std::size_t>(stride);
  }
  bool on_boundary(int node, unsigned boundary) const {
    return (boundaries_[static_cast<std::size_t>(node)] >> boundary & 1U) != 0;
  }
  void tabulate_cells();
  void tabulate_boundary();

  int degree_;
  dealii::FE_Q<2> fe_;
  dealii::DoFHandler<2> dofs_;
  int nodes_per_cell_, points_per_cell_, pressures_per_cell_;
  std::vector<int> body_, cell_nodes_, solid_of_;
  std::vector<unsigned> boundaries_;  ///< per node: one bit per boundary id
  std::vector<char> in_fluid_;
  std::vector<Vec2> position_, center_;
  std::vector<double> size_;
  std::vector<double> value_, grad_x_, grad_y_, weight_, pressure_value_;
  std::vector<BoundaryFace> boundary_;
};

/// Where a point lies in a configuration: the cell and its unit coordinates.
struct Place {
  int cell = -1;  ///< -1: outside every cell
  Vec2 unit{};
};

/// Finds points in the configuration X + displacement (displacement interleaved per node, m).
class Locator {
 public:
  Locator(const Space& space, const std::vector<double>& displacement);
  /// `body` >= 0 looks only in cells of that body.
  Place find(const Vec2& point, int body = -1) const;
  /// Every cell that the point lies in: several at a vertex or an edge.
  std::vector<Place> find_all(const Vec2& point) const;

 private:
  bool invert(int cell, const Vec2& point, Vec2& unit) const;
  const Space* space_;
  std::vector<double> x_;                      ///< current positions, interleaved
  std::vector<std::array<double, 4>> bounds_;  ///< per cell: min x, min y, max x, max y
};

/// Mean over `places` of the cells' own pressures there (Pa); they jump from cell to cell.
double evaluate_pressure(const Space& space, const std::vector<double>& pressure,
                         const std::vector<Place>& places);

/// Value of a nodal vector field (interleaved) at a place.
Vec2 evaluate(const Space& space, const std::vector<double>& field, const Place& place);

}  // namespace sprung::reference
