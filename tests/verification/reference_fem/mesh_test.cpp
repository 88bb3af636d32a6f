/// Meshes of scenes with curved walls that blocks do not fit: areas, names of the rims, sizes, and
/// the flow around a cylinder on one.

#include "reference_fem/simulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace sprung::reference {
namespace {

CurvedWall circle(double x, double y, double radius) {
  CurvedWall wall;
  wall.name = "circle";
  wall.centre = {x, y, 0.0};
  wall.radius = radius;
  return wall;
}

/// A channel with a circle, a triangle, and a beam on its floor.
Problem crowded() {
  Problem problem;
  problem.channel = {{0, 0, 0}, {1.0, 0.4, 0}};
  problem.density = 1.0;
  CurvedWall triangle;
  triangle.name = "triangle";
  triangle.shape = CurvedWall::Shape::polygon;
  triangle.corners = {{0.45, 0.25, 0}, {0.55, 0.25, 0}, {0.5, 0.33, 0}};
  problem.curved_walls = {circle(0.2, 0.2, 0.05), triangle};
  Solid beam;
  beam.name = "beam";
  beam.body = {{0.7, 0, 0}, {0.72, 0.15, 0}};
  beam.youngs_modulus = 1e5;
  beam.clamped = Side::bottom;
  problem.solids = {beam};
  return problem;
}

TEST(UnstructuredMesh, HasTheScenesAreasRimsAndSizes) {
  for (const int splittings : {0, 1}) {
    dealii::Triangulation<2> mesh;
    const MeshSizes sizes = {0.04, 0.004, 0.004, 0.01, 2.0, splittings};
    const MeshQuality quality = make_mesh(crowded(), sizes, mesh);
    EXPECT_GT(quality.min_scaled_jacobian, 0.2);
    EXPECT_LT(quality.max_size, 2.0 * sizes.bulk);
    EXPECT_LT(quality.min_size, 1.5 * sizes.clamp_corner);
    const Space space(mesh, 2);  // its edges are parabolas: the circle's area to fourth order
    double fluid = 0.0, solid = 0.0;
    for (int c = 0; c < space.cells(); ++c)
      for (int q = 0; q < space.points_per_cell(); ++q)
        (space.body(c) == 0 ? fluid : solid) += space.weight(c)[q];
    EXPECT_NEAR(solid, 0.02 * 0.15, 1e-12);
    EXPECT_NEAR(fluid, 0.4 - 0.003 - 0.004 - std::numbers::pi * 0.0025, 1e-6);
    std::map<unsigned, double> rim;
    for (const BoundaryFace& face : space.boundary())
      for (const Vec2& n : face.normal_weight) rim[face.boundary] += std::hypot(n[0], n[1]);
    EXPECT_NEAR(rim[obstacle_id], 2.0 * std::numbers::pi * 0.05, 1e-5);
    EXPECT_NEAR(rim[obstacle_id + 1], 0.1 + 2.0 * std::hypot(0.05, 0.08), 1e-12);
    EXPECT_NEAR(rim[static_cast<unsigned>(Side::left)], 0.4, 1e-12);
    EXPECT_NEAR(rim[static_cast<unsigned>(Side::bottom)], 1.0, 1e-12);
  }
}

/// Largest and smallest height of the cells at the floor, the channel being empty but for
/// `problem`.
std::pair<double, double> heights_at_the_floor(const Problem& problem, const MeshSizes& sizes) {
  dealii::Triangulation<2> mesh;
  make_mesh(problem, sizes, mesh);
  double least = 1.0, most = 0.0;
  for (const auto& cell : mesh.active_cell_iterators())
    for (const unsigned f : cell->face_indices())
      if (cell->face(f)->at_boundary() && std::abs(cell->face(f)->center()[1]) < 1e-12) {
        const double height = cell->measure() / cell->face(f)->measure();
        least = std::min(least, height);
        most = std::max(most, height);
      }
  return {least, most};
}

TEST(Mesh, IsRefinedAtNoSlipSides) {
  Problem problem;
  problem.channel = {{0, 0, 0}, {1.0, 0.4, 0}};
  problem.walls = Walls{{Side::bottom}, {Side::top}};
  for (const bool unstructured : {false, true}) {
    MeshSizes sizes = {0.08, 0.02, 0.02, 0.03, 2.0, 1, false, unstructured};
    const auto [coarse, coarsest] = heights_at_the_floor(problem, sizes);
    sizes.wall = 0.01;
    const auto [fine, finest] = heights_at_the_floor(problem, sizes);
    // Blocks round their counts; pairs of triangles vary by half.
    EXPECT_GT(fine, 0.5 * sizes.wall);
    EXPECT_LT(finest, 2.0 * sizes.wall);
    EXPECT_GT(coarse, 1.5 * finest);
  }
}

/// Two circles and a triangle in a stream, which no blocks fit: what a space that did not hang
/// together would lose, the balances show.
TEST(UnstructuredMesh, AFlowAroundTwoCirclesAndATriangleKeepsItsBalances) {
  Problem problem = crowded();
  problem.solids.clear();
  problem.curved_walls.push_back(circle(0.33, 0.1, 0.03));
  problem.end_time = 200.0;
  problem.viscosity = Viscosity{0.05};  // viscous time H^2/(pi^2 nu) = 0.3 s
  problem.walls = Walls{{Side::bottom, Side::top}, {}};
  problem.inflow = Inflow{Side::left, Inflow::Profile::parabolic, 0.05, 0.0, {}};
  problem.outflow = PressureSide{};
  Settings s;
  s.sizes = {0.08, 0.02, 0.02, 0.03, 2.0, 0};
  s.time_step = s.largest_time_step = 20.0;
  s.scheme = s.starter = scheme_named("backward_euler");
  s.mesh_stiffening = 1.25;
  s.checkpoint_every = 1e9;
  s.newton.tolerance = 1e-10;
  Simulation simulation(problem, s);
  while (simulation.state().time < problem.end_time) simulation.advance(problem.end_time);
  const Fields& fields = simulation.state().now;
  const Balance b = balance(simulation.system(), fields, simulation.integration().weights());
  EXPECT_NEAR(b.inflow, 0.05 * 0.4, 1e-12);
  EXPECT_NEAR(b.outflow, b.inflow, 1e-9 * b.inflow);
  // Steady: what goes in, less what is carried out, is dissipated. Transients decay by 1/60 a step.
  EXPECT_NEAR(b.power / b.dissipation, 1.0, 1e-6);
  for (int wall = 0; wall < 3; ++wall)
    EXPECT_GT(
        simulation.system().force_on_wall(wall, fields, simulation.integration().weights())[0],
        0.0);
}

TEST(UnstructuredMesh, FluidInsideACircle) {
  Problem problem;
  problem.channel = {{-1, -1, 0}, {1, 1, 0}};
  problem.curved_walls = {circle(0, 0, 0.8)};
  problem.curved_walls[0].fluid_inside = true;
  dealii::Triangulation<2> mesh;
  make_mesh(problem, {0.2, 0.1, 0.1, 0.1, 2.0, 1}, mesh);
  const Space space(mesh, 2);
  double area = 0.0;
  for (int c = 0; c < space.cells(); ++c)
    for (int q = 0; q < space.points_per_cell(); ++q) area += space.weight(c)[q];
  EXPECT_NEAR(area, std::numbers::pi * 0.64, 1e-4);
}

}  // namespace
}  // namespace sprung::reference
