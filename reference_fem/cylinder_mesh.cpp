#include "reference_fem/cylinder_mesh.hpp"

#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace sprung::reference {
namespace {

using Point2 = dealii::Point<2>;

constexpr double pi = std::numbers::pi;

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
  return s * s;
}
/// Finer at the cylinder.
double radial(double t) {
  return t * (0.7 + 0.3 * t);
}

Patches::Map rectangle(double x0, double x1, double y0, double y1, Grading x = even,
                       Grading y = even) {
  return [=](double s, double t) { return Point2(x0 + (x1 - x0) * x(s), y0 + (y1 - y0) * y(t)); };
}

/// How many cells each stretch has, for an unsplit mesh.
struct Counts {
  double bulk = 1.0;  ///< factor on the counts in the channel
  double face = 1.0;  ///< factor on those around the cylinder and in the flag
  int channel(double count) const {
    return std::max(1, static_cast<int>(std::lround(bulk * count)));
  }
  int near(double count) const { return std::max(1, static_cast<int>(std::lround(face * count))); }
};

/// The blocks' corners; columns and rows of the grid outside the square.
class Layout {
 public:
  Layout(const CylinderBlocks& blocks, const Counts& counts) : b_(blocks), n_(counts) {}

  void add_flag(Patches& patches) const;
  void add_fluid(Patches& patches) const;

 private:
  double left() const { return b_.centre[0] - b_.half_square; }
  double right() const { return b_.centre[0] + b_.half_square; }
  double below() const { return b_.centre[1] - b_.half_square; }
  double above() const { return b_.centre[1] + b_.half_square; }
  /// Where the cells along the flag begin to grow finer towards its end.
  double flag_middle() const { return b_.flag_end - (b_.flag_end - right()) / 3.0; }
  /// From the cylinder (t = 0) at angles a0..a1 to the straight edge p..q (t = 1), right-handed.
  Patches::Map ring(double a0, double a1, Point2 p, Point2 q, Grading around = even) const;
  void add_ring(Patches& patches) const;
  void add_grid(Patches& patches) const;

  const CylinderBlocks& b_;
  Counts n_;
};

Patches::Map Layout::ring(double a0, double a1, Point2 p, Point2 q, Grading around) const {
  const Point2 c(b_.centre[0], b_.centre[1]);
  const double r = b_.radius;
  return [=](double reversed, double t) {
    const double s = around(1.0 - reversed);
    const double a = a0 + (a1 - a0) * s;
    const Point2 inner(c[0] + r * std::cos(a), c[1] + r * std::sin(a));
    const Point2 outer = p + s * (q - p);
    return Point2(inner + radial(t) * (outer - inner));
  };
}

void Layout::add_flag(Patches& patches) const {
  const double a = std::asin(b_.half_flag / b_.radius);
  const CylinderBlocks b = b_;
  const double end = right();
  // The root lies on the circle.
  patches.add(
      [a, b, end](double s, double t) {
        const double angle = -a + 2.0 * a * t;
        const double root = b.centre[0] + b.radius * std::cos(angle);
        const double y_root = b.centre[1] + b.radius * std::sin(angle);
        const double y = b.centre[1] - b.half_flag + 2.0 * b.half_flag * t;
        return Point2(root + radial(s) * (end - root), y_root + radial(s) * (y - y_root));
      },
      n_.near(4), n_.near(2), 1);
  const double low = b_.centre[1] - b_.half_flag, high = b_.centre[1] + b_.half_flag;
  patches.add(rectangle(right(), flag_middle(), low, high), n_.near(6), n_.near(2), 1);
  patches.add(rectangle(flag_middle(), b_.flag_end, low, high, fine_last), n_.near(6), n_.near(2),
              1);
}

void Layout::add_ring(Patches& patches) const {
  const Point2 corners[4] = {
      {right(), above()}, {left(), above()}, {left(), below()}, {right(), below()}};
  for (int side = 0; side < 3; ++side)
    patches.add(
        ring(pi / 4 + side * pi / 2, 3 * pi / 4 + side * pi / 2, corners[side], corners[side + 1]),
        n_.near(6), n_.near(4), fluid_id);
  if (!b_.has_flag) {
    patches.add(ring(-pi / 4, pi / 4, corners[3], corners[0]), n_.near(6), n_.near(4), fluid_id);
    return;
  }
  const double a = std::asin(b_.half_flag / b_.radius);
  const double low = b_.centre[1] - b_.half_flag, high = b_.centre[1] + b_.half_flag;
  patches.add(ring(a, pi / 4, {right(), high}, corners[0], fine_first), n_.near(4), n_.near(4),
              fluid_id);
  patches.add(ring(-pi / 4, -a, corners[3], {right(), low}, fine_last), n_.near(4), n_.near(4),
              fluid_id);
}

