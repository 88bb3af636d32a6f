#include "reference_fem/mesh.hpp"

#include "scene/gmsh_session.hpp"

#include "reference_fem/cylinder_mesh.hpp"
#include "reference_fem/unstructured_mesh.hpp"

#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

namespace sprung::reference {
namespace {

bool on_side(const Box& channel, Side side, double x, double y) {
  const double tolerance =
      1e-9 * std::max(channel.to[0] - channel.from[0], channel.to[1] - channel.from[1]);
  switch (side) {
    case Side::left:
      return std::abs(x - channel.from[0]) < tolerance;
    case Side::right:
      return std::abs(x - channel.to[0]) < tolerance;
    case Side::bottom:
      return std::abs(y - channel.from[1]) < tolerance;
    case Side::top:
      return std::abs(y - channel.to[1]) < tolerance;
    default:
      return false;
  }
}

/// A stretch of a grid line, cut into `cells` whose lengths grow by `ratio` from its start to its
/// end.
struct Piece {
  double length = 0.0;
  int cells = 1;
  double ratio = 1.0;
};

/// Cells that start at `first` and grow by `ratio` until they reach `cap`.
std::vector<Piece> growing(double length, double first, double cap, double ratio) {
  const auto sum = [&](int n) { return first * (std::pow(ratio, n) - 1.0) / (ratio - 1.0); };
  const int to_cap =
      std::max(1, static_cast<int>(std::lround(std::log(cap / first) / std::log(ratio))));
  if (sum(to_cap) + 0.5 * cap >= length) {
    const double wanted = std::log1p(length * (ratio - 1.0) / first) / std::log(ratio);
    return {{length, std::max(1, static_cast<int>(std::lround(wanted))), ratio}};
  }
  const double rest = length - sum(to_cap);
  return {{sum(to_cap), to_cap, ratio},
          {rest, std::max(1, static_cast<int>(std::ceil(rest / cap - 0.1))), 1.0}};
}

std::vector<Piece> reversed(std::vector<Piece> pieces) {
  std::reverse(pieces.begin(), pieces.end());
  for (Piece& piece : pieces) piece.ratio = 1.0 / piece.ratio;
  return pieces;
}

/// A line of the grid that a body's face lies on, and the cell size wanted there; size 0: any.
struct GridLine {
  double at = 0.0;
  double size = 0.0;
};

/// One direction of the block grid: its lines and what lies between them.
struct Direction {
  std::vector<double> lines;
  std::vector<Piece> pieces;
};

Direction divide(const std::vector<GridLine>& faces,
                 const std::vector<std::array<double, 2>>& bodies, const MeshSizes& sizes) {
  Direction direction;
  direction.lines.push_back(faces.front().at);
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    const double a = faces[i].at, b = faces[i + 1].at, length = b - a;
    const bool along_body = std::any_of(bodies.begin(), bodies.end(), [&](const auto& body) {
      return body[0] < 0.5 * (a + b) && 0.5 * (a + b) < body[1];
    });
    const double cap = along_body ? sizes.face : sizes.bulk;
    const double first = std::min(faces[i].size, cap), last = std::min(faces[i + 1].size, cap);
    std::vector<Piece> pieces;
    if (first > 0.0 && last > 0.0) {
      pieces = growing(0.5 * length, first, cap, sizes.growth);
      for (const Piece& piece : reversed(growing(0.5 * length, last, cap, sizes.growth)))
        pieces.push_back(piece);
    } else if (first > 0.0) {
      pieces = growing(length, first, cap, sizes.growth);
    } else if (last > 0.0) {
      pieces = reversed(growing(length, last, cap, sizes.growth));
    } else {
      pieces = {{length, std::max(1, static_cast<int>(std::ceil(length / cap - 0.1))), 1.0}};
    }
    double at = a;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      at = k + 1 == pieces.size() ? b : at + pieces[k].length;
      direction.lines.push_back(at);
      direction.pieces.push_back(pieces[k]);
    }
  }
  return direction;
}

