#include "sph/run.hpp"

#include "scene/progress.hpp"
#include "scene/record.hpp"
#include "sph/guard.hpp"
#include "sph/measurements.hpp"
#include "sph/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include <fmt/format.h>
#include <omp.h>

namespace sprung::sph {

namespace {

template <int dim>
Manifest manifest_of(const Document& document, const ParticleScene<dim>& scene) {
  Manifest manifest;
  manifest.solver = "sph";
  manifest.scene_title = scene.problem.title;
  manifest.scene_file = document.file().filename().string();
  manifest.scene_toml = document.resolved_toml();
  manifest.threads = omp_get_max_threads();
  manifest.libraries["eigen"] =
      fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
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
  if (stops.empty() || stops.back() < problem.end_time * (1.0 - 1e-9))
    stops.push_back(problem.end_time);
  return stops;
}

/// Simulated time between two ledger rows, as a fraction of the run.
constexpr double ledger_rows = 600.0;
/// Wall seconds between two checkpoints.
constexpr double checkpoint_interval = 60.0;

/// Set by SIGTERM and SIGINT: the run ends after the step under way and leaves a checkpoint.
volatile std::sig_atomic_t asked_to_stop = 0;

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

  // A pause falls between two steps of the run that is not paused, or the resumed run would be
  // another one.
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
  for (const int signal : {SIGTERM, SIGINT}) std::signal(signal, [](int) { asked_to_stop = 1; });

  Progress progress("particles", end, clock.time);
  double last_checkpoint = wall_seconds();
  std::string fault;
  const double ledger_interval = scene.problem.end_time / ledger_rows;
  const std::vector<double> stops = stops_of(scene.problem);
  if (!resuming && stops.front() == 0.0) measurements.at(0.0);
  for (const double stop : stops) {
    if (stop <= clock.time) continue;
    simulation.stop_at(stop);
    while (clock.time < std::min(stop, end) && fault.empty() && asked_to_stop == 0) {
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
    fmt::print(stderr, "stopped: {}\nthe record up to there is in {}\n", fault,
               options.out.string());
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
