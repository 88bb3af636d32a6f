#include "sph/measurements.hpp"

#include "sph/probes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace sprung::sph {

namespace {

std::vector<Column> vector_columns(int dim, const std::string& name, const std::string& unit) {
  std::vector<Column> columns;
  for (int d = 0; d < dim; ++d) columns.push_back({fmt::format("{}_{}", name, "xyz"[d]), unit});
  return columns;
}

}  // namespace

template <int dim>
Measurements<dim>::Measurements(ParticleScene<dim>& scene, RecordWriter& record)
    : scene_(scene), record_(record) {
  const Probes& probes = scene.problem.probes;
  for (const auto& probe : probes.displacement)
    declare(probe.name, vector_columns(dim, "displacement", "m"));
  for (const auto& probe : probes.force)
    declare(probe.name, vector_columns(dim, "force", dim == 2 ? "N/m" : "N"));
  for (const auto& probe : probes.pressure) {
    std::vector<Column> columns;
    for (std::size_t k = 0; k < probe.places.size(); ++k)
      columns.push_back({fmt::format("pressure_{}", k), "Pa"});
    declare(probe.name, std::move(columns));
  }
  const std::string volume = dim == 2 ? "m2" : "m3", energy = dim == 2 ? "J/m" : "J";
  declare("ledger_mass", {{"inflow", volume + "/s"},
                          {"outflow", volume + "/s"},
                          {"excess_outflow", volume},
                          {"particles", "1"},
                          {"created", "1"},
                          {"removed", "1"},
                          {"lost", "1"},
                          {"turned_back", "1"}});
  std::vector<Column> energies = {
      {"kinetic_fluid", energy}, {"kinetic_solid", energy}, {"elastic", energy}};
  if (scene.solid && scene.solid->meets_others()) energies.push_back({"contact", energy});
  declare("ledger_energy", std::move(energies));
  declare("ledger_divergence", {{"rms_divergence", "1/s"},
                                {"pressure_iterations", "1"},
                                {"pressure_residual", "1"},
                                {"smallest_partition", "1"}});
  if (scene.solid)
    declare("ledger_solid", {{"area_ratio", "1"}, {"min_stretch", "1"}, {"max_stretch", "1"}});
}

template <int dim>
void Measurements<dim>::each_step() {
  const auto& particles = scene_.simulation->state().particles;
  for (const auto& probe : scene_.problem.probes.displacement) {
    const BodyRange& body = body_named(probe.solid);
    append(probe.name, displacement_of(*scene_.solid, particles, body.first, body.last,
                                       {as_vector<dim>(probe.point)})[0]);
  }
  const auto& state = scene_.simulation->state();
  const auto& viscosity = scene_.problem.viscosity;
  for (const auto& probe : scene_.problem.probes.force)
    append(probe.name, probe.solid.empty() ? scene_.wall_forces.at(probe.curved_wall)(
                                                 state, viscosity ? viscosity->dynamic : 0.0)
                                           : force_on(body_named(probe.solid)));
  for (const auto& probe : scene_.problem.probes.pressure) append_pressure(probe);
}

template <int dim>
Vector<dim> Measurements<dim>::force_on(const BodyRange& body) const {
  const auto& state = scene_.simulation->state();
  const auto load = scene_.solid->load(state);
  Vector<dim> sum = Vector<dim>::Zero();
  // The balanced part of gravity is in no load: its share of the pressure is the buoyancy.
  for (std::size_t i = body.first; i < body.last; ++i)
    sum += scene_.solid->mass(i) * (load[i] - state.balanced_acceleration);
  return sum;
}

template <int dim>
void Measurements<dim>::append_pressure(const PressureProbe& probe) {
  const auto& state = scene_.simulation->state();
  std::vector<Vector<dim>> places;
  for (const Point& place : probe.places) places.push_back(as_vector<dim>(place));
  std::vector<double> row{state.clock.time};
  for (const double p : pressure_at(state, places)) row.push_back(p);
  record_.append(probe.name, row);
}

