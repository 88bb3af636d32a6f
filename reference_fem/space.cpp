#include "reference_fem/space.hpp"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q.h>

#include <algorithm>
#include <cmath>

namespace sprung::reference {

Space::Space(const dealii::Triangulation<2>& mesh, int degree)
    : degree_(degree),
      fe_(static_cast<unsigned>(degree)),
      dofs_(mesh),
      nodes_per_cell_((degree + 1) * (degree + 1)),
      points_per_cell_((degree + 1) * (degree + 1)),
      pressures_per_cell_(degree * (degree + 1) / 2) {
  dofs_.distribute_dofs(fe_);
  position_.resize(dofs_.n_dofs());
  in_fluid_.assign(dofs_.n_dofs(), 0);
  solid_of_.assign(dofs_.n_dofs(), 0);
  boundaries_.assign(dofs_.n_dofs(), 0);
  tabulate_cells();
  tabulate_boundary();
}

void Space::tabulate_cells() {
  const dealii::MappingQ<2> mapping(static_cast<unsigned>(degree_));
  const dealii::QGauss<2> quadrature(static_cast<unsigned>(degree_ + 1));
  dealii::FEValues<2> shape(mapping, fe_, quadrature,
                            dealii::update_values | dealii::update_gradients |
                                dealii::update_JxW_values | dealii::update_quadrature_points);
  const dealii::Quadrature<2> node_points(fe_.get_unit_support_points());
  dealii::FEValues<2> at_nodes(mapping, fe_, node_points, dealii::update_quadrature_points);
  std::vector<dealii::types::global_dof_index> indices(fe_.n_dofs_per_cell());
  std::vector<double> modes(static_cast<std::size_t>(pressures_per_cell_));
  for (const auto& cell : dofs_.active_cell_iterators()) {
    shape.reinit(cell);
    at_nodes.reinit(cell);
    cell->get_dof_indices(indices);
    const int number = cells();
    body_.push_back(static_cast<int>(cell->material_id()));
    center_.push_back({cell->center()[0], cell->center()[1]});
    size_.push_back(std::sqrt(cell->measure()));
    for (unsigned a = 0; a < indices.size(); ++a) {
      const std::size_t node = indices[a];
      cell_nodes_.push_back(static_cast<int>(node));
      position_[node] = {at_nodes.quadrature_point(a)[0], at_nodes.quadrature_point(a)[1]};
      if (body_.back() == 0)
        in_fluid_[node] = 1;
      else
        solid_of_[node] = body_.back();
    }
    for (unsigned q = 0; q < quadrature.size(); ++q) {
      weight_.push_back(shape.JxW(q));
      for (unsigned a = 0; a < indices.size(); ++a) {
        if (number == 0) value_.push_back(shape.shape_value(a, q));
        grad_x_.push_back(shape.shape_grad(a, q)[0]);
        grad_y_.push_back(shape.shape_grad(a, q)[1]);
      }
      pressure_values(number, {shape.quadrature_point(q)[0], shape.quadrature_point(q)[1]},
                      modes.data());
      pressure_value_.insert(pressure_value_.end(), modes.begin(), modes.end());
    }
  }
}

void Space::tabulate_boundary() {
  const dealii::MappingQ<2> mapping(static_cast<unsigned>(degree_));
  const dealii::QGauss<1> quadrature(static_cast<unsigned>(degree_ + 1));
  dealii::FEFaceValues<2> shape(mapping, fe_, quadrature,
                                dealii::update_values | dealii::update_gradients |
                                    dealii::update_JxW_values | dealii::update_normal_vectors |
                                    dealii::update_quadrature_points);
  int number = 0;
  for (const auto& cell : dofs_.active_cell_iterators()) {
    for (unsigned f = 0; f < 4; ++f) {
      if (!cell->face(f)->at_boundary()) continue;
      shape.reinit(cell, f);
      BoundaryFace face;
      face.cell = number;
      face.boundary = cell->face(f)->boundary_id();
      for (unsigned q = 0; q < quadrature.size(); ++q) {
        const auto n = shape.normal_vector(q);
        face.normal_weight.push_back({n[0] * shape.JxW(q), n[1] * shape.JxW(q)});
        face.point.push_back({shape.quadrature_point(q)[0], shape.quadrature_point(q)[1]});
        for (unsigned a = 0; a < fe_.n_dofs_per_cell(); ++a) {
          face.value.push_back(shape.shape_value(a, q));
          face.grad_x.push_back(shape.shape_grad(a, q)[0]);
          face.grad_y.push_back(shape.shape_grad(a, q)[1]);
        }
      }
      for (unsigned a = 0; a < fe_.n_dofs_per_cell(); ++a)
        if (fe_.has_support_on_face(a, f))
          boundaries_[static_cast<std::size_t>(cell_nodes(number)[a])] |= 1U << face.boundary;
      boundary_.push_back(std::move(face));
    }
    ++number;
  }
}

void Space::shape_values(const Vec2& unit, double* values) const {
  for (unsigned a = 0; a < fe_.n_dofs_per_cell(); ++a)
    values[a] = fe_.shape_value(a, {unit[0], unit[1]});
}

void Space::shape_gradients(const Vec2& unit, double* d_xi, double* d_eta) const {
  for (unsigned a = 0; a < fe_.n_dofs_per_cell(); ++a) {
    const auto gradient = fe_.shape_grad(a, {unit[0], unit[1]});
    d_xi[a] = gradient[0];
    d_eta[a] = gradient[1];
  }
}

void Space::pressure_values(int cell, const Vec2& position, double* values) const {
  // Monomials in the undeformed coordinates, scaled by the cell: of full degree k-1 on any
  // quadrilateral.
  const auto c = static_cast<std::size_t>(cell);
  const double x = (position[0] - center_[c][0]) / size_[c],
               y = (position[1] - center_[c][1]) / size_[c];
  int mode = 0;
  for (int total = 0; total < degree_; ++total)
    for (int j = 0; j <= total; ++j) values[mode++] = std::pow(x, total - j) * std::pow(y, j);
}

Locator::Locator(const Space& space, const std::vector<double>& displacement)
    : space_(&space), x_(displacement) {
  for (int n = 0; n < space.nodes(); ++n) {
    x_[2 * static_cast<std::size_t>(n)] += space.position(n)[0];
    x_[2 * static_cast<std::size_t>(n) + 1] += space.position(n)[1];
  }
  for (int c = 0; c < space.cells(); ++c) {
    std::array<double, 4> box = {1e300, 1e300, -1e300, -1e300};
    for (int a = 0; a < space.nodes_per_cell(); ++a) {
      const auto n = 2 * static_cast<std::size_t>(space.cell_nodes(c)[a]);
      for (std::size_t d = 0; d < 2; ++d) {
        box[d] = std::min(box[d], x_[n + d]);
        box[2 + d] = std::max(box[2 + d], x_[n + d]);
      }
    }
    // A curved edge may bulge past its nodes.
    const double margin = 0.1 * std::max(box[2] - box[0], box[3] - box[1]);
    bounds_.push_back({box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin});
  }
}

Place Locator::find(const Vec2& point, int body) const {
  for (int c = 0; c < space_->cells(); ++c) {
    const auto& b = bounds_[static_cast<std::size_t>(c)];
    if (body >= 0 && space_->body(c) != body) continue;
    if (point[0] < b[0] || point[1] < b[1] || point[0] > b[2] || point[1] > b[3]) continue;
    Place place{c, {0.5, 0.5}};
    if (invert(c, point, place.unit)) return place;
  }
  return {};
}

std::vector<Place> Locator::find_all(const Vec2& point) const {
  std::vector<Place> places;
  for (int c = 0; c < space_->cells(); ++c) {
    const auto& b = bounds_[static_cast<std::size_t>(c)];
    if (point[0] < b[0] || point[1] < b[1] || point[0] > b[2] || point[1] > b[3]) continue;
    Place place{c, {0.5, 0.5}};
    if (invert(c, point, place.unit)) places.push_back(place);
  }
  return places;
}

bool Locator::invert(int cell, const Vec2& point, Vec2& unit) const {
  constexpr double inside = 1e-8;
  const int na = space_->nodes_per_cell();
  std::vector<double> n(static_cast<std::size_t>(na)), dx(n), dy(n);
  for (int iteration = 0; iteration < 30; ++iteration) {
    space_->shape_values(unit, n.data());
    space_->shape_gradients(unit, dx.data(), dy.data());
    double r[2] = {-point[0], -point[1]}, j[4] = {0, 0, 0, 0};
    for (int a = 0; a < na; ++a) {
      const auto node = 2 * static_cast<std::size_t>(space_->cell_nodes(cell)[a]);
      const auto i = static_cast<std::size_t>(a);
      for (std::size_t d = 0; d < 2; ++d) {
        r[d] += n[i] * x_[node + d];
        j[2 * d] += dx[i] * x_[node + d];
        j[2 * d + 1] += dy[i] * x_[node + d];
      }
    }
    const double det = j[0] * j[3] - j[1] * j[2];
    const double step[2] = {(j[3] * r[0] - j[1] * r[1]) / det, (j[0] * r[1] - j[2] * r[0]) / det};
    unit[0] -= step[0];
    unit[1] -= step[1];
    if (!(std::abs(unit[0] - 0.5) < 3 && std::abs(unit[1] - 0.5) < 3)) return false;
    if (std::max(std::abs(step[0]), std::abs(step[1])) < 1e-13) break;
  }
  return unit[0] > -inside && unit[0] < 1 + inside && unit[1] > -inside && unit[1] < 1 + inside;
}

double evaluate_pressure(const Space& space, const std::vector<double>& pressure,
                         const std::vector<Place>& places) {
  const auto na = static_cast<std::size_t>(space.nodes_per_cell()),
             np = static_cast<std::size_t>(space.pressures_per_cell());
  std::vector<double> n(na), modes(np);
  double sum = 0.0;
  for (const Place& place : places) {
    space.shape_values(place.unit, n.data());
    Vec2 x{};
    for (std::size_t a = 0; a < na; ++a)
      for (std::size_t d = 0; d < 2; ++d)
        x[d] += n[a] * space.position(space.cell_nodes(place.cell)[a])[d];
    space.pressure_values(place.cell, x, modes.data());
    for (std::size_t m = 0; m < np; ++m)
      sum += modes[m] * pressure[static_cast<std::size_t>(place.cell) * np + m];
  }
  return sum / static_cast<double>(places.size());
}

Vec2 evaluate(const Space& space, const std::vector<double>& field, const Place& place) {
  std::vector<double> n(static_cast<std::size_t>(space.nodes_per_cell()));
  space.shape_values(place.unit, n.data());
  Vec2 result{};
  for (int a = 0; a < space.nodes_per_cell(); ++a) {
    const auto node = 2 * static_cast<std::size_t>(space.cell_nodes(place.cell)[a]);
    for (std::size_t d = 0; d < 2; ++d)
      result[d] += n[static_cast<std::size_t>(a)] * field[node + d];
  }
  return result;
}

}  // namespace sprung::reference
