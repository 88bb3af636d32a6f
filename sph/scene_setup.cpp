#include "sph/scene_setup.hpp"

#include "scene/body_shape.hpp"
#include "sph/effects/registry.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <numeric>
#include <random>
#include <sstream>

#include <fmt/format.h>

namespace sprung::sph {

ModulusTable::ModulusTable(std::filesystem::path file) : file_(std::move(file)) {
  std::ifstream in(file_);
  if (!in)
    throw std::runtime_error(file_.string() +
                             ": no calibration table; `sprung calibrate` makes it");
  std::string line;
  std::getline(in, line);  // header
  for (int number = 2; std::getline(in, line); ++number) {
    if (line.empty()) continue;
    std::istringstream cells(line);
    Row row;
    char comma;
    if (!(cells >> row.dimension >> comma) || !std::getline(cells, row.bonds, ',') ||
        !(cells >> row.area_stiffness >> comma >> row.modulus_per_stiffness))
      throw std::runtime_error(fmt::format("{}:{}: cannot read '{}'; `sprung calibrate` remakes it",
                                           file_.string(), number, line));
    rows_.push_back(row);
  }
}

double ModulusTable::modulus_per_stiffness(int dimension, Bonds bonds,
                                           double area_stiffness) const {
  const std::string name = bonds == Bonds::equal ? "equal" : "isotropic";
  for (const Row& row : rows_)
    if (row.dimension == dimension && row.bonds == name &&
        std::abs(row.area_stiffness - area_stiffness) <= 1e-9 * (1.0 + area_stiffness))
      return row.modulus_per_stiffness;
  std::string have;
  for (const Row& row : rows_)
    have += fmt::format("\n  {}D, {} bonds, area stiffness {}", row.dimension, row.bonds,
                        row.area_stiffness);
  throw std::runtime_error(
      fmt::format("{}: no calibration for {}D, {} bonds, area stiffness {}; there are:{}\n"
                  "`sprung calibrate --area-stiffness {}` adds it",
                  file_.string(), dimension, name, area_stiffness, have, area_stiffness));
}

namespace {

template <int dim>
bool inside(const Box& box, const Vector<dim>& x) {
  for (int d = 0; d < dim; ++d)
    if (x[d] < box.from[d] || x[d] > box.to[d]) return false;
  return true;
}

/// How many lattice cells fit each side of the channel.
template <int dim>
std::array<long, dim> lattice_counts(const Box& channel, double spacing, const Table& table) {
  std::array<long, dim> count;
  double total = 1.0;
  for (int d = 0; d < dim; ++d) {
    const double extent = channel.to[d] - channel.from[d];
    count[d] = std::lround(extent / spacing);
    if (count[d] < 4 || std::abs(count[d] * spacing - extent) > 1e-6 * extent)
      table.refuse(
          "spacing",
          fmt::format("must divide the channel's side of {} m into at least 4 whole parts; "
                      "nearest that does: {} mm",
                      extent, 1e3 * extent / std::max(4L, count[d])));
    total *= static_cast<double>(count[d]);
  }
  if (total > 5e7) table.refuse("spacing", fmt::format("would make {:.3g} particles", total));
  return count;
}

/// Keeps the sites on the fluid's side of the shaped walls: as many as the volume there holds,
/// those deepest in the fluid first. A cell that a wall cuts counts by its part inside.
template <int dim>
void keep_inside_walls(std::vector<Vector<dim>>& sites, double spacing,
                       const std::vector<ShapedWall<dim>>& walls) {
  if (walls.empty()) return;
  std::vector<WallView<dim>> nearest(sites.size());
  double volume = 0.0;
  for (std::size_t k = 0; k < sites.size(); ++k) {
    nearest[k].distance = std::numeric_limits<double>::infinity();
    for (const auto& wall : walls)
      if (const auto view = wall.shape->view(sites[k]); view.distance < nearest[k].distance)
        nearest[k] = view;
    volume += std::clamp(0.5 + nearest[k].distance / spacing, 0.0, 1.0);
  }
  std::vector<double> sorted;
  for (const auto& view : nearest) sorted.push_back(view.distance);
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  const auto wanted = std::min(static_cast<std::size_t>(std::lround(volume)), sites.size());
  if (wanted == 0) return sites.clear();
  // Equal depths stand or fall together. What lies on the wall or just beyond it is brought in,
  // from where relaxing spreads it.
  const double least = sorted[wanted - 1] - 1e-9 * spacing;
  std::vector<Vector<dim>> kept;
  for (std::size_t k = 0; k < sites.size(); ++k)
    if (nearest[k].distance >= least)
      kept.push_back(sites[k] +
                     std::max(0.0, 0.25 * spacing - nearest[k].distance) * nearest[k].normal);
  sites.swap(kept);
}

/// How far `x` lies inside the body from its nearest face, m; negative outside.
template <int dim>
double depth_in(const Solid& solid, const Vector<dim>& x) {
  Point place{};
  for (int d = 0; d < dim; ++d) place[d] = x[d];
  const Point own = to_own(solid, place), extent = own_extent(solid);
  double depth = std::numeric_limits<double>::infinity();
  for (int d = 0; d < dim; ++d) depth = std::min({depth, own[d], extent[d] - own[d]});
  return depth;
}

/// Takes as many sites from the fluid as fill the body's volume (`cells`, in lattice cells), those
/// deepest in the body; equal depths in the order of the lattice. As many as the body has particles
/// would leave a gap or a bulge where its own cells are smaller or larger, which the density
/// feedback would push through the channel when the run starts.
template <int dim>
void make_room(std::vector<Vector<dim>>& fluid, const Solid& solid, double cells) {
  std::vector<std::pair<double, std::size_t>> depth(fluid.size());
  for (std::size_t k = 0; k < fluid.size(); ++k) depth[k] = {-depth_in<dim>(solid, fluid[k]), k};
  const std::size_t count = std::min(static_cast<std::size_t>(std::lround(cells)), fluid.size());
  std::nth_element(depth.begin(), depth.begin() + static_cast<std::ptrdiff_t>(count), depth.end());
  std::vector<bool> taken(fluid.size(), false);
  for (std::size_t k = 0; k < count; ++k) taken[depth[k].second] = true;
  std::vector<Vector<dim>> kept;
  for (std::size_t k = 0; k < fluid.size(); ++k)
    if (!taken[k]) kept.push_back(fluid[k]);
  fluid.swap(kept);
}

/// Of each body, whether it has a lattice of its own: where it lies at an angle and, if such bodies
/// are to be `fitted`, where it does not fill whole cells of the fluid's lattice.
template <int dim>
std::vector<bool> bodies_off_lattice(const Problem& problem, double spacing, bool fitted) {
  const auto on_plane = [&](double face, int d) {
    const double place = (face - problem.channel.from[d]) / spacing;
    return std::abs(place - std::round(place)) < 1e-6;
  };
  std::vector<bool> off;
  for (const Solid& solid : problem.solids) {
    bool fills_cells = true;
    for (int d = 0; d < dim; ++d)
      fills_cells = fills_cells && on_plane(solid.body.from[d], d) && on_plane(solid.body.to[d], d);
    off.push_back(is_oblique(solid) || (fitted && !fills_cells));
  }
  return off;
}

/// Particles at the centres of cubes of side `spacing` that fill the channel; solids first. The
/// particles of a body off that lattice are fitted to it.
template <int dim>
Particles<dim> fill_lattice(const Problem& problem, double spacing,
                            const std::vector<bool>& off_lattice, const Table& table,
                            const std::vector<ShapedWall<dim>>& walls,
                            std::vector<BodyRange>& bodies) {
  Particles<dim> particles;
  particles.spacing = spacing;
  particles.volume = std::pow(spacing, dim);
  particles.density = problem.density;
  const auto count = lattice_counts<dim>(problem.channel, spacing, table);
  std::vector<std::vector<Vector<dim>>> solid(problem.solids.size());
  std::vector<Vector<dim>> fluid;
  for_each_index<dim>(count, [&](const std::array<long, dim>& at) {
    Vector<dim> x;
    for (int d = 0; d < dim; ++d) x[d] = problem.channel.from[d] + (at[d] + 0.5) * spacing;
    std::size_t body = 0;
    while (body < solid.size() && (off_lattice[body] || !inside<dim>(problem.solids[body].body, x)))
      ++body;
    (body < solid.size() ? solid[body] : fluid).push_back(x);
  });
  keep_inside_walls(fluid, spacing, walls);
  for (std::size_t b = 0; b < solid.size(); ++b)
    if (off_lattice[b]) {
      solid[b] = fitted_places<dim>(problem.solids[b], spacing);
      const auto cells = cell_volumes<dim>(problem.solids[b], solid[b], spacing, true);
      make_room<dim>(fluid, problem.solids[b],
                     std::accumulate(cells.begin(), cells.end(), 0.0) / particles.volume);
    }
  for (std::size_t b = 0; b < solid.size(); ++b) {
    const std::size_t first = particles.size();
    for (const auto& x : solid[b]) particles.add(x, Vector<dim>::Zero(), 0.0, Role::solid);
    bodies.push_back({problem.solids[b].name, first, particles.size()});
  }
  particles.solids = particles.size();
  for (const auto& x : fluid) particles.add(x, Vector<dim>::Zero(), 0.0, Role::fluid);
  particles.unknowns = particles.size();
  return particles;
}

/// Moves each fluid particle by up to `disorder` spacings along each axis. Numbers are drawn from
/// the generator's own bits, so a seed means the same places everywhere.
template <int dim>
void disturb(Particles<dim>& particles, double disorder, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  for (std::size_t i = particles.solids; i < particles.size(); ++i)
    for (int d = 0; d < dim; ++d) {
      const double unit = static_cast<double>(generator() >> 11) * 0x1p-53;
      particles.position[i][d] += disorder * particles.spacing * (2.0 * unit - 1.0);
    }
}

/// A body must hold at least two particles across each side; fewer than four is worth a warning.
template <int dim>
void check_thickness(const Document& document, const Problem& problem, double spacing, bool fitted,
                     const Particles<dim>& particles, const std::vector<BodyRange>& bodies,
                     std::vector<std::string>& warnings) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Table table = document.table("solid." + bodies[b].name);
    if (bodies[b].first == bodies[b].last)
      table.refuse("body", fmt::format("holds no particle at a spacing of {} mm; use a smaller one",
                                       1e3 * spacing));
    const Solid& solid = problem.solids[b];
    Vector<dim> low = particles.position[bodies[b].first], high = low;
    for (std::size_t i = bodies[b].first; i < bodies[b].last; ++i) {
      low = low.cwiseMin(particles.position[i]);
      high = high.cwiseMax(particles.position[i]);
    }
    for (int d = 0; d < dim; ++d) {
      const double extent = own_extent(solid)[d];
      const long layers = fitted || is_oblique(solid)
                              ? std::max(1L, std::lround(extent / spacing))
                              : std::lround((high[d] - low[d]) / spacing) + 1;
      if (layers < 2)
        table.refuse(
            "body",
            fmt::format("is one particle thick ({} mm at a spacing of {} mm), and one row of "
                        "springs does not resist bending; a spacing of {:.4g} mm gives four",
                        1e3 * extent, 1e3 * spacing, 1e3 * extent / 4));
      if (layers < 4)
        warnings.push_back(fmt::format("[solid.{}] is {} particles thick; bending wants 4 or more",
                                       solid.name, layers));
    }
  }
}