template <int dim>
void Measurements<dim>::ledgers() {
  auto& simulation = *scene_.simulation;
  const auto& state = simulation.state();
  const auto& particles = state.particles;
  const double inflow = simulation.inflow_flux(), outflow = outflow_flux();
  excess_ += 0.5 * (state.clock.time - ledger_time_) * (outflow - inflow + last_excess_rate_);
  ledger_time_ = state.clock.time;
  last_excess_rate_ = outflow - inflow;
  const ParticleBooks& books = simulation.books();
  const double row[] = {state.clock.time,
                        inflow,
                        outflow,
                        excess_,
                        double(particles.unknowns),
                        double(books.entered + books.returned),
                        double(books.left + books.upstream + books.lost),
                        double(books.upstream + books.lost),
                        double(books.turned)};
  record_.append("ledger_mass", row);
  double kinetic[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < particles.unknowns; ++i) {
    const bool solid = i < particles.solids;
    const double mass = solid ? scene_.solid->mass(i) : particles.mass();
    kinetic[solid] += 0.5 * mass * particles.velocity[i].squaredNorm();
  }
  const double elastic = scene_.solid ? scene_.solid->energy(particles) : 0.0;
  std::vector<double> energies{state.clock.time, kinetic[0], kinetic[1], elastic};
  if (scene_.solid && scene_.solid->meets_others())
    energies.push_back(scene_.solid->contact_energy(state));
  record_.append("ledger_energy", energies);
  const auto& partition = state.support.partition();
  record_.append("ledger_divergence",
                 std::array{state.clock.time, simulation.remaining_divergence(),
                            double(simulation.pressure_report().iterations),
                            simulation.pressure_report().relative_residual,
                            *std::min_element(partition.begin(), partition.end())});
  if (scene_.solid) {
    const std::span<const Vector<dim>> position{particles.position.data(), particles.solids};
    const auto [least, most] = stretch_range(scene_.solid->network(), position);
    record_.append(
        "ledger_solid",
        std::array{state.clock.time, volume_ratio(scene_.solid->network(), position), least, most});
  }
}

template <int dim>
void Measurements<dim>::at(double time) {
  const auto& state = scene_.simulation->state();
  for (const auto& probe : scene_.problem.probes.velocity_profile)
    if (due(probe.times, time)) write_profile(probe, time);
  for (const auto& probe : scene_.problem.probes.outline)
    if (due(probe.times, time)) write_outline(probe, time);
  write_fields(state, time);
}

template <int dim>
void Measurements<dim>::save(Archive& archive) const {
  archive["measurements"] = std::vector<double>{excess_, ledger_time_, last_excess_rate_};
}

template <int dim>
void Measurements<dim>::restore(const Archive& archive) {
  const auto& values = std::get<std::vector<double>>(archive.at("measurements"));
  excess_ = values[0];
  ledger_time_ = values[1];
  last_excess_rate_ = values[2];
}

template <int dim>
bool Measurements<dim>::due(const std::vector<double>& times, double time) {
  return std::any_of(times.begin(), times.end(),
                     [time](double t) { return std::abs(t - time) < 1e-9 * (1.0 + time); });
}

template <int dim>
void Measurements<dim>::declare(const std::string& name, std::vector<Column> columns) {
  columns.insert(columns.begin(), {"time", "s"});
  record_.declare_series(name, std::move(columns));
}

template <int dim>
void Measurements<dim>::append(const std::string& name, const Vector<dim>& value) {
  std::array<double, dim + 1> row;
  row[0] = scene_.simulation->state().clock.time;
  for (int d = 0; d < dim; ++d) row[d + 1] = value[d];
  record_.append(name, row);
}

template <int dim>
const BodyRange& Measurements<dim>::body_named(const std::string& name) const {
  return *std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                       [&](const BodyRange& body) { return body.name == name; });
}

