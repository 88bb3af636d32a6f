#include "turek_hron.hpp"

#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace sprung::reference::testing {
namespace {

using Point2 = dealii::Point<2>;

constexpr double length = 2.5, height = 0.41, radius = 0.05, half_flag = 0.01, flag_end = 0.6;
const Point2 center(0.2, 0.2);

/// Cells of a patch given by a map of the unit square, `nx` by `ny` of them; vertices that fall
/// together with earlier ones are shared.
class Patches {
 public:
  using Map = std::function<Point2(double, double)>;
  void add(const Map& map, int nx, int ny, unsigned material) {
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        dealii::CellData<2> cell;
        for (int v = 0; v < 4; ++v)
          cell.vertices[static_cast<std::size_t>(v)] =
              vertex(map(static_cast<double>(i + v % 2) / nx, static_cast<double>(j + v / 2) / ny));
        cell.material_id = material;
        cells.push_back(cell);
      }
  }
  std::vector<Point2> vertices;
  std::vector<dealii::CellData<2>> cells;

 private:
  unsigned vertex(const Point2& p) {
    const auto key = std::array{std::lround(p[0] * 1e8), std::lround(p[1] * 1e8)};
    const auto [place, is_new] = number_.try_emplace(key, static_cast<unsigned>(vertices.size()));
    if (is_new) vertices.push_back(p);
    return place->second;
  }
  std::map<std::array<long, 2>, unsigned> number_;
};

/// Distribution of points over the unit interval.
using Grading = double (*)(double);
double even(double s) {
  return s;
}
double fine_first(double s) {
  return std::pow(s, 1.6);
}
double fine_last(double s) {
  return 1.0 - std::pow(1.0 - s, 1.6);
}
double very_fine_first(double s) {
  return std::pow(s, 2.0);
}
/// Finer at the cylinder.
double radial(double t) {
  return t * (0.7 + 0.3 * t);
}

Patches::Map rectangle(double x0, double x1, double y0, double y1, Grading x = even,
                       Grading y = even) {
  return [=](double s, double t) { return Point2(x0 + (x1 - x0) * x(s), y0 + (y1 - y0) * y(t)); };
}

/// From the cylinder (t = 0) at angles a0..a1 to the straight edge p..q (t = 1), right-handed.
Patches::Map ring(double a0, double a1, Point2 p, Point2 q, Grading around = even) {
  return [=](double reversed, double t) {
    const double s = around(1.0 - reversed);
    const double a = a0 + (a1 - a0) * s;
    const Point2 inner(center[0] + radius * std::cos(a), center[1] + radius * std::sin(a));
    const Point2 outer = p + s * (q - p);
    return Point2(inner + radial(t) * (outer - inner));
  };
}

void add_flag(Patches& patches, unsigned material) {
  const double a = std::asin(half_flag / radius);
  // The root lies on the circle.
  patches.add(
      [a](double s, double t) {
        const double angle = -a + 2.0 * a * t;
        const double root = center[0] + radius * std::cos(angle);
        const double y_root = center[1] + radius * std::sin(angle);
        const double y = center[1] - half_flag + 2.0 * half_flag * t;
        return Point2(root + radial(s) * (0.3 - root), y_root + radial(s) * (y - y_root));
      },
      4, 2, material);
  patches.add(rectangle(0.3, 0.5, 0.19, 0.21), 6, 2, material);
  patches.add(rectangle(0.5, flag_end, 0.19, 0.21, fine_last), 6, 2, material);
}