void Layout::add_grid(Patches& patches) const {
  struct Stretch {
    double from, to;
    int cells;
    Grading grading;
    bool square;  ///< beside the cylinder's square, not before or behind it
  };
  const auto by_size = [&](double length) { return n_.channel(3.0 * length / b_.half_square); };
  std::vector<Stretch> columns = {{b_.from[0], left(), by_size(left() - b_.from[0]), even, false},
                                  {left(), right(), n_.near(6), even, true}};
  double behind = right();
  if (b_.has_flag) {
    columns.push_back({right(), flag_middle(), n_.near(6), even, false});
    columns.push_back({flag_middle(), b_.flag_end, n_.near(6), fine_last, false});
    behind = b_.flag_end;
  }
  columns.push_back({behind, b_.to[0], n_.channel(1.16 * (b_.to[0] - behind) / b_.half_square),
                     b_.has_flag ? very_fine_first : fine_first, false});
  const int low_rows = by_size(below() - b_.from[1]), high_rows = by_size(b_.to[1] - above());
  for (const Stretch& c : columns) {
    patches.add(rectangle(c.from, c.to, b_.from[1], below(), c.grading), c.cells, low_rows,
                fluid_id);
    patches.add(rectangle(c.from, c.to, above(), b_.to[1], c.grading), c.cells, high_rows,
                fluid_id);
    if (c.square) continue;
    const bool before = c.to <= left() + 1e-12;
    if (before || !b_.has_flag) {
      patches.add(rectangle(c.from, c.to, below(), above(), c.grading), c.cells, n_.near(6),
                  fluid_id);
      continue;
    }
    const double low = b_.centre[1] - b_.half_flag, high = b_.centre[1] + b_.half_flag;
    patches.add(rectangle(c.from, c.to, below(), low, c.grading, fine_last), c.cells, n_.near(4),
                fluid_id);
    patches.add(rectangle(c.from, c.to, high, above(), c.grading, fine_first), c.cells, n_.near(4),
                fluid_id);
    if (c.from >= b_.flag_end - 1e-12)
      patches.add(rectangle(c.from, c.to, low, high, c.grading), c.cells, n_.near(2), fluid_id);
  }
}

void Layout::add_fluid(Patches& patches) const {
  add_ring(patches);
  add_grid(patches);
}

/// The channel's side that a boundary point lies on; `other` if it lies on none.
unsigned side_of(const CylinderBlocks& b, const Point2& x, unsigned other) {
  const double tolerance = 1e-9 * (b.to[0] - b.from[0]);
  if (x[0] < b.from[0] + tolerance) return static_cast<unsigned>(Side::left);
  if (x[0] > b.to[0] - tolerance) return static_cast<unsigned>(Side::right);
  if (x[1] < b.from[1] + tolerance) return static_cast<unsigned>(Side::bottom);
  if (x[1] > b.to[1] - tolerance) return static_cast<unsigned>(Side::top);
  return other;
}

void name_and_round(const CylinderBlocks& b, dealii::Triangulation<2>& mesh) {
  const Point2 centre(b.centre[0], b.centre[1]);
  constexpr dealii::types::manifold_id circle = 1, inside = 2;
  for (const auto& cell : mesh.active_cell_iterators()) cell->set_all_manifold_ids(inside);
  for (const auto& face : mesh.active_face_iterators()) {
    if (!face->at_boundary()) continue;
    const auto on_rim = [&](unsigned v) {
      return std::abs(face->vertex(v).distance(centre) - b.radius) < 1e-7 * b.radius;
    };
    const bool on_circle = on_rim(0) && on_rim(1);
    unsigned id = side_of(b, face->center(), b.flag_id);
    if (on_circle) id = b.cylinder_id;
    if (b.flag == CylinderBlocks::Flag::alone && !on_circle) id = free_id;
    if (b.flag == CylinderBlocks::Flag::elastic && !on_circle && id == b.flag_id)
      throw std::logic_error("the blocks of fluid and flag do not meet");
    face->set_boundary_id(id);
    face->set_manifold_id(on_circle ? circle : dealii::numbers::flat_manifold_id);
  }
  mesh.set_manifold(circle, dealii::SphericalManifold<2>(centre));
  dealii::TransfiniteInterpolationManifold<2> blend;
  blend.initialize(mesh);
  mesh.set_manifold(inside, blend);
}