/// By Gauss's rule, two points on every two spacings: the midpoint rule finds 1 / (2 n^2) too much
/// of a parabola n spacings wide, 0.03 % of the flow at n = 40.
template <int dim>
double Measurements<dim>::outflow_flux() const {
  const auto& simulation = *scene_.simulation;
  const auto& state = simulation.state();
  const auto& box = scene_.problem.channel;
  double flux = 0.0;
  for (const auto& side : simulation.pressure_sides()) {
    const auto& plane = side.plane();
    std::array<long, dim> count;
    Vector<dim> width = Vector<dim>::Ones();
    for (int d = 0; d < dim; ++d) {
      const double length = box.to[d] - box.from[d];
      const long pairs = std::max(1L, std::lround(0.5 * length / state.particles.spacing));
      count[d] = d == plane.axis ? 1 : 2 * pairs;
      if (d != plane.axis) width[d] = length / static_cast<double>(count[d]);
    }
    const double first = 1.0 - 1.0 / std::sqrt(3.0);  // in widths from the pair's outer ends
    std::vector<Vector<dim>> places;
    for_each_index<dim>(count, [&](const std::array<long, dim>& at) {
      Vector<dim> x;
      for (int d = 0; d < dim; ++d)
        x[d] = box.from[d] + (at[d] + (at[d] % 2 == 0 ? first : 1.0 - first)) * width[d];
      x[plane.axis] = plane.place - plane.outward * 1.5 * state.kernel.support_radius();
      places.push_back(x);
    });
    for (const auto& u : velocity_at(state, places))
      flux += plane.outward * u[plane.axis] * width.prod();
  }
  return flux;
}

template <int dim>
void Measurements<dim>::write_profile(const VelocityProfileProbe& probe, double time) {
  const Vector<dim> from = as_vector<dim>(probe.from), to = as_vector<dim>(probe.to);
  std::vector<Vector<dim>> places;
  for (int k = 0; k < probe.points; ++k)
    places.push_back(from + (to - from) * (double(k) / (probe.points - 1)));
  const auto velocity = velocity_at(scene_.simulation->state(), places);
  std::vector<Column> columns = {{"x", "m"}, {"y", "m"}};
  if (dim == 3) columns.push_back({"z", "m"});
  for (const auto& column : vector_columns(dim, "velocity", "m/s")) columns.push_back(column);
  std::vector<double> rows;
  for (std::size_t k = 0; k < places.size(); ++k) {
    for (int d = 0; d < dim; ++d) rows.push_back(places[k][d]);
    for (int d = 0; d < dim; ++d) rows.push_back(velocity[k][d]);
  }
  record_.write_table(probe.name, time, columns, rows);
}

template <int dim>
void Measurements<dim>::write_outline(const OutlineProbe& probe, double time) {
  const BodyRange& body = body_named(probe.solid);
  const Solid& solid = scene_.problem.solids[&body - scene_.bodies.data()];
  std::vector<Vector<dim>> points;
  for (const Point& point : outline_points(solid, probe.points))
    points.push_back(as_vector<dim>(point));
  const auto moved = displacement_of(*scene_.solid, scene_.simulation->state().particles,
                                     body.first, body.last, points);
  std::vector<double> rows;
  for (std::size_t k = 0; k < points.size(); ++k)
    for (const double value :
         {points[k][0], points[k][1], points[k][0] + moved[k][0], points[k][1] + moved[k][1]})
      rows.push_back(value);
  record_.write_table(probe.name, time,
                      {{"reference_x", "m"}, {"reference_y", "m"}, {"x", "m"}, {"y", "m"}}, rows);
}

template <int dim>
void Measurements<dim>::write_fields(const State<dim>& state, double time) {
  const auto& particles = state.particles;
  const std::size_t n = particles.size();
  std::vector<double> position(3 * n, 0.0), velocity(3 * n, 0.0), pressure(n), role(n), identity(n);
  for (std::size_t i = 0; i < n; ++i) {
    for (int d = 0; d < dim; ++d) {
      position[3 * i + d] = particles.position[i][d];
      velocity[3 * i + d] = particles.velocity[i][d];
    }
    pressure[i] = state.pressure(i);
    role[i] = static_cast<double>(particles.role[i]);
    identity[i] = static_cast<double>(particles.identity[i]);
  }
  record_.write_points(time, position,
                       {{"velocity", 3, velocity},
                        {"pressure", 1, pressure},
                        {"role", 1, role},
                        {"identity", 1, identity}});
}

template class Measurements<2>;
template class Measurements<3>;

}  // namespace sprung::sph
