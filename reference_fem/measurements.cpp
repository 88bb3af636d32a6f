#include "reference_fem/measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace sprung::reference {
namespace {

/// Fields at one quadrature point of a cell.
struct Sample {
  Matrix2 f = {1, 0, 0, 1};
  Matrix2 grad_v{};  ///< d v_i / d X_K
  Vec2 v{};
  double p = 0.0;
};

Sample sample(const Space& space, const Fields& fields, int cell, int q) {
  Sample s;
  const int na = space.nodes_per_cell();
  for (int a = 0; a < na; ++a) {
    const auto n = 2 * static_cast<std::size_t>(space.cell_nodes(cell)[a]);
    const double bx = space.grad_x(cell)[q * na + a], by = space.grad_y(cell)[q * na + a];
    for (std::size_t i = 0; i < 2; ++i) {
      s.f[2 * i] += bx * fields.displacement[n + i];
      s.f[2 * i + 1] += by * fields.displacement[n + i];
      s.grad_v[2 * i] += bx * fields.velocity[n + i];
      s.grad_v[2 * i + 1] += by * fields.velocity[n + i];
      s.v[i] += space.value(q)[a] * fields.velocity[n + i];
    }
  }
  const int np = space.pressures_per_cell();
  for (int m = 0; m < np; ++m)
    s.p += space.pressure_value(cell)[q * np + m] *
           fields.pressure[static_cast<std::size_t>(cell * np + m)];
  return s;
}

/// Smallest and largest singular value.
std::array<double, 2> principal_stretches(const Matrix2& f) {
  const double a = std::hypot(f[0] + f[3], f[1] - f[2]), b = std::hypot(f[0] - f[3], f[1] + f[2]);
  return {0.5 * (a - b), 0.5 * (a + b)};
}

void add_fluid(const FluidStructure& system, const Sample& s, double w, const Vec2& gravity,
               Balance& sum) {
  const double j = determinant(s.f);
  const Matrix2 c = cofactor(s.f);
  Matrix2 d{};  // d v_i / d x_j
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 2; ++k)
      d[2 * i + k] = (s.grad_v[2 * i] * c[2 * k] + s.grad_v[2 * i + 1] * c[2 * k + 1]) / j;
  const double rho = system.problem().density;
  sum.kinetic_fluid += w * j * 0.5 * rho * (s.v[0] * s.v[0] + s.v[1] * s.v[1]);
  const double shear = d[1] + d[2];
  sum.dissipation +=
      w * j * system.viscosity() * (2 * d[0] * d[0] + 2 * d[3] * d[3] + shear * shear);
  sum.rms_divergence += w * j * (d[0] + d[3]) * (d[0] + d[3]);
  sum.smallest_volume_ratio = std::min(sum.smallest_volume_ratio, j);
  sum.fluid_area += w * j;
  sum.power += w * j * rho * (gravity[0] * s.v[0] + gravity[1] * s.v[1]);
}

void add_solid(const Material& material, const Sample& s, double w, const Vec2& gravity,
               Balance& sum) {
  sum.kinetic_solid += w * 0.5 * material.density * (s.v[0] * s.v[0] + s.v[1] * s.v[1]);
  // Of the volume strain only the part that the pressure sees stores energy: lambda/2 (p/lambda)^2.
  sum.elastic += w * (material.shape_energy(s.f) + 0.5 * s.p * s.p / material.lame);
  sum.power += w * material.density * (gravity[0] * s.v[0] + gravity[1] * s.v[1]);
  sum.solid_area += w * determinant(s.f);
  sum.solid_area_at_rest += w;
  const auto [least, most] = principal_stretches(s.f);
  sum.min_stretch = std::min(sum.min_stretch, least);
  sum.max_stretch = std::max(sum.max_stretch, most);
}

/// Flow through the sides, and the energy it carries.
void add_boundary(const FluidStructure& system, const Fields& fields, Balance& sum) {
  const Space& space = system.space();
  const auto na = static_cast<std::size_t>(space.nodes_per_cell());
  for (const BoundaryFace& face : space.boundary()) {
    if (space.body(face.cell) != 0) continue;
    const bool in = system.problem().inflow &&
                    static_cast<unsigned>(system.problem().inflow->side) == face.boundary;
    for (std::size_t q = 0; q < face.normal_weight.size(); ++q) {
      Vec2 v{};
      for (std::size_t a = 0; a < na; ++a) {
        const auto n = 2 * static_cast<std::size_t>(space.cell_nodes(face.cell)[a]);
        for (std::size_t i = 0; i < 2; ++i) v[i] += face.value[q * na + a] * fields.velocity[n + i];
      }
      const double flux = v[0] * face.normal_weight[q][0] + v[1] * face.normal_weight[q][1];
      (in ? sum.inflow : sum.outflow) += in ? -flux : flux;
      sum.power -= 0.5 * system.problem().density * (v[0] * v[0] + v[1] * v[1]) * flux;
    }
  }
}