/// Lines along coordinate `d` at the channel's sides and the bodies' faces, ascending; faces that
/// fall together take the smaller size.
Direction directions(const Problem& problem, const MeshSizes& sizes, std::size_t d) {
  const auto at_side = [&](Side side) { return is_no_slip(problem, side) ? sizes.wall : 0.0; };
  std::vector<GridLine> lines = {
      {problem.channel.from[d], at_side(d == 0 ? Side::left : Side::bottom)},
      {problem.channel.to[d], at_side(d == 0 ? Side::right : Side::top)}};
  std::vector<std::array<double, 2>> bodies;
  for (const Solid& solid : problem.solids) {
    bodies.push_back({solid.body.from[d], solid.body.to[d]});
    for (const double at : bodies.back()) {
      const bool held =
          solid.clamped && (d == 0 ? on_side(problem.channel, *solid.clamped, at, NAN)
                                   : on_side(problem.channel, *solid.clamped, NAN, at));
      // Every line across the clamp passes its corners.
      const bool across =
          solid.clamped &&
          ((*solid.clamped == Side::left || *solid.clamped == Side::right) != (d == 0));
      lines.push_back({at, held     ? sizes.clamp_corner
                           : across ? std::min(sizes.clamp_corner, sizes.free_corner)
                                    : sizes.free_corner});
    }
  }
  std::sort(lines.begin(), lines.end(),
            [](const GridLine& a, const GridLine& b) { return a.at < b.at; });
  std::vector<GridLine> distinct;
  const double tolerance = 1e-9 * (problem.channel.to[d] - problem.channel.from[d]);
  for (const GridLine& line : lines) {
    if (distinct.empty() || line.at - distinct.back().at > tolerance)
      distinct.push_back(line);
    else if (line.size > 0.0)
      distinct.back().size =
          distinct.back().size > 0.0 ? std::min(distinct.back().size, line.size) : line.size;
  }
  return divide(distinct, bodies, sizes);
}

unsigned material_at(const Problem& problem, double x, double y) {
  for (std::size_t i = 0; i < problem.solids.size(); ++i) {
    const Box& b = problem.solids[i].body;
    if (b.from[0] < x && x < b.to[0] && b.from[1] < y && y < b.to[1])
      return static_cast<unsigned>(i) + 1;
  }
  return fluid_id;
}

/// The plane as a grid of blocks, each meshed row by row (transfinite); surfaces by material id.
std::vector<std::vector<int>> build_blocks(const Problem& problem, const MeshSizes& sizes) {
  namespace geo = gmsh::model::geo;
  const Direction x = directions(problem, sizes, 0), y = directions(problem, sizes, 1);
  const int nx = static_cast<int>(x.lines.size()), ny = static_cast<int>(y.lines.size());
  const auto at = [](const std::vector<double>& lines, int i) {
    return lines[static_cast<std::size_t>(i)];
  };
  std::vector<int> points, across, along;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) points.push_back(geo::addPoint(at(x.lines, i), at(y.lines, j), 0));
  const auto point = [&](int i, int j) { return points[static_cast<std::size_t>(j * nx + i)]; };
  const auto cut = [](int curve, const Piece& piece) {
    geo::mesh::setTransfiniteCurve(curve, piece.cells + 1, "Progression", piece.ratio);
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i + 1 < nx; ++i) {
      across.push_back(geo::addLine(point(i, j), point(i + 1, j)));
      cut(across.back(), x.pieces[static_cast<std::size_t>(i)]);
    }
  for (int j = 0; j + 1 < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      along.push_back(geo::addLine(point(i, j), point(i, j + 1)));
      cut(along.back(), y.pieces[static_cast<std::size_t>(j)]);
    }
  std::vector<std::vector<int>> surfaces(problem.solids.size() + 1);
  for (int j = 0; j + 1 < ny; ++j)
    for (int i = 0; i + 1 < nx; ++i) {
      const auto h = [&](int row) { return across[static_cast<std::size_t>(row * (nx - 1) + i)]; };
      const auto v = [&](int column) { return along[static_cast<std::size_t>(j * nx + column)]; };
      const int loop = geo::addCurveLoop({h(j), v(i + 1), -h(j + 1), -v(i)});
      const int surface = geo::addPlaneSurface({loop});
      geo::mesh::setTransfiniteSurface(surface);
      geo::mesh::setRecombine(2, surface);
      surfaces[material_at(problem, 0.5 * (at(x.lines, i) + at(x.lines, i + 1)),
                           0.5 * (at(y.lines, j) + at(y.lines, j + 1)))]
          .push_back(surface);
    }
  geo::synchronize();
  gmsh::model::mesh::generate(2);
  return surfaces;
}

