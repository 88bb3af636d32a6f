#include "sph/run.hpp"

#include "scene/progress.hpp"
#include "scene/record.hpp"
#include "sph/guard.hpp"
#include "sph/probes.hpp"
#include "sph/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <omp.h>

namespace sprung::sph {

namespace {

template <int dim>
Vector<dim> as_vector(const Point& point) {
  Vector<dim> x;
  for (int d = 0; d < dim; ++d) x[d] = point[d];
  return x;
}

std::vector<Column> vector_columns(int dim, const std::string& name, const std::string& unit) {
  std::vector<Column> columns;
  for (int d = 0; d < dim; ++d) columns.push_back({fmt::format("{}_{}", name, "xyz"[d]), unit});
  return columns;
}

/// Takes the measurements of one run and hands them to its record.
template <int dim>
class Measurements {
 public:
  Measurements(ParticleScene<dim>& scene, RecordWriter& record) : scene_(scene), record_(record) {
    const Probes& probes = scene.problem.probes;
    for (const auto& probe : probes.displacement)
      declare(probe.name, vector_columns(dim, "displacement", "m"));
    for (const auto& probe : probes.force)
      declare(probe.name, vector_columns(dim, "force", dim == 2 ? "N/m" : "N"));
    const std::string volume = dim == 2 ? "m2" : "m3", energy = dim == 2 ? "J/m" : "J";
    declare("ledger_mass", {{"inflow", volume + "/s"},
                            {"outflow", volume + "/s"},
                            {"excess_outflow", volume},
                            {"particles", "1"},
                            {"created", "1"},
                            {"removed", "1"},
                            {"lost", "1"}});
    declare("ledger_energy", {{"kinetic_fluid", energy}, {"kinetic_solid", energy}, {"elastic", energy}});
    declare("ledger_divergence",
            {{"rms_divergence", "1/s"}, {"pressure_iterations", "1"}, {"pressure_residual", "1"},
             {"smallest_partition", "1"}});
    if (scene.solid)
      declare("ledger_solid", {{"area_ratio", "1"}, {"min_stretch", "1"}, {"max_stretch", "1"}});
  }

  /// Quantities of every step: displacement, force.
  void each_step() {
    const auto& particles = scene_.simulation->state().particles;
    for (const auto& probe : scene_.problem.probes.displacement) {
      const BodyRange& body = body_named(probe.solid);
      append(probe.name, displacement_of(*scene_.solid, particles, body.first, body.last,
                                         {as_vector<dim>(probe.point)})[0]);
    }
    for (const auto& probe : scene_.problem.probes.force)
      append(probe.name, force_on(body_named(probe.solid)));
  }

  /// What the fluid did to the body in the last step.
  Vector<dim> force_on(const BodyRange& body) const {
    const auto& state = scene_.simulation->state();
    const auto load = scene_.solid->load(state);
    Vector<dim> sum = Vector<dim>::Zero();
    for (std::size_t i = body.first; i < body.last; ++i) sum += load[i];
    return state.particles.mass() * sum;
  }

  void ledgers() {
    auto& simulation = *scene_.simulation;
    const auto& state = simulation.state();
    const auto& particles = state.particles;
    const double inflow = simulation.inflow_flux(), outflow = outflow_flux();
    excess_ += 0.5 * (state.clock.time - ledger_time_) * (outflow - inflow + last_excess_rate_);
    ledger_time_ = state.clock.time;
    last_excess_rate_ = outflow - inflow;
    const ParticleBooks& books = simulation.books();
    const double row[] = {state.clock.time, inflow, outflow, excess_, double(particles.unknowns),
                          double(books.entered + books.returned),
                          double(books.left + books.upstream + books.lost),
                          double(books.upstream + books.lost)};
    record_.append("ledger_mass", row);
    double kinetic[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < particles.unknowns; ++i)
      kinetic[i < particles.solids] += 0.5 * particles.mass() * particles.velocity[i].squaredNorm();
    const double elastic = scene_.solid ? scene_.solid->energy(particles) : 0.0;
    record_.append("ledger_energy", std::array{state.clock.time, kinetic[0], kinetic[1], elastic});
    const auto& partition = state.support.partition();
    record_.append("ledger_divergence",
                   std::array{state.clock.time, simulation.remaining_divergence(),
                              double(simulation.pressure_report().iterations),
                              simulation.pressure_report().relative_residual,
                              *std::min_element(partition.begin(), partition.end())});
    if (scene_.solid) {
      const std::span<const Vector<dim>> position{particles.position.data(), particles.solids};
      const auto [least, most] = stretch_range(scene_.solid->network(), position);
      record_.append("ledger_solid", std::array{state.clock.time, area_ratio(), least, most});
    }
  }

