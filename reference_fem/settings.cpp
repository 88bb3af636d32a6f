#include "reference_fem/settings.hpp"

#include "scene/body_shape.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sprung::reference {
namespace {

double positive(const Table& table, const std::string& key, const Dimension& dimension,
                const std::string& fallback) {
  const double value = table.quantity_or(key, dimension, fallback);
  if (!(value > 0.0)) table.refuse(key, "must be positive");
  return value;
}

std::string length(double metres) {
  return fmt::format("{:.6g} m", metres);
}
std::string duration(double seconds) {
  return fmt::format("{:.6g} s", seconds);
}

MeshSizes read_sizes(const Table& table, const Problem& problem) {
  MeshSizes sizes;
  sizes.bulk = table.quantity("cell_size", dimension::length);
  const double height = problem.channel.to[1] - problem.channel.from[1];
  if (!(sizes.bulk > 0.0) || sizes.bulk > height / 2.0)
    table.refuse("cell_size", fmt::format("must be positive and at most half the channel's height "
                                          "({:.6g} m)",
                                          height / 2.0));
  sizes.clamp_corner =
      positive(table, "clamp_corner_size", dimension::length, length(0.05 * sizes.bulk));
  sizes.free_corner =
      positive(table, "free_corner_size", dimension::length, length(0.05 * sizes.bulk));
  sizes.face = positive(table, "face_size", dimension::length, length(0.5 * sizes.bulk));
  if (table.has("wall_size")) {
    sizes.wall = table.quantity("wall_size", dimension::length);
    if (!(sizes.wall > 0.0 && sizes.wall <= sizes.bulk))
      table.refuse("wall_size", "must be positive and at most cell_size");
  }
  sizes.growth = table.number_or("growth", 2.0);
  if (!(sizes.growth > 1.0 && sizes.growth <= 4.0))
    table.refuse("growth",
                 "must lie above 1 and not beyond 4: ratio of neighbouring cells before splitting");
  sizes.splittings = static_cast<int>(table.integer_or("splittings", 1));
  if (sizes.splittings < 0 || sizes.splittings > 4)
    table.refuse("splittings",
                 "must be 0 to 4: how often every cell of Gmsh's mesh is split into four");
  return sizes;
}

/// Effects of a scene that this solver does not have.
void refuse_missing_effects(const Document& document, const Problem& problem) {
  if (problem.periodic)
    document.table("periodic")
        .refuse("axes",
                "the finite element reference has no periodic sides; use the particle solver");
  for (const Solid& solid : problem.solids)
    if (is_oblique(solid))
      document.table("solid." + solid.name)
          .refuse("body",
                  "the finite element reference has only bodies along the axes; leave out "
                  "angle_degrees, or use the particle solver");
  for (const Solid& solid : problem.solids)
    if (solid.stiffening || solid.viscoelasticity || solid.fibre)
      document.table("solid." + solid.name)
          .refuse("",
                  "the finite element reference has no stiffening, viscoelastic or fibre; "
                  "remove that table, or use the particle solver");
  if (problem.viscosity && problem.viscosity->carreau_yasuda)
    document.table("viscosity.carreau_yasuda")
        .refuse("",
                "the finite element reference has a constant viscosity only; remove that table, or "
                "use the particle solver");
  for (const CurvedWall& wall : problem.curved_walls)
    if (!wall.no_slip)
      document.table("curved_wall." + wall.name)
          .refuse("slip",
                  "the finite element reference has only no-slip curved walls; write \"no_slip\"");
  for (const CurvedWall& wall : problem.curved_walls)
    if (wall.shape != CurvedWall::Shape::circle && wall.shape != CurvedWall::Shape::polygon)
      document.table("curved_wall." + wall.name)
          .refuse("",
                  "the finite element reference meshes circles and polygons; give one of them, or "
                  "use the particle solver");
  if (problem.curved_walls.size() > most_obstacles)
    document.root().refuse(
        "curved_wall",
        fmt::format("the finite element reference takes at most {} of them", most_obstacles));
}

void check_problem(const Document& document, const Problem& problem, bool bodies_only) {
  refuse_missing_effects(document, problem);
  if (problem.dimension != 2)
    document.table("domain").refuse("channel",
                                    "the finite element reference is two-dimensional; "
                                    "give two coordinates");
  if (bodies_only) return;
  if (!problem.viscosity || !(problem.viscosity->dynamic > 0.0))
    document.root().refuse("viscosity",
                           "the finite element reference needs a viscous fluid; write "
                           "[viscosity] dynamic = \"1 Pa s\"");
  int closed = problem.inflow ? 1 : 0;
  if (problem.walls)
    closed += static_cast<int>(problem.walls->no_slip.size() + problem.walls->free_slip.size());
  if (problem.inflow && closed >= 4)
    document.table("inflow").refuse(
        "side", "what flows in must be able to leave; write [outflow] with a side");
}

}  // namespace