bool due(const std::vector<double>& times, double time) {
  return std::any_of(times.begin(), times.end(),
                     [time](double t) { return std::abs(t - time) < 1e-9 * (1.0 + time); });
}

int body_named(const Problem& problem, const std::string& name) {
  for (std::size_t i = 0; i < problem.solids.size(); ++i)
    if (problem.solids[i].name == name) return static_cast<int>(i) + 1;
  throw std::logic_error("no body named " + name);
}

int wall_named(const Problem& problem, const std::string& name) {
  for (std::size_t i = 0; i < problem.curved_walls.size(); ++i)
    if (problem.curved_walls[i].name == name) return static_cast<int>(i);
  throw std::logic_error("no curved wall named " + name);
}

}  // namespace

Balance balance(const FluidStructure& system, const Fields& fields, const StageWeights& weights) {
  const Space& space = system.space();
  Balance sum;
  const Vec2 gravity = system.gravity(weights.time);
  for (int c = 0; c < space.cells(); ++c)
    for (int q = 0; q < space.points_per_cell(); ++q) {
      const Sample s = sample(space, fields, c, q);
      if (space.body(c) == 0)
        add_fluid(system, s, space.weight(c)[q], gravity, sum);
      else
        add_solid(system.material(space.body(c)), s, space.weight(c)[q], gravity, sum);
    }
  if (sum.fluid_area > 0.0) sum.rms_divergence = std::sqrt(sum.rms_divergence / sum.fluid_area);
  add_boundary(system, fields, sum);
  sum.power += system.boundary_power(fields, weights);
  return sum;
}

Measurements::Measurements(const FluidStructure& system, RecordWriter& record)
    : system_(system), record_(record) {
  const Problem& problem = system.problem();
  const std::vector<double> rest(2 * static_cast<std::size_t>(system.space().nodes()), 0.0);
  const Locator at_rest(system.space(), rest);
  const auto place = [&](const Point& point, const std::string& body) {
    const Place found = at_rest.find({point[0], point[1]}, body_named(problem, body));
    if (found.cell < 0)
      throw std::runtime_error(
          fmt::format("the point ({}, {}) m is not in the mesh of {}", point[0], point[1], body));
    return found;
  };
  for (const auto& probe : problem.probes.displacement) {
    displacement_places_.push_back(place(probe.point, probe.solid));
    record_.declare_series(probe.name,
                           {{"time", "s"}, {"displacement_x", "m"}, {"displacement_y", "m"}});
  }
  for (const auto& probe : problem.probes.force)
    record_.declare_series(probe.name, {{"time", "s"}, {"force_x", "N/m"}, {"force_y", "N/m"}});
  for (const auto& probe : problem.probes.pressure) {
    std::vector<Column> columns = {{"time", "s"}};
    std::vector<std::vector<Place>> places;
    for (std::size_t i = 0; i < probe.places.size(); ++i) {
      columns.push_back({fmt::format("pressure_{}", i), "Pa"});
      places.push_back(at_rest.find_all({probe.places[i][0], probe.places[i][1]}));
      if (places.back().empty())
        throw std::runtime_error(fmt::format("probe {}: the point ({}, {}) m is in no cell",
                                             probe.name, probe.places[i][0], probe.places[i][1]));
    }
    pressure_places_.push_back(std::move(places));
    record_.declare_series(probe.name, columns);
  }
  for (const auto& probe : problem.probes.outline) {
    const Solid& solid =
        problem.solids[static_cast<std::size_t>(body_named(problem, probe.solid)) - 1];
    outline_points_.push_back(outline_points(solid, probe.points));
    std::vector<Place> places;
    for (const Point& point : outline_points_.back()) places.push_back(place(point, probe.solid));
    outline_places_.push_back(std::move(places));
  }
  record_.declare_series(
      "ledger_mass",
      {{"time", "s"}, {"inflow", "m2/s"}, {"outflow", "m2/s"}, {"excess_outflow", "m2"}});
  record_.declare_series("ledger_energy", {{"time", "s"},
                                           {"kinetic_fluid", "J/m"},
                                           {"kinetic_solid", "J/m"},
                                           {"elastic", "J/m"},
                                           {"dissipated", "J/m"},
                                           {"work", "J/m"},
                                           {"imbalance", "J/m"}});
  if (!problem.solids.empty())
    record_.declare_series(
        "ledger_solid",
        {{"time", "s"}, {"area_ratio", "1"}, {"min_stretch", "1"}, {"max_stretch", "1"}});
  record_.declare_series("ledger_divergence", {{"time", "s"}, {"rms_divergence", "1/s"}});
  record_.declare_series("ledger_solver", {{"time", "s"},
                                           {"time_step", "s"},
                                           {"newton_iterations", "1"},
                                           {"smallest_volume_ratio", "1"}});
}