/// Copies Gmsh's nodes and quadrilaterals into deal.II's arrays.
void collect_cells(const std::vector<std::vector<int>>& surfaces,
                   std::vector<dealii::Point<2>>& vertices,
                   std::vector<dealii::CellData<2>>& cells) {
  std::vector<std::size_t> node_tags;
  std::vector<double> coordinates, parameters;
  gmsh::model::mesh::getNodes(node_tags, coordinates, parameters);
  std::map<std::size_t, unsigned> number;
  const auto vertex = [&](std::size_t tag) {
    const auto [place, is_new] = number.try_emplace(tag, static_cast<unsigned>(vertices.size()));
    if (is_new) vertices.emplace_back();
    return place->second;
  };
  for (std::size_t material = 0; material < surfaces.size(); ++material)
    for (const int surface : surfaces[material]) {
      std::vector<int> types;
      std::vector<std::vector<std::size_t>> elements, nodes;
      gmsh::model::mesh::getElements(types, elements, nodes, 2, surface);
      for (std::size_t t = 0; t < types.size(); ++t) {
        if (types[t] != 3)
          throw std::runtime_error(
              "Gmsh left a triangle in the mesh; change reference_fem.cell_size a little and try "
              "again");
        for (std::size_t e = 0; e < elements[t].size(); ++e) {
          dealii::CellData<2> cell;
          // Gmsh counts round the quadrilateral, deal.II row by row.
          const std::array<std::size_t, 4> order = {0, 1, 3, 2};
          for (std::size_t v = 0; v < 4; ++v) cell.vertices[v] = vertex(nodes[t][4 * e + order[v]]);
          cell.material_id = static_cast<unsigned>(material);
          cells.push_back(cell);
        }
      }
    }
  for (std::size_t i = 0; i < node_tags.size(); ++i)
    if (const auto place = number.find(node_tags[i]); place != number.end())
      vertices[place->second] = {coordinates[3 * i], coordinates[3 * i + 1]};
}

/// Gives every face on the plane's border the id of its side or wall; splitting keeps round walls
/// round. A face on the border of the mesh but of nothing else would be a crack.
void name_sides(const Problem& problem, bool bodies_only, dealii::Triangulation<2>& mesh) {
  const Box& channel = problem.channel;
  for (std::size_t i = 0; i < problem.curved_walls.size(); ++i)
    if (const CurvedWall& wall = problem.curved_walls[i]; wall.shape == CurvedWall::Shape::circle)
      mesh.set_manifold(static_cast<unsigned>(i) + 1,
                        dealii::SphericalManifold<2>({wall.centre[0], wall.centre[1]}));
  for (const auto& face : mesh.active_face_iterators()) {
    if (!face->at_boundary()) continue;
    const auto x = face->center();
    bool named = false;
    for (const Side side : {Side::left, Side::right, Side::bottom, Side::top})
      if (on_side(channel, side, x[0], x[1])) {
        face->set_boundary_id(static_cast<unsigned>(side));
        named = true;
      }
    if (const int wall = wall_through(problem, face->vertex(0), face->vertex(1));
        !named && wall >= 0) {
      face->set_boundary_id(obstacle_id + static_cast<unsigned>(wall));
      if (problem.curved_walls[static_cast<std::size_t>(wall)].shape == CurvedWall::Shape::circle)
        face->set_manifold_id(static_cast<unsigned>(wall) + 1);
      named = true;
    }
    if (!named && bodies_only) {
      face->set_boundary_id(free_id);
      named = true;
    }
    if (!named)
      throw std::runtime_error("the mesh has a crack at x = " + std::to_string(x[0]) +
                               " m, y = " + std::to_string(x[1]) +
                               " m; change reference_fem.cell_size a little");
  }
}