TimeScheme scheme_named(const std::string& name) {
  if (name == "esdirk3") return esdirk3();
  if (name == "backward_euler") return backward_euler();
  return tr_bdf2();
}

TimeScheme starter_of(const TimeScheme& scheme) {
  if (!scheme.explicit_first) return scheme;
  return scheme.order == 3 ? sdirk3() : sdirk2();
}

Settings read_settings(Document& document, const Problem& problem) {
  const Table table = document.table("reference_fem");
  Settings settings;
  settings.sizes = read_sizes(table, problem);
  settings.sizes.unstructured =
      table.word_or("mesh", {"blocks", "unstructured"}, "blocks") == "unstructured";
  settings.sizes.bodies_only = table.flag_or("bodies_only", false);
  if (settings.sizes.bodies_only && problem.solids.empty())
    table.refuse("bodies_only", "the scene has no body; add one, such as [solid.beam]");
  check_problem(document, problem, settings.sizes.bodies_only);
  settings.degree = static_cast<int>(table.integer_or("degree", 2));
  if (settings.degree != 2 && settings.degree != 3)
    table.refuse("degree", "must be 2 or 3: polynomial degree of velocity and displacement");
  settings.time_step = positive(table, "time_step", dimension::time, "10 ms");
  settings.largest_time_step =
      positive(table, "largest_time_step", dimension::time, duration(settings.time_step));
  if (settings.largest_time_step < settings.time_step)
    table.refuse("largest_time_step", "must not be smaller than time_step");
  settings.step_tolerance = table.number_or("step_tolerance", 1e-5);
  if (!(settings.step_tolerance > 0.0)) table.refuse("step_tolerance", "must be positive");
  settings.scheme = scheme_named(
      table.word_or("time_scheme", {"tr_bdf2", "esdirk3", "backward_euler"}, "tr_bdf2"));
  settings.starter = starter_of(settings.scheme);
  settings.poisson_ratio = table.number_or("poisson_ratio", 0.4999);
  if (!(settings.poisson_ratio > 0.0 && settings.poisson_ratio <= 0.5))
    table.refuse("poisson_ratio", "must lie above 0 and not beyond 0.5; the paper's is 0.4999");
  settings.solid_density = positive(table, "solid_density", dimension::density,
                                    fmt::format("{:.17g} kg/m3", problem.density));
  settings.law = table.word_or("material", {"neo_hookean", "st_venant_kirchhoff"}, "neo_hookean") ==
                         "neo_hookean"
                     ? MaterialLaw::neo_hookean
                     : MaterialLaw::st_venant_kirchhoff;
  settings.newton.tolerance = table.number_or("newton_tolerance", 1e-6);
  if (!(settings.newton.tolerance > 0.0 && settings.newton.tolerance < 1e-2))
    table.refuse("newton_tolerance", "must lie between 0 and 0.01");
  settings.mesh_stiffening = table.number_or("mesh_stiffening", 1.25);
  if (!(settings.mesh_stiffening >= 0.0 && settings.mesh_stiffening <= 3.0))
    table.refuse("mesh_stiffening", "must lie between 0 and 3");
  settings.checkpoint_every =
      positive(table, "checkpoint_every", dimension::time, duration(problem.end_time / 6.0));
  document.leave_unread("sph");
  document.leave_unread("numerics");
  return settings;
}

}  // namespace sprung::reference
