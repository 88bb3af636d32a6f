#include "reference_fem/mesh.hpp"

#include <deal.II/grid/grid_tools.h>

#include <gmsh.h>

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

/// Gmsh keeps one global model; this opens it and closes it again whatever happens in between.
class GmshSession {
 public:
  GmshSession() {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
    gmsh::model::add("scene");
  }
  ~GmshSession() { gmsh::finalize(); }
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
};

struct Corner {
  double x, y, size;
};

double distance_to_segment(double x, double y, const std::array<double, 4>& s) {
  const double dx = s[2] - s[0], dy = s[3] - s[1];
  const double t =
      std::clamp(((x - s[0]) * dx + (y - s[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(x - s[0] - t * dx, y - s[1] - t * dy);
}

bool on_side(const Box& channel, Side side, double x, double y) {
  const double tolerance =
      1e-9 * std::max(channel.to[0] - channel.from[0], channel.to[1] - channel.from[1]);
  switch (side) {
    case Side::left: return std::abs(x - channel.from[0]) < tolerance;
    case Side::right: return std::abs(x - channel.to[0]) < tolerance;
    case Side::bottom: return std::abs(y - channel.from[1]) < tolerance;
    case Side::top: return std::abs(y - channel.to[1]) < tolerance;
    default: return false;
  }
}

/// Wanted edge length at a point: the smallest that any corner or face asks for.
class SizeField {
 public:
  SizeField(const Problem& problem, const MeshSizes& sizes) : sizes_(sizes) {
    // The growth is a ratio of lengths: the same when all sizes are scaled.
    const double coarser = std::pow(2.0, sizes.splittings);
    for (double* size : {&sizes_.bulk, &sizes_.clamp_corner, &sizes_.free_corner, &sizes_.face})
      *size *= coarser;
    for (const Solid& solid : problem.solids) {
      const auto& [a, b] = std::pair(solid.body.from, solid.body.to);
      const std::array<std::array<double, 2>, 4> points = {
          {{a[0], a[1]}, {b[0], a[1]}, {b[0], b[1]}, {a[0], b[1]}}};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& p = points[i];
        const auto& q = points[(i + 1) % 4];
        const bool clamped = solid.clamped && on_side(problem.channel, *solid.clamped, p[0], p[1]);
        corners_.push_back({p[0], p[1], clamped ? sizes_.clamp_corner : sizes_.free_corner});
        faces_.push_back({p[0], p[1], q[0], q[1]});
      }
    }
  }
  double operator()(double x, double y) const {
    double size = sizes_.bulk;
    for (const Corner& c : corners_)
      size = std::min(size, c.size + sizes_.growth * std::hypot(x - c.x, y - c.y));
    for (const auto& f : faces_)
      size = std::min(size, sizes_.face + sizes_.growth * distance_to_segment(x, y, f));
    return size;
  }

 private:
  MeshSizes sizes_;
  std::vector<Corner> corners_;
  std::vector<std::array<double, 4>> faces_;
};

/// Channel and bodies as surfaces that share their edges; returns the surfaces of each material id.
std::vector<std::vector<int>> build_geometry(const Problem& problem) {
  const Box& c = problem.channel;
  const int channel =
      gmsh::model::occ::addRectangle(c.from[0], c.from[1], 0, c.to[0] - c.from[0], c.to[1] - c.from[1]);
  gmsh::vectorpair bodies;
  for (const Solid& solid : problem.solids) {
    const Box& b = solid.body;
    bodies.emplace_back(2, gmsh::model::occ::addRectangle(b.from[0], b.from[1], 0, b.to[0] - b.from[0],
                                                          b.to[1] - b.from[1]));
  }
  std::vector<std::vector<int>> surfaces(problem.solids.size() + 1);
  if (bodies.empty()) {
    surfaces[fluid_id] = {channel};
  } else {
    gmsh::vectorpair all;
    std::vector<gmsh::vectorpair> parts;
    gmsh::model::occ::fragment({{2, channel}}, bodies, all, parts);
    std::vector<int> taken;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      for (const auto& [dim, tag] : parts[i + 1]) {
        surfaces[i + 1].push_back(tag);
        taken.push_back(tag);
      }
    for (const auto& [dim, tag] : all)
      if (std::find(taken.begin(), taken.end(), tag) == taken.end()) surfaces[fluid_id].push_back(tag);
  }
  gmsh::model::occ::synchronize();
  return surfaces;
}

void generate_quadrilaterals(const std::vector<std::vector<int>>& surfaces, const SizeField& size) {
  gmsh::option::setNumber("Mesh.MeshSizeExtendFromBoundary", 0);
  gmsh::option::setNumber("Mesh.MeshSizeFromPoints", 0);
  gmsh::option::setNumber("Mesh.Algorithm", 6);               // frontal
  // Pairs the triangles of a mesh twice as coarse and splits everything once: quadrilaterals only.
  gmsh::option::setNumber("Mesh.RecombinationAlgorithm", 2);
  gmsh::option::setNumber("Mesh.RandomSeed", 1);
  gmsh::model::mesh::setSizeCallback(
      [&size](int, int, double x, double y, double) { return size(x, y); });
  for (std::size_t material = 0; material < surfaces.size(); ++material)
    for (const int tag : surfaces[material]) {
      if (material != fluid_id) gmsh::model::mesh::setTransfiniteSurface(tag);
      gmsh::model::mesh::setRecombine(2, tag);
    }
  gmsh::model::mesh::generate(2);
  gmsh::model::mesh::removeSizeCallback();
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
              "Gmsh left a triangle in the mesh; change reference_fem.cell_size a little and try again");
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
        throw std::runtime_error("the mesh has a distorted cell (corner quality " + std::to_string(sine) +
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

MeshQuality make_mesh(const Problem& problem, const MeshSizes& sizes, dealii::Triangulation<2>& mesh) {
  std::vector<dealii::Point<2>> vertices;
  std::vector<dealii::CellData<2>> cells;
  {
    const GmshSession session;
    const auto surfaces = build_geometry(problem);
    generate_quadrilaterals(surfaces, SizeField(problem, sizes));
    collect_cells(surfaces, vertices, cells);
  }
  dealii::GridTools::consistently_order_cells(cells);
  dealii::GridTools::invert_all_negative_measure_cells(vertices, cells);
  mesh.create_triangulation(vertices, cells, dealii::SubCellData());
  for (const auto& face : mesh.active_face_iterators())
    if (face->at_boundary())
      for (const Side side : {Side::left, Side::right, Side::bottom, Side::top})
        if (on_side(problem.channel, side, face->center()[0], face->center()[1]))
          face->set_boundary_id(static_cast<unsigned>(side));
  mesh.refine_global(static_cast<unsigned>(sizes.splittings));
  return check_quality(mesh);
}

}  // namespace sprung::reference