  void at(double time) {
    const auto& state = scene_.simulation->state();
    for (const auto& probe : scene_.problem.probes.velocity_profile)
      if (due(probe.times, time)) write_profile(probe, time);
    for (const auto& probe : scene_.problem.probes.outline)
      if (due(probe.times, time)) write_outline(probe, time);
    write_fields(state, time);
  }

  void save(Archive& archive) const {
    archive["measurements"] = std::vector<double>{excess_, ledger_time_, last_excess_rate_};
  }
  void restore(const Archive& archive) {
    const auto& values = std::get<std::vector<double>>(archive.at("measurements"));
    excess_ = values[0];
    ledger_time_ = values[1];
    last_excess_rate_ = values[2];
  }

 private:
  static bool due(const std::vector<double>& times, double time) {
    return std::any_of(times.begin(), times.end(),
                       [time](double t) { return std::abs(t - time) < 1e-9 * (1.0 + time); });
  }

  void declare(const std::string& name, std::vector<Column> columns) {
    columns.insert(columns.begin(), {"time", "s"});
    record_.declare_series(name, std::move(columns));
  }

  void append(const std::string& name, const Vector<dim>& value) {
    std::array<double, dim + 1> row;
    row[0] = scene_.simulation->state().clock.time;
    for (int d = 0; d < dim; ++d) row[d + 1] = value[d];
    record_.append(name, row);
  }

  const BodyRange& body_named(const std::string& name) const {
    return *std::find_if(scene_.bodies.begin(), scene_.bodies.end(),
                         [&](const BodyRange& body) { return body.name == name; });
  }

  /// Normal velocity integrated over a line one support radius inside each outflow side.
  double outflow_flux() const {
    const auto& simulation = *scene_.simulation;
    const auto& state = simulation.state();
    const double dx = state.particles.spacing;
    double flux = 0.0;
    for (const auto& side : simulation.outflow()) {
      const auto& plane = side.plane();
      std::vector<Vector<dim>> places;
      const auto& box = scene_.problem.channel;
      std::array<long, dim> count;
      for (int d = 0; d < dim; ++d)
        count[d] = d == plane.axis ? 1 : std::lround((box.to[d] - box.from[d]) / dx);
      std::array<long, dim> at{};
      for (bool more = true; more;) {
        Vector<dim> x;
        for (int d = 0; d < dim; ++d) x[d] = box.from[d] + (at[d] + 0.5) * dx;
        x[plane.axis] = plane.place - plane.outward * 1.5 * state.kernel.support_radius();
        places.push_back(x);
        int d = 0;
        while (d < dim && ++at[d] == count[d]) at[d++] = 0;
        more = d < dim;
      }
      for (const auto& u : velocity_at(state, places))
        flux += plane.outward * u[plane.axis] * std::pow(dx, dim - 1);
    }
    return flux;
  }