void Measurements::each_step(const State& state, const StageWeights& weights,
                             const StepReport& step) {
  const Problem& problem = system_.problem();
  const double t = state.time;
  for (std::size_t i = 0; i < displacement_places_.size(); ++i) {
    const Vec2 u = evaluate(system_.space(), state.now.displacement, displacement_places_[i]);
    record_.append(problem.probes.displacement[i].name, std::array{t, u[0], u[1]});
  }
  if (!state.slope_known) return;
  for (const auto& probe : problem.probes.force) {
    const Vec2 f =
        probe.solid.empty()
            ? system_.force_on_wall(wall_named(problem, probe.curved_wall), state.now, weights)
            : system_.force_on(body_named(problem, probe.solid), state.now, weights);
    record_.append(probe.name, std::array{t, f[0], f[1]});
  }
  append_pressures(state);
  const Balance b = balance(system_, state.now, weights);
  const double half = 0.5 * (t - time_);
  excess_ += half * (excess_rate_ + b.outflow - b.inflow);
  // The pressure jumps with the rate of the inflow, and the power with it unless all is at rest:
  // then only its new value counts.
  work_ += half * ((step.from_kink && work_ != 0.0 ? b.power : power_) + b.power);
  dissipated_ += half * (dissipation_ + b.dissipation);
  time_ = t, excess_rate_ = b.outflow - b.inflow, power_ = b.power, dissipation_ = b.dissipation;
  record_.append("ledger_mass", std::array{t, b.inflow, b.outflow, excess_});
  const double stored = b.kinetic_fluid + b.kinetic_solid + b.elastic;
  record_.append("ledger_energy", std::array{t, b.kinetic_fluid, b.kinetic_solid, b.elastic,
                                             dissipated_, work_, work_ - dissipated_ - stored});
  if (!problem.solids.empty())
    record_.append("ledger_solid", std::array{t, b.solid_area / b.solid_area_at_rest, b.min_stretch,
                                              b.max_stretch});
  record_.append("ledger_divergence", std::array{t, b.rms_divergence});
  record_.append(
      "ledger_solver",
      std::array{t, step.time_step, static_cast<double>(step.iterations), b.smallest_volume_ratio});
}

void Measurements::append_pressures(const State& state) {
  const auto& probes = system_.problem().probes.pressure;
  if (probes.empty()) return;
  const bool moves = !system_.problem().solids.empty();
  std::optional<Locator> locator;
  if (moves) locator.emplace(system_.space(), state.now.displacement);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    std::vector<double> row = {state.time};
    for (std::size_t k = 0; k < probes[i].places.size(); ++k) {
      const Point& x = probes[i].places[k];
      if (moves) pressure_places_[i][k] = locator->find_all({x[0], x[1]});
      if (pressure_places_[i][k].empty())
        throw std::runtime_error(
            fmt::format("probe {}: the point ({}, {}) m is in no cell at t = "
                        "{} s",
                        probes[i].name, x[0], x[1], state.time));
      row.push_back(evaluate_pressure(system_.space(), state.now.pressure, pressure_places_[i][k]));
    }
    record_.append(probes[i].name, row);
  }
}

void Measurements::at(double time, const State& state) {
  for (const auto& probe : system_.problem().probes.velocity_profile)
    if (due(probe.times, time)) write_profile(probe, time, state);
  for (const auto& probe : system_.problem().probes.outline)
    if (due(probe.times, time)) write_outline(probe, time, state);
  write_fields(time, state);
}