template <int dim>
std::vector<Wall<dim>> walls_of(const Problem& problem) {
  std::vector<Wall<dim>> walls;
  if (!problem.walls) return walls;
  const auto add = [&](Side side, bool no_slip) {
    const auto plane = open_plane<dim>(problem.channel, side);
    walls.push_back({plane.axis, plane.place, -plane.outward, no_slip, Vector<dim>::Zero()});
  };
  for (const Side side : problem.walls->no_slip) add(side, true);
  for (const Side side : problem.walls->free_slip) add(side, false);
  return walls;
}

template <int dim>
std::vector<PeriodicAxis> periodic_axes(const Problem& problem) {
  std::vector<PeriodicAxis> axes;
  if (!problem.periodic) return axes;
  for (int d = 0; d < dim; ++d)
    if (problem.periodic->axis[d])
      axes.push_back({d, problem.channel.from[d], problem.channel.to[d]});
  return axes;
}

/// `reach`: of the kernel; a mirror in a wall of smaller radius would fall past its centre.
template <int dim>
std::vector<ShapedWall<dim>> shaped_walls(const Document& document, const Problem& problem,
                                          double reach) {
  std::vector<ShapedWall<dim>> walls;
  const Vector<dim> low = as_vector<dim>(problem.channel.from) - Vector<dim>::Constant(reach);
  const Vector<dim> high = as_vector<dim>(problem.channel.to) + Vector<dim>::Constant(reach);
  for (const auto& wall : problem.curved_walls) {
    const Table table = document.table("curved_wall." + wall.name);
    std::shared_ptr<const WallShape<dim>> shape;
    try {
      shape = wall_shape<dim>(wall);
    } catch (const std::runtime_error& error) {
      table.refuse("surface", error.what());
    }
    if (!(shape->smallest_radius(low, high) > reach))
      table.refuse("", fmt::format("is curved to a radius of {:.4g} m, less than the kernel's "
                                   "reach of {:.4g} m; use a smaller spacing",
                                   shape->smallest_radius(low, high), reach));
    walls.push_back({std::move(shape), wall.no_slip});
  }
  return walls;
}

