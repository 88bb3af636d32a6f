#include "reference_fem/unstructured_mesh.hpp"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

namespace sprung::reference {
namespace {

namespace occ = gmsh::model::occ;
using Tags = gmsh::vectorpair;

int rectangle(const Box& box) {
  return occ::addRectangle(box.from[0], box.from[1], 0.0, box.to[0] - box.from[0],
                           box.to[1] - box.from[1]);
}

int surface_of(const CurvedWall& wall) {
  if (wall.shape == CurvedWall::Shape::circle)
    return occ::addDisk(wall.centre[0], wall.centre[1], 0.0, wall.radius, wall.radius);
  std::vector<int> points, lines;
  for (const Point& p : wall.corners) points.push_back(occ::addPoint(p[0], p[1], 0.0));
  for (std::size_t i = 0; i < points.size(); ++i)
    lines.push_back(occ::addLine(points[i], points[(i + 1) % points.size()]));
  return occ::addPlaneSurface({occ::addCurveLoop(lines)});
}

/// What is left of `part` outside the walls around which the fluid flows and inside those that
/// hold it.
Tags trimmed(Tags part, const Problem& problem) {
  for (const CurvedWall& wall : problem.curved_walls) {
    const Tags tool = {{2, surface_of(wall)}};
    Tags left;
    std::vector<Tags> origin;
    if (wall.fluid_inside)
      occ::intersect(part, tool, left, origin);
    else
      occ::cut(part, tool, left, origin);
    part = left;
  }
  return part;
}

/// Fluid and bodies, cut along each other's faces; surfaces by material id.
std::vector<std::vector<int>> build_surfaces(const Problem& problem, bool bodies_only) {
  Tags objects = bodies_only ? Tags{} : trimmed({{2, rectangle(problem.channel)}}, problem);
  std::vector<unsigned> material(objects.size(), fluid_id);
  for (std::size_t i = 0; i < problem.solids.size(); ++i)
    for (const auto& part : trimmed({{2, rectangle(problem.solids[i].body)}}, problem)) {
      objects.push_back(part);
      material.push_back(static_cast<unsigned>(i) + 1);
    }
  if (objects.empty()) throw std::runtime_error("the curved walls leave no fluid");
  Tags all;
  std::vector<Tags> pieces;
  // Gmsh refuses to cut one piece alone.
  if (objects.size() > 1)
    occ::fragment(objects, {}, all, pieces);
  else
    pieces = {objects};
  occ::synchronize();
  // A piece of a body is a piece of the fluid's surface too; the body, named later, has it.
  std::vector<std::pair<int, unsigned>> owner;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    for (const auto& [dimension, tag] : pieces[i]) {
      const int surface = tag;
      const auto at = std::find_if(owner.begin(), owner.end(),
                                   [&](const auto& o) { return o.first == surface; });
      if (dimension != 2) continue;
      if (at == owner.end())
        owner.emplace_back(surface, material[i]);
      else
        at->second = std::max(at->second, material[i]);
    }
  std::vector<std::vector<int>> surfaces(problem.solids.size() + 1);
  for (const auto& [surface, id] : owner) surfaces[id].push_back(surface);
  return surfaces;
}

/// Points per curve that distances are taken from; renamed in Gmsh 4.9.
constexpr const char* sampling_option =
    GMSH_API_VERSION_MAJOR > 4 || GMSH_API_VERSION_MINOR >= 9 ? "Sampling" : "NumPointsPerCurve";

/// A Gmsh field: `size` at the given entities, growing with the distance to `bulk`.
int size_field(const std::string& list, const std::vector<double>& entities, double size,
               const MeshSizes& sizes) {
  namespace field = gmsh::model::mesh::field;
  const int distance = field::add("Distance");
  field::setNumbers(distance, list, entities);
  if (list == "CurvesList") field::setNumber(distance, sampling_option, 200);
  const int threshold = field::add("Threshold");
  field::setNumber(threshold, "InField", distance);
  field::setNumber(threshold, "SizeMin", size);
  field::setNumber(threshold, "SizeMax", sizes.bulk);
  field::setNumber(threshold, "DistMin", size);
  // Neighbours in the ratio `growth` would grow by growth - 1 of the distance; triangles that are
  // to become good quadrilaterals bear half of it.
  const double slope = 0.5 * (sizes.growth - 1.0);
  field::setNumber(threshold, "DistMax", size + std::max(sizes.bulk - size, 1e-9) / slope);
  return threshold;
}

/// `box`: least x, y, z and largest.
bool lies_on(const Box& channel, Side side, const std::vector<double>& box) {
  const double tolerance = 1e-6 * (channel.to[0] - channel.from[0]);
  const std::size_t d = side == Side::left || side == Side::right ? 0 : 1;
  const double at = side == Side::left || side == Side::bottom ? channel.from[d] : channel.to[d];
  return std::abs(box[d] - at) < tolerance && std::abs(box[d + 3] - at) < tolerance;
}

bool on_channel(const Box& channel, const std::vector<double>& box) {
  for (const Side side : {Side::left, Side::right, Side::bottom, Side::top})
    if (lies_on(channel, side, box)) return true;
  return false;
}

/// Fields at the faces: `face` everywhere, and on a circle what cuts it into sixteen if that is
/// finer.
std::vector<double> size_fields_at_faces(const Problem& problem, const MeshSizes& sizes) {
  std::vector<double> fields, curves;
  Tags all;
  gmsh::model::getEntities(all, 1);
  for (const auto& [dimension, tag] : all) {
    std::vector<double> box(6);
    gmsh::model::getBoundingBox(dimension, tag, box[0], box[1], box[2], box[3], box[4], box[5]);
    if (on_channel(problem.channel, box)) continue;
    curves.push_back(tag);
    std::string kind;
    gmsh::model::getType(dimension, tag, kind);
    if (kind != "Circle") continue;
    std::vector<double> from, to, curvature;
    gmsh::model::getParametrizationBounds(dimension, tag, from, to);
    gmsh::model::getCurvature(dimension, tag, {0.5 * (from[0] + to[0])}, curvature);
    const double sixteenth = 2.0 * (2.0 * std::numbers::pi / curvature[0]) / 16.0;
    if (sixteenth < sizes.face)
      fields.push_back(size_field("CurvesList", {static_cast<double>(tag)}, sixteenth, sizes));
  }
  if (!curves.empty()) fields.push_back(size_field("CurvesList", curves, sizes.face, sizes));
  return fields;
}

/// The channel's no-slip sides, as far as they are left.
std::vector<double> no_slip_sides(const Problem& problem) {
  std::vector<double> found;
  Tags all;
  gmsh::model::getEntities(all, 1);
  for (const auto& [dimension, tag] : all) {
    std::vector<double> box(6);
    gmsh::model::getBoundingBox(dimension, tag, box[0], box[1], box[2], box[3], box[4], box[5]);
    for (const Side side : {Side::left, Side::right, Side::bottom, Side::top})
      if (is_no_slip(problem, side) && lies_on(problem.channel, side, box)) found.push_back(tag);
  }
  return found;
}

/// Whether a point is a corner of a polygon around which the fluid flows.
bool is_edge_in_the_flow(const Problem& problem, const dealii::Point<2>& x) {
  const double tolerance = 1e-6 * (problem.channel.to[0] - problem.channel.from[0]);
  for (const CurvedWall& wall : problem.curved_walls)
    if (wall.shape == CurvedWall::Shape::polygon && !wall.fluid_inside)
      for (const Point& corner : wall.corners)
        if (x.distance(dealii::Point<2>(corner[0], corner[1])) < tolerance) return true;
  return false;
}

/// `sizes`: twice what is wanted, see build_unstructured.
void set_sizes(const Problem& problem, const MeshSizes& sizes,
               const std::vector<std::vector<int>>& surfaces) {
  std::vector<double> fields = size_fields_at_faces(problem, sizes), clamped, free;
  for (std::size_t i = 1; i < surfaces.size(); ++i)
    for (const int surface : surfaces[i]) {
      Tags points;
      gmsh::model::getBoundary({{2, surface}}, points, false, false, true);
      for (const auto& [dimension, tag] : points) {
        std::vector<double> box(6);
        gmsh::model::getBoundingBox(dimension, tag, box[0], box[1], box[2], box[3], box[4], box[5]);
        const dealii::Point<2> at(0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]));
        const bool held = on_channel(problem.channel, box) || wall_through(problem, at, at) >= 0;
        (held ? clamped : free).push_back(tag);
      }
    }
  Tags points;
  gmsh::model::getEntities(points, 0);
  for (const auto& [dimension, tag] : points) {
    std::vector<double> x;
    gmsh::model::getValue(dimension, tag, {}, x);
    if (is_edge_in_the_flow(problem, {x[0], x[1]})) free.push_back(tag);
  }
  const std::vector<double> sides = no_slip_sides(problem);
  if (sizes.wall > 0.0 && !sides.empty())
    fields.push_back(size_field("CurvesList", sides, sizes.wall, sizes));
  if (!clamped.empty())
    fields.push_back(size_field("PointsList", clamped, sizes.clamp_corner, sizes));
  if (!free.empty()) fields.push_back(size_field("PointsList", free, sizes.free_corner, sizes));
  for (const char* source :
       {"MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"})
    gmsh::option::setNumber(std::string("Mesh.") + source, 0.0);
  gmsh::option::setNumber("Mesh.MeshSizeMax", sizes.bulk);
  if (fields.empty()) return;
  const int least = gmsh::model::mesh::field::add("Min");
  gmsh::model::mesh::field::setNumbers(least, "FieldsList", fields);
  gmsh::model::mesh::field::setAsBackgroundMesh(least);
}