void Measurements::write_profile(const VelocityProfileProbe& probe, double time,
                                 const State& state) {
  const Locator locator(system_.space(), state.now.displacement);
  std::vector<double> rows;
  for (int i = 0; i < probe.points; ++i) {
    const double s = probe.points > 1 ? static_cast<double>(i) / (probe.points - 1) : 0.0;
    const Vec2 x = {(1.0 - s) * probe.from[0] + s * probe.to[0],
                    (1.0 - s) * probe.from[1] + s * probe.to[1]};
    const Place place = locator.find(x);
    if (place.cell < 0)
      throw std::runtime_error(
          fmt::format("probe {}: the point ({}, {}) m is in no cell at t = {} s", probe.name, x[0],
                      x[1], time));
    const Vec2 v = evaluate(system_.space(), state.now.velocity, place);
    rows.insert(rows.end(), {x[0], x[1], v[0], v[1]});
  }
  record_.write_table(probe.name, time,
                      {{"x", "m"}, {"y", "m"}, {"velocity_x", "m/s"}, {"velocity_y", "m/s"}}, rows);
}

void Measurements::write_outline(const OutlineProbe& probe, double time, const State& state) {
  const auto which = static_cast<std::size_t>(&probe - system_.problem().probes.outline.data());
  std::vector<double> rows;
  for (std::size_t i = 0; i < outline_places_[which].size(); ++i) {
    const Point& x = outline_points_[which][i];
    const Vec2 u = evaluate(system_.space(), state.now.displacement, outline_places_[which][i]);
    rows.insert(rows.end(), {x[0], x[1], x[0] + u[0], x[1] + u[1]});
  }
  record_.write_table(probe.name, time,
                      {{"reference_x", "m"}, {"reference_y", "m"}, {"x", "m"}, {"y", "m"}}, rows);
}

void Measurements::write_fields(double time, const State& state) {
  // Every cell brings its own points, so that the pressure may jump; it is drawn as degree x degree
  // pieces.
  const Space& space = system_.space();
  const int na = space.nodes_per_cell(), np = space.pressures_per_cell(), k = space.degree();
  const auto& units = space.unit_nodes();
  // The element counts vertices, edges, inside; a lattice of its nodes is wanted.
  std::vector<int> lattice(static_cast<std::size_t>(na));
  for (int a = 0; a < na; ++a) {
    const auto column = [&](double s) {
      int nearest = 0;
      for (int b = 0; b < na; ++b)
        if (units[static_cast<std::size_t>(b)][1] == 0.0 &&
            units[static_cast<std::size_t>(b)][0] < s - 1e-9)
          ++nearest;
      return nearest;
    };
    const auto& u = units[static_cast<std::size_t>(a)];
    lattice[static_cast<std::size_t>(column(u[1]) * (k + 1) + column(u[0]))] = a;
  }
  std::vector<double> positions, velocity, pressure, displacement, body;
  std::vector<std::int64_t> cells;
  std::vector<double> modes(static_cast<std::size_t>(np));
  for (int c = 0; c < space.cells(); ++c) {
    const auto first = static_cast<std::int64_t>(pressure.size());
    for (const int a : lattice) {
      const int node = space.cell_nodes(c)[a];
      const auto n = 2 * static_cast<std::size_t>(node);
      const Vec2& x = space.position(node);
      const auto& u = state.now.displacement;
      const auto& v = state.now.velocity;
      positions.insert(positions.end(), {x[0] + u[n], x[1] + u[n + 1], 0.0});
      displacement.insert(displacement.end(), {u[n], u[n + 1], 0.0});
      velocity.insert(velocity.end(), {v[n], v[n + 1], 0.0});
      space.pressure_values(c, x, modes.data());
      double p = 0.0;
      for (int m = 0; m < np; ++m)
        p += modes[static_cast<std::size_t>(m)] *
             state.now.pressure[static_cast<std::size_t>(c * np + m)];
      pressure.push_back(p);
      body.push_back(space.body(c));
    }
    for (int row = 0; row < k; ++row)
      for (int column = 0; column < k; ++column) {
        const std::int64_t corner = first + row * (k + 1) + column;
        cells.insert(cells.end(), {corner, corner + 1, corner + k + 2, corner + k + 1});
      }
  }
  record_.write_mesh(time, positions, 4, cells,
                     {{"velocity", 3, velocity},
                      {"pressure", 1, pressure},
                      {"displacement", 3, displacement},
                      {"body", 1, body}});
}

void Measurements::save(Archive& archive) const {
  archive["measurements"] =
      std::vector<double>{time_, excess_, work_, dissipated_, excess_rate_, power_, dissipation_};
}

void Measurements::restore(const Archive& archive) {
  const auto& v = std::get<std::vector<double>>(archive.at("measurements"));
  time_ = v.at(0), excess_ = v.at(1), work_ = v.at(2), dissipated_ = v.at(3);
  excess_rate_ = v.at(4), power_ = v.at(5), dissipation_ = v.at(6);
}

}  // namespace sprung::reference