/// Takes a rectangle as the flag if it starts inside the circle and ends right of its square.
bool take_flag(CylinderBlocks& b, const Box& box) {
  const double tolerance = 1e-9 * (b.to[0] - b.from[0]);
  const double half = 0.5 * (box.to[1] - box.from[1]);
  const bool level = std::abs(0.5 * (box.from[1] + box.to[1]) - b.centre[1]) < tolerance;
  const double root = b.centre[0] + std::sqrt(std::max(0.0, b.radius * b.radius - half * half));
  if (!level || half >= b.radius / std::sqrt(2.0) || box.from[0] > root + tolerance ||
      box.from[0] < b.centre[0] - tolerance || box.to[0] < b.centre[0] + 1.2 * b.half_square ||
      box.to[0] > b.to[0] - b.half_square)
    return false;
  b.has_flag = true;
  b.half_flag = half;
  b.flag_end = box.to[0];
  return true;
}

/// The rectangle that a polygon is, if it is one along the axes.
std::optional<Box> rectangle_of(const std::vector<Point>& corners) {
  if (corners.size() != 4) return {};
  Box box{corners[0], corners[0]};
  for (const Point& p : corners)
    for (std::size_t d = 0; d < 2; ++d) {
      box.from[d] = std::min(box.from[d], p[d]);
      box.to[d] = std::max(box.to[d], p[d]);
    }
  for (const Point& p : corners)
    for (std::size_t d = 0; d < 2; ++d)
      if (p[d] != box.from[d] && p[d] != box.to[d]) return {};
  return box;
}

}  // namespace

std::optional<CylinderBlocks> cylinder_in_channel(const Problem& problem, bool bodies_only) {
  CylinderBlocks b;
  const CurvedWall* circle = nullptr;
  const CurvedWall* polygon = nullptr;
  for (std::size_t i = 0; i < problem.curved_walls.size(); ++i) {
    const CurvedWall& wall = problem.curved_walls[i];
    const bool round = wall.shape == CurvedWall::Shape::circle;
    if (wall.fluid_inside || (round ? circle : polygon) != nullptr) return {};
    (round ? circle : polygon) = &wall;
    (round ? b.cylinder_id : b.flag_id) = obstacle_id + static_cast<unsigned>(i);
  }
  if (circle == nullptr || problem.solids.size() + (polygon != nullptr ? 1 : 0) > 1) return {};
  for (std::size_t d = 0; d < 2; ++d) {
    b.from[d] = problem.channel.from[d], b.to[d] = problem.channel.to[d];
    b.centre[d] = circle->centre[d];
  }
  b.radius = circle->radius;
  double room = 2.0 * b.radius;
  for (std::size_t d = 0; d < 2; ++d)
    room = std::min({room, 0.8 * (b.centre[d] - b.from[d]), 0.8 * (b.to[d] - b.centre[d])});
  b.half_square = room;
  if (room < 1.3 * b.radius) return {};
  if (polygon != nullptr) {
    const auto box = rectangle_of(polygon->corners);
    if (!box || !take_flag(b, *box)) return {};
    b.flag = CylinderBlocks::Flag::rigid;
  }
  if (!problem.solids.empty()) {
    if (problem.solids[0].clamped || !take_flag(b, problem.solids[0].body)) return {};
    b.flag = bodies_only ? CylinderBlocks::Flag::alone : CylinderBlocks::Flag::elastic;
    b.flag_id = free_id;
  }
  return b;
}

void make_cylinder_mesh(const CylinderBlocks& blocks, const MeshSizes& sizes,
                        dealii::Triangulation<2>& mesh) {
  const double scale = std::pow(2.0, sizes.splittings);
  const Layout layout(blocks, {blocks.half_square / (3.0 * scale * sizes.bulk),
                               blocks.half_square / (6.0 * scale * sizes.face)});
  Patches patches;
  using Flag = CylinderBlocks::Flag;
  if (blocks.flag == Flag::elastic || blocks.flag == Flag::alone) layout.add_flag(patches);
  if (blocks.flag != Flag::alone) layout.add_fluid(patches);
  dealii::GridTools::consistently_order_cells(patches.cells);
  dealii::GridTools::invert_all_negative_measure_cells(patches.vertices, patches.cells);
  mesh.create_triangulation(patches.vertices, patches.cells, dealii::SubCellData());
  name_and_round(blocks, mesh);
  mesh.refine_global(static_cast<unsigned>(sizes.splittings));
}

}  // namespace sprung::reference