/// Gives the fluid the velocity that the scene starts with; solids start at rest. Returns the
/// fastest.
template <int dim>
double start_velocity(const Problem& problem, const Document& document, Particles<dim>& particles) {
  if (problem.initial_velocity.empty()) return 0.0;
  double fastest = 0.0;
  for (std::size_t i = particles.solids; i < particles.unknowns; ++i) {
    std::array<double, 3> x{};
    for (int d = 0; d < dim; ++d) x[d] = particles.position[i][d];
    for (int d = 0; d < dim; ++d) particles.velocity[i][d] = problem.initial_velocity[d].value(x);
    const double speed = particles.velocity[i].norm();
    if (!std::isfinite(speed))
      document.table("initial").refuse(
          "velocity", fmt::format("is not finite at ({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]));
    fastest = std::max(fastest, speed);
  }
  return fastest;
}

/// The fastest flow that the scene's own numbers show at once; 0 if none does.
double visible_speed(const Problem& problem) {
  // The flow speeds up in narrow places; the inflow's peak alone would be too low a scale.
  double speed = problem.inflow ? 2.0 * 1.5 * problem.inflow->mean_velocity : 0.0;
  for (const auto& motion : problem.wall_motion)
    speed = std::max(speed, std::hypot(motion.velocity[0], motion.velocity[1], motion.velocity[2]));
  return speed;
}

/// The force on a curved wall is read from the layer of fluid about it, which must be its own.
template <int dim>
void add_wall_forces(const Document& document, ParticleScene<dim>& scene) {
  const auto& state = scene.simulation->state();
  const auto& walls = scene.problem.curved_walls;
  for (const auto& probe : scene.problem.probes.force) {
    if (probe.curved_wall.empty()) continue;
    const Table table = document.table("probes." + probe.name);
    const auto wall = std::find_if(walls.begin(), walls.end(),
                                   [&](const auto& w) { return w.name == probe.curved_wall; });
    const auto& shaped = state.images.shaped()[wall - walls.begin()];
    const WallForce<dim> force(state, shaped);
    if (!force.obstacle().empty()) table.refuse("force_on", force.obstacle());
    if (state.balanced_acceleration.norm() > 0.0 && shaped.shape->patches(1.0).empty())
      table.refuse("force_on",
                   "is not measured on a cylinder in space under gravity: the weight of what it "
                   "displaces has no end; leave gravity out");
    scene.wall_forces.emplace(probe.curved_wall, force);
  }
}

/// Sweeps that spread the fluid before the start; a lattice needs none.
constexpr int relaxing_sweeps = 200;

}  // namespace

template <int dim>
ParticleScene<dim> set_up(Document& document, const ModulusTable& table) {
  ParticleScene<dim> scene;
  scene.problem = read_problem(document);
  const Problem& problem = scene.problem;
  const Numerics numerics = read_numerics(document);
  const Table sph = document.table("sph");
  const double spacing = sph.quantity("spacing", dimension::length);
  if (!(spacing > 0.0)) sph.refuse("spacing", "must be positive");
  const double fixed_step = sph.quantity_or("time_step", dimension::time, "0 s");
  if (fixed_step < 0.0) sph.refuse("time_step", "must be positive, or 0 to let the limits decide");
  const double reach = 2.0 * numerics.smoothing_length_ratio * spacing;
  auto shaped = shaped_walls<dim>(document, problem, reach);
  const auto off_lattice = bodies_off_lattice<dim>(problem, spacing, numerics.fitted_bodies);
  auto particles = fill_lattice<dim>(problem, spacing, off_lattice, sph, shaped, scene.bodies);
  if (!shaped.empty() && particles.unknowns == particles.solids)
    document.table("curved_wall." + problem.curved_walls[0].name)
        .refuse("",
                "leaves no room for fluid in the channel; check its place and size, and whether "
                "the fluid is inside or outside");
  const double start_speed = start_velocity(problem, document, particles);
  const double scale =
      sph.quantity_or("velocity_scale", dimension::velocity,
                      fmt::format("{} m/s", std::max(visible_speed(problem), start_speed)));
  if (!(scale > 0.0))
    sph.refuse("velocity_scale",
               "must be given for a scene that shows no speed (no inflow, moving wall or initial "
               "velocity): the fastest flow expected");
  check_thickness<dim>(document, problem, spacing, numerics.fitted_bodies, particles, scene.bodies,
                       scene.warnings);
  // A lattice set in motion all at once is drawn out into rows before shifting has anything to act
  // on, and breaks up late and violently; broken a little from the start it never does.
  const bool impulsive = !problem.initial_velocity.empty() && numerics.preset == "recommended";
  const double disorder = sph.number_or("disorder", impulsive ? 0.25 : 0.0);
  if (disorder < 0.0 || disorder > 0.3)
    sph.refuse("disorder", "is a fraction of the spacing; choose 0 (the lattice) to 0.3");
  const long seed = sph.integer_or("seed", 1);
  if (disorder > 0.0) disturb(particles, disorder, static_cast<std::uint64_t>(seed));
  const bool uneven = disorder > 0.0 || !shaped.empty() ||
                      std::find(off_lattice.begin(), off_lattice.end(), true) != off_lattice.end();
  std::vector<double> solid_volumes;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const auto volumes = cell_volumes<dim>(problem.solids[b],
                                           {particles.position.data() + scene.bodies[b].first,
                                            scene.bodies[b].last - scene.bodies[b].first},
                                           spacing, numerics.fitted_bodies);
    solid_volumes.insert(solid_volumes.end(), volumes.begin(), volumes.end());
  }
  scene.simulation = std::make_unique<Simulation<dim>>(
      numerics, std::move(particles),
      Images<dim>(walls_of<dim>(problem), periodic_axes<dim>(problem), std::move(shaped)));
  auto& simulation = *scene.simulation;
  simulation.set_solid_volumes(std::move(solid_volumes));
  if (problem.inflow) simulation.add_inflow({*problem.inflow, problem.channel, spacing, reach});
  for (const auto& side : {problem.pressure_inflow, problem.outflow})
    if (side) simulation.add_pressure_side({*side, problem.channel, spacing, reach});
  scene.retreat = sph.flag_or("retreat", false);
  add_effects(scene, table);
  document.leave_unread("reference_fem");
  document.refuse_unread();
  simulation.start(scale, fixed_step);
  if (uneven) simulation.relax(relaxing_sweeps);
  // Once more, now at the places where the particles begin.
  start_velocity(problem, document, simulation.state().particles);
  simulation.prescribe();
  add_wall_forces(document, scene);
  return scene;
}

template ParticleScene<2> set_up<2>(Document&, const ModulusTable&);
template ParticleScene<3> set_up<3>(Document&, const ModulusTable&);

}  // namespace sprung::sph