MeshQuality check_quality(const dealii::Triangulation<2>& mesh) {
  MeshQuality quality;
  quality.min_scaled_jacobian = 1.0;
  quality.min_size = std::numeric_limits<double>::max();
  for (const auto& cell : mesh.active_cell_iterators()) {
    ++quality.cells;
    if (cell->material_id() != fluid_id) ++quality.solid_cells;
    const std::array<unsigned, 4> round = {0, 1, 3, 2};
    for (unsigned i = 0; i < 4; ++i) {
      const auto a = cell->vertex(round[(i + 1) % 4]) - cell->vertex(round[i]);
      const auto b = cell->vertex(round[(i + 3) % 4]) - cell->vertex(round[i]);
      const double sine = (a[0] * b[1] - a[1] * b[0]) / (a.norm() * b.norm());
      if (sine < 0.1)
        throw std::runtime_error("the mesh has a distorted cell (corner quality " +
                                 std::to_string(sine) +
                                 ") at x = " + std::to_string(cell->center()[0]) +
                                 " m, y = " + std::to_string(cell->center()[1]) +
                                 " m; change reference_fem.cell_size or reference_fem.growth");
      quality.min_scaled_jacobian = std::min(quality.min_scaled_jacobian, sine);
      quality.min_size = std::min(quality.min_size, a.norm());
      quality.max_size = std::max(quality.max_size, a.norm());
    }
  }
  return quality;
}

}  // namespace

namespace {

/// What Gmsh must make so that splitting gives the wanted sizes.
MeshSizes coarsened(MeshSizes sizes) {
  const double factor = std::pow(2.0, sizes.splittings);
  for (double* size :
       {&sizes.bulk, &sizes.clamp_corner, &sizes.free_corner, &sizes.face, &sizes.wall})
    *size *= factor;
  return sizes;
}

}  // namespace

bool is_no_slip(const Problem& problem, Side side) {
  return problem.walls && std::find(problem.walls->no_slip.begin(), problem.walls->no_slip.end(),
                                    side) != problem.walls->no_slip.end();
}

MeshQuality make_mesh(const Problem& problem, const MeshSizes& sizes,
                      dealii::Triangulation<2>& mesh) {
  // The blocks round a cylinder have fixed proportions.
  const auto cylinder = sizes.unstructured || sizes.wall > 0.0 || problem.curved_walls.empty()
                            ? std::nullopt
                            : cylinder_in_channel(problem, sizes.bodies_only);
  if (cylinder) {
    make_cylinder_mesh(*cylinder, sizes, mesh);
    return check_quality(mesh);
  }
  const bool blocks = problem.curved_walls.empty() && !sizes.bodies_only && !sizes.unstructured;
  std::vector<dealii::Point<2>> vertices;
  std::vector<dealii::CellData<2>> cells;
  {
    const GmshSession session;
    gmsh::model::add("scene");
    try {
      collect_cells(blocks ? build_blocks(problem, coarsened(sizes))
                           : build_unstructured(problem, coarsened(sizes)),
                    vertices, cells);
    } catch (const std::string& error) {  // as Gmsh throws
      throw std::runtime_error("Gmsh could not mesh the scene (" + error +
                               "); change reference_fem.cell_size a little");
    }
  }
  dealii::GridTools::consistently_order_cells(cells);
  dealii::GridTools::invert_all_negative_measure_cells(vertices, cells);
  mesh.create_triangulation(vertices, cells, dealii::SubCellData());
  name_sides(problem, sizes.bodies_only, mesh);
  mesh.refine_global(static_cast<unsigned>(sizes.splittings));
  return check_quality(mesh);
}

}  // namespace sprung::reference