/// Distance of a point from a polygon's nearest side.
double distance_to(const std::vector<Point>& corners, const dealii::Point<2>& x) {
  double least = 1e300;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const dealii::Point<2> a(corners[i][0], corners[i][1]);
    const Point& next = corners[(i + 1) % corners.size()];
    const dealii::Tensor<1, 2> side = dealii::Point<2>(next[0], next[1]) - a;
    const double s = std::clamp(((x - a) * side) / side.norm_square(), 0.0, 1.0);
    least = std::min(least, x.distance(a + s * side));
  }
  return least;
}

}  // namespace

int wall_through(const Problem& problem, const dealii::Point<2>& a, const dealii::Point<2>& b) {
  const double tolerance = 1e-6 * (problem.channel.to[0] - problem.channel.from[0]);
  for (std::size_t i = 0; i < problem.curved_walls.size(); ++i) {
    const CurvedWall& wall = problem.curved_walls[i];
    const auto off = [&](const dealii::Point<2>& x) {
      return wall.shape == CurvedWall::Shape::circle
                 ? std::abs(x.distance(dealii::Point<2>(wall.centre[0], wall.centre[1])) -
                            wall.radius)
                 : distance_to(wall.corners, x);
    };
    if (off(a) < tolerance && off(b) < tolerance) return static_cast<int>(i);
  }
  return -1;
}

std::vector<std::vector<int>> build_unstructured(const Problem& problem, const MeshSizes& sizes) {
  auto surfaces = build_surfaces(problem, sizes.bodies_only);
  // Every cell of the triangles' pairs is split once more by the subdivision that leaves only
  // quadrilaterals.
  MeshSizes doubled = sizes;
  for (double* size :
       {&doubled.bulk, &doubled.clamp_corner, &doubled.free_corner, &doubled.face, &doubled.wall})
    *size *= 2.0;
  set_sizes(problem, doubled, surfaces);
  // Frontal-Delaunay triangles, paired: the variant made for quadrilaterals (8) crashes in
  // Gmsh 4.8.
  gmsh::option::setNumber("Mesh.Algorithm", 6);
  gmsh::option::setNumber("Mesh.RecombineAll", 1);
  gmsh::option::setNumber("Mesh.RecombinationAlgorithm", 1);
  gmsh::option::setNumber("Mesh.SubdivisionAlgorithm", 1);
  gmsh::model::mesh::generate(2);
  return surfaces;
}

}  // namespace sprung::reference