void add_fluid(Patches& patches) {
  const double a = std::asin(half_flag / radius), pi = std::numbers::pi;
  // Around the cylinder.
  patches.add(ring(a, pi / 4, {0.3, 0.21}, {0.3, 0.3}, fine_first), 4, 4, fluid_id);
  patches.add(ring(pi / 4, 3 * pi / 4, {0.3, 0.3}, {0.1, 0.3}), 6, 4, fluid_id);
  patches.add(ring(3 * pi / 4, 5 * pi / 4, {0.1, 0.3}, {0.1, 0.1}), 6, 4, fluid_id);
  patches.add(ring(5 * pi / 4, 7 * pi / 4, {0.1, 0.1}, {0.3, 0.1}), 6, 4, fluid_id);
  patches.add(ring(-pi / 4, -a, {0.3, 0.1}, {0.3, 0.19}, fine_last), 4, 4, fluid_id);
  // Rows below, beside and above, columns left, over the cylinder, along the flag and behind it.
  struct Column {
    double from, to;
    int cells;
    Grading grading;
  };
  const std::array<Column, 5> columns = {{{0.0, 0.1, 3, even},
                                          {0.1, 0.3, 6, even},
                                          {0.3, 0.5, 6, even},
                                          {0.5, flag_end, 6, fine_last},
                                          {flag_end, length, 22, very_fine_first}}};
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const auto& [from, to, cells, grading] = columns[c];
    patches.add(rectangle(from, to, 0.0, 0.1, grading), cells, 3, fluid_id);
    patches.add(rectangle(from, to, 0.3, height, grading), cells, 3, fluid_id);
    if (c == 0) patches.add(rectangle(from, to, 0.1, 0.3, grading), cells, 6, fluid_id);
    if (c >= 2) {
      patches.add(rectangle(from, to, 0.1, 0.19, grading, fine_last), cells, 4, fluid_id);
      patches.add(rectangle(from, to, 0.21, 0.3, grading, fine_first), cells, 4, fluid_id);
    }
  }
  patches.add(rectangle(flag_end, length, 0.19, 0.21, very_fine_first), 22, 2, fluid_id);
}

unsigned boundary_of(const Point2& x) {
  constexpr double tolerance = 1e-9;
  if (x[0] < tolerance) return static_cast<unsigned>(Side::left);
  if (x[0] > length - tolerance) return static_cast<unsigned>(Side::right);
  if (x[1] < tolerance) return static_cast<unsigned>(Side::bottom);
  if (x[1] > height - tolerance) return static_cast<unsigned>(Side::top);
  return obstacle_id;
}

}  // namespace

void make_turek_hron_mesh(Flag flag, int splittings, dealii::Triangulation<2>& mesh) {
  Patches patches;
  if (flag != Flag::rigid) add_flag(patches, 1);
  if (flag != Flag::alone) add_fluid(patches);
  dealii::GridTools::consistently_order_cells(patches.cells);
  dealii::GridTools::invert_all_negative_measure_cells(patches.vertices, patches.cells);
  mesh.create_triangulation(patches.vertices, patches.cells, dealii::SubCellData());
  constexpr dealii::types::manifold_id circle = 1, inside = 2;
  for (const auto& cell : mesh.active_cell_iterators()) cell->set_all_manifold_ids(inside);
  for (const auto& face : mesh.active_face_iterators()) {
    if (!face->at_boundary()) continue;
    const bool on_circle = std::abs(face->vertex(0).distance(center) - radius) < 1e-7 &&
                           std::abs(face->vertex(1).distance(center) - radius) < 1e-7;
    const unsigned boundary = boundary_of(face->center());
    if (flag == Flag::elastic && boundary == obstacle_id && !on_circle)
      throw std::logic_error("the blocks of fluid and flag do not meet");
    // A lone flag is free but for its root.
    face->set_boundary_id(flag == Flag::alone && !on_circle ? static_cast<unsigned>(Side::top)
                                                            : boundary);
    face->set_manifold_id(on_circle ? circle : dealii::numbers::flat_manifold_id);
  }
  mesh.set_manifold(circle, dealii::SphericalManifold<2>(center));
  dealii::TransfiniteInterpolationManifold<2> blend;
  blend.initialize(mesh);
  mesh.set_manifold(inside, blend);
  mesh.refine_global(static_cast<unsigned>(splittings));
}

}  // namespace sprung::reference::testing