  /// Volume of the solid over its volume at rest, from the lattice cells (the plane only).
  double area_ratio() const {
    double now = 0.0, rest = 0.0;
    if constexpr (dim == 2) {
      const auto& particles = scene_.simulation->state().particles;
      const auto& network = scene_.solid->network();
      for (const auto& cell : network.body_cells) {
        std::array<Vector<2>, 4> corner, gradient;
        for (int c = 0; c < 4; ++c) corner[c] = particles.position[cell[c]];
        now += quadrilateral_area(corner, gradient);
        for (int c = 0; c < 4; ++c) corner[c] = network.reference[cell[c]];
        rest += quadrilateral_area(corner, gradient);
      }
    }
    return rest > 0.0 ? now / rest : 1.0;
  }

  void write_profile(const VelocityProfileProbe& probe, double time) {
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

  void write_outline(const OutlineProbe& probe, double time) {
    const BodyRange& body = body_named(probe.solid);
    const Solid& solid = scene_.problem.solids[&body - scene_.bodies.data()];
    std::vector<Vector<dim>> points;
    for (const Point& point : outline_points(solid, probe.points))
      points.push_back(as_vector<dim>(point));
    const auto moved = displacement_of(*scene_.solid, scene_.simulation->state().particles, body.first,
                                       body.last, points);
    std::vector<double> rows;
    for (std::size_t k = 0; k < points.size(); ++k)
      for (const double value : {points[k][0], points[k][1], points[k][0] + moved[k][0],
                                 points[k][1] + moved[k][1]})
        rows.push_back(value);
    record_.write_table(probe.name, time,
                        {{"reference_x", "m"}, {"reference_y", "m"}, {"x", "m"}, {"y", "m"}}, rows);
  }

  void write_fields(const State<dim>& state, double time) {
    const auto& particles = state.particles;
    const std::size_t n = particles.size();
    std::vector<double> position(3 * n, 0.0), velocity(3 * n, 0.0), pressure(n), role(n), identity(n);
    for (std::size_t i = 0; i < n; ++i) {
      for (int d = 0; d < dim; ++d) {
        position[3 * i + d] = particles.position[i][d];
        velocity[3 * i + d] = particles.velocity[i][d];
      }
      pressure[i] = -particles.density * particles.pseudo_pressure[i];
      role[i] = static_cast<double>(particles.role[i]);
      identity[i] = static_cast<double>(particles.identity[i]);
    }
    record_.write_points(time, position,
                         {{"velocity", 3, velocity},
                          {"pressure", 1, pressure},
                          {"role", 1, role},
                          {"identity", 1, identity}});
  }

  ParticleScene<dim>& scene_;
  RecordWriter& record_;
  double excess_ = 0.0;
  double ledger_time_ = 0.0;
  double last_excess_rate_ = 0.0;
};

template <int dim>
Manifest manifest_of(const Document& document, const ParticleScene<dim>& scene) {
  Manifest manifest;
  manifest.solver = "sph";
  manifest.scene_title = scene.problem.title;
  manifest.scene_file = document.file().filename().string();
  manifest.scene_toml = document.resolved_toml();
  manifest.threads = omp_get_max_threads();
  manifest.libraries["eigen"] = fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                                            EIGEN_MINOR_VERSION);
  const auto& particles = scene.simulation->state().particles;
  manifest.numbers["particles"] = static_cast<double>(particles.unknowns);
  manifest.numbers["solid_particles"] = static_cast<double>(particles.solids);
  manifest.numbers["spacing"] = particles.spacing;
  manifest.numbers["time_step"] = scene.simulation->chosen_time_step().value;
  manifest.notes["time_step_limit"] = scene.simulation->chosen_time_step().limit;
  return manifest;
}

/// The times at which the run must stand still: probes, snapshots, the end. Ascending.
std::vector<double> stops_of(const Problem& problem) {
  std::vector<double> stops = problem.probes.all_times;
  if (stops.empty() || stops.back() < problem.end_time * (1.0 - 1e-9)) stops.push_back(problem.end_time);
  return stops;
}

/// Simulated time between two ledger rows, as a fraction of the run.
constexpr double ledger_rows = 600.0;
/// Wall seconds between two checkpoints.
constexpr double checkpoint_interval = 60.0;

}  // namespace

template <int dim>
Outcome run(Document& document, const ModulusTable& table, const RunOptions& options) {
  ParticleScene<dim> scene = set_up<dim>(document, table);
  for (const auto& warning : scene.warnings) fmt::print(stderr, "warning: {}\n", warning);
  Simulation<dim>& simulation = *scene.simulation;
  const Clock& clock = simulation.state().clock;

  const auto checkpoint_file = options.out / "checkpoint.h5";
  const bool resuming = options.resume && std::filesystem::exists(checkpoint_file);
  Archive archive;
  if (resuming) {
    archive = read_archive(checkpoint_file);
    simulation.restore(archive);
  }
  RecordWriter record =
      resuming ? RecordWriter::resume(options.out, manifest_of(document, scene), clock.time)
               : RecordWriter(options.out, manifest_of(document, scene), options.overwrite);
  Measurements<dim> measurements(scene, record);
  if (resuming) measurements.restore(archive);

  // A pause falls between two steps of the run that is not paused, or the resumed run would be another one.
  const double end = options.until > 0.0 ? std::min(options.until, scene.problem.end_time)
                                         : scene.problem.end_time;
  const auto save = [&] {
    Archive state;
    simulation.save(state);
    measurements.save(state);
    record.checkpoint(clock.time, state);
  };
  const auto costs = [&] {
    std::vector<std::pair<std::string, double>> seconds;
    for (std::size_t a = 0; a < action_count; ++a)
      seconds.emplace_back(to_string(Action(a)), simulation.seconds()[a]);
    record.set_cost(seconds);
    record.set_number("steps", static_cast<double>(clock.step));
  };
  if (!resuming) measurements.ledgers();

  Progress progress("particles", end, clock.time);
  double last_checkpoint = wall_seconds();
  std::string fault;
  const double ledger_interval = scene.problem.end_time / ledger_rows;
  const std::vector<double> stops = stops_of(scene.problem);
  if (!resuming && stops.front() == 0.0) measurements.at(0.0);
  for (const double stop : stops) {
    if (stop <= clock.time) continue;
    simulation.stop_at(stop);
    while (clock.time < std::min(stop, end) && fault.empty()) {
      try {
        advance(simulation);
      } catch (const std::runtime_error& error) {
        fault = fmt::format("{}, at t = {:.6g} s, step {}", error.what(), clock.time, clock.step);
      }
      if (fault.empty()) fault = find_fault(scene).value_or("");
      if (!fault.empty()) break;
      const double began = wall_seconds();
      measurements.each_step();
      if (std::floor(clock.time / ledger_interval + 1e-9) >
          std::floor((clock.time - clock.time_step) / ledger_interval + 1e-9))
        measurements.ledgers();
      if (wall_seconds() - last_checkpoint > checkpoint_interval) {
        costs();
        save();
        last_checkpoint = wall_seconds();
      }
      simulation.add_seconds(Action::output, wall_seconds() - began);
      progress.advance(clock.time, fmt::format("dt {:.3g} ms, {} iterations", 1e3 * clock.time_step,
                                               simulation.pressure_report().iterations));
    }
    if (!fault.empty() || clock.time < stop) break;
    const double began = wall_seconds();
    measurements.at(stop);
    simulation.add_seconds(Action::output, wall_seconds() - began);
  }
  costs();
  if (!fault.empty()) {
    // The checkpoint of the last good state stays as it is.
    record.set_note("fault", fault);
    record.finish("stopped: " + fault);
    fmt::print(stderr, "stopped: {}\nthe record up to there is in {}\n", fault, options.out.string());
    return Outcome::stopped;
  }
  save();
  if (clock.time < stops.back()) {
    record.flush();
    return Outcome::paused;
  }
  record.finish("finished");
  return Outcome::finished;
}

template Outcome run<2>(Document&, const ModulusTable&, const RunOptions&);
template Outcome run<3>(Document&, const ModulusTable&, const RunOptions&);

}  // namespace sprung::sph
