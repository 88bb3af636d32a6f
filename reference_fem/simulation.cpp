#include "reference_fem/simulation.hpp"

#include "scene/progress.hpp"

#include <deal.II/base/config.h>
#include <deal.II/base/multithread_info.h>

#include <fmt/format.h>
#include <gmsh.h>
#include <suitesparse/umfpack.h>

#include <algorithm>
#include <cmath>
#include <csignal>

namespace sprung::reference {
namespace {

constexpr double same_time = 1e-9;
constexpr int max_halvings = 4;  // of a step that Newton's method or the mesh could not take

bool same(double a, double b) {
  return std::abs(a - b) < same_time * (1.0 + std::abs(b));
}

std::vector<Material> materials_of(const Problem& problem, const Settings& settings) {
  std::vector<Material> materials;
  for (const Solid& solid : problem.solids)
    materials.push_back(Material::from_youngs(settings.law, solid.youngs_modulus,
                                              settings.poisson_ratio, settings.solid_density));
  return materials;
}

double largest_body(const Problem& problem) {
  double size = 0.0;
  for (const Solid& solid : problem.solids)
    for (std::size_t d = 0; d < 2; ++d)
      size = std::max(size, solid.body.to[d] - solid.body.from[d]);
  return size;
}

}  // namespace

Simulation::Simulation(const Problem& problem, const Settings& settings)
    : problem_(problem), settings_(settings), wanted_step_(settings.time_step) {
  quality_ = make_mesh(problem_, settings_.sizes, mesh_);
  space_ = std::make_unique<Space>(mesh_, settings_.degree);
  system_ = std::make_unique<FluidStructure>(*space_, problem_, materials_of(problem_, settings_));
  body_size_ = largest_body(problem_);
  motion_ = std::make_unique<MeshMotion>(*space_, body_size_ > 0.0 ? body_size_ : 1.0,
                                         settings_.mesh_stiffening);
  integration_ = std::make_unique<TimeIntegration>(*system_, *motion_, settings_.newton);
  state_ = integration_->initial_state();
  set_initial_velocity();
}

/// Where it does not fit the boundary values or has a divergence, the first step makes it do so.
void Simulation::set_initial_velocity() {
  if (problem_.initial_velocity.empty()) return;
  for (int n = 0; n < space_->nodes(); ++n) {
    const Vec2& x = space_->position(n);
    for (std::size_t d = 0; d < 2; ++d)
      state_.now.velocity[2 * static_cast<std::size_t>(n) + d] =
          problem_.initial_velocity[d].value(std::array{x[0], x[1], 0.0});
  }
  system_->impose(0.0, state_.now.velocity);
}

bool Simulation::is_kink(double time) const {
  return time == 0.0 ||
         (problem_.inflow && problem_.inflow->ramp > 0.0 && same(time, problem_.inflow->ramp));
}

bool Simulation::is_checkpoint(double time) const {
  return same(std::round(time / settings_.checkpoint_every) * settings_.checkpoint_every, time);
}

std::vector<double> Simulation::events() const {
  std::vector<double> times = problem_.probes.all_times;
  if (problem_.inflow && problem_.inflow->ramp < problem_.end_time)
    times.push_back(problem_.inflow->ramp);
  for (int i = 1; i * settings_.checkpoint_every < problem_.end_time; ++i)
    times.push_back(i * settings_.checkpoint_every);
  times.push_back(problem_.end_time);
  std::stable_sort(times.begin(), times.end());
  std::vector<double> distinct;
  for (const double t : times)
    if (t > 0.0 && (distinct.empty() || !same(t, distinct.back()))) distinct.push_back(t);
  return distinct;
}

void Simulation::advance(double event) {
  const bool kink = is_kink(state_.time);
  if (kink) {
    // What was extrapolated from before no longer holds, and the old slope is on the wrong side.
    state_.slope_known = state_.has_before = false;
    wanted_step_ = settings_.time_step;
  }
  const TimeScheme& scheme = state_.slope_known ? settings_.scheme : settings_.starter;
  const long iterations = integration_->effort().iterations;
  const double left = event - state_.time;
  for (int attempt = 0;; ++attempt) {
    const double count = std::max(1.0, std::ceil(left / wanted_step_ - 1e-6));
    const double step = left / count;
    try {
      integration_->step(state_, scheme, step);
    } catch (const std::runtime_error&) {
      // The state is as it was: half the step may do.
      if (attempt == max_halvings) throw;
      wanted_step_ = 0.5 * step;
      integration_->forget_matrix();
      continue;
    }
    if (count == 1.0) state_.time = event;
    last_step_ = {step, integration_->effort().iterations - iterations, kink};
    choose_next_step(step);
    return;
  }
}

void Simulation::choose_next_step(double tried) {
  const double size =
      body_size_ > 0.0 ? body_size_ : problem_.channel.to[1] - problem_.channel.from[1];
  if (wanted_step_ < settings_.time_step) {
    wanted_step_ = std::min(settings_.time_step, 2.0 * wanted_step_);
    return;
  }
  const double error = integration_->displacement_error() / size;
  if (error > settings_.step_tolerance)
    wanted_step_ = std::max(settings_.time_step, 0.5 * wanted_step_);
  else if (error > 0.0 && error * 10.0 < settings_.step_tolerance && tried > 0.9 * wanted_step_)
    // Twice the step has eight times the error.
    wanted_step_ = std::min(settings_.largest_time_step, 2.0 * wanted_step_);
}

void Simulation::save(Archive& archive) const {
  archive["velocity"] = state_.now.velocity;
  archive["pressure"] = state_.now.pressure;
  archive["displacement"] = state_.now.displacement;
  archive["mesh_velocity"] = state_.now.mesh_velocity;
  archive["acceleration"] = state_.now.acceleration;
  archive["before_acceleration"] = state_.before_acceleration;
  archive["before_pressure"] = state_.before_pressure;
  archive["clock"] = std::vector<double>{state_.time,
                                         state_.slope_known ? 1.0 : 0.0,
                                         state_.has_before ? 1.0 : 0.0,
                                         state_.before_time,
                                         wanted_step_,
                                         integration_->speed_scale()};
  const Effort& effort = integration_->effort();
  archive["effort"] = std::vector<std::int64_t>{effort.steps, effort.stages, effort.iterations,
                                                effort.factorizations, effort.halvings};
  integration_->save(archive);
}

void Simulation::restore(const Archive& archive) {
  const auto read = [&archive](const char* name, std::vector<double>& values) {
    const auto& stored = std::get<std::vector<double>>(archive.at(name));
    if (!values.empty() && stored.size() != values.size())
      throw std::runtime_error(std::string("the checkpoint's ") + name +
                               " belongs to another mesh");
    values = stored;
  };
  read("velocity", state_.now.velocity);
  read("pressure", state_.now.pressure);
  read("displacement", state_.now.displacement);
  read("mesh_velocity", state_.now.mesh_velocity);
  read("acceleration", state_.now.acceleration);
  read("before_acceleration", state_.before_acceleration);
  read("before_pressure", state_.before_pressure);
  const auto& clock = std::get<std::vector<double>>(archive.at("clock"));
  state_.time = clock.at(0);
  state_.slope_known = clock.at(1) != 0.0;
  state_.has_before = clock.at(2) != 0.0;
  state_.before_time = clock.at(3);
  wanted_step_ = clock.at(4);
  integration_->set_speed_scale(clock.at(5));
  const auto& effort = std::get<std::vector<std::int64_t>>(archive.at("effort"));
  Effort& mine = integration_->effort();
  mine.steps = effort.at(0), mine.stages = effort.at(1);
  mine.iterations = effort.at(2), mine.factorizations = effort.at(3);
  if (effort.size() > 4) mine.halvings = effort[4];
  integration_->restore(archive);
}

namespace {

Manifest manifest_of(const Document& document, const Problem& problem, int threads) {
  Manifest manifest;
  manifest.solver = "reference_fem";
  manifest.scene_title = problem.title;
  manifest.scene_file = document.file().filename().string();
  manifest.scene_toml = document.resolved_toml();
  manifest.threads = threads;
  manifest.libraries = {{"deal.II", DEAL_II_PACKAGE_VERSION},
                        {"Gmsh", GMSH_API_VERSION},
                        {"UMFPACK", fmt::format("{}.{}.{}", UMFPACK_MAIN_VERSION,
                                                UMFPACK_SUB_VERSION, UMFPACK_SUBSUB_VERSION)}};
  manifest.notes["outflow"] =
      "mu grad v n - p n = -p_out n: the traction that leaves a Poiseuille flow undisturbed";
  manifest.notes["force"] =
      "fluid on body, N per metre of depth, +x downstream, from the residual at the wetted nodes";
  manifest.processor_start = processor_seconds();
  manifest.wall_start = wall_seconds();
  return manifest;
}

void write_numbers(Simulation& simulation, RecordWriter& record) {
  const FluidStructure& system = simulation.system();
  const MeshQuality& quality = simulation.quality();
  const Effort& effort = simulation.integration().effort();
  const auto number = [&record](const char* name, auto value) {
    record.set_number(name, static_cast<double>(value));
  };
  number("unknowns", system.velocity_unknowns() + system.pressure_unknowns());
  number("velocity_unknowns", system.velocity_unknowns());
  number("pressure_unknowns", system.pressure_unknowns());
  number("cells", quality.cells);
  number("solid_cells", quality.solid_cells);
  number("smallest_cell_edge", quality.min_size);
  number("largest_cell_edge", quality.max_size);
  number("smallest_scaled_jacobian", quality.min_scaled_jacobian);
  number("time_step", simulation.settings().time_step);
  number("steps", effort.steps);
  number("stages", effort.stages);
  number("newton_iterations", effort.iterations);
  number("factorizations", effort.factorizations);
  number("newton_halvings", effort.halvings);
  number("factor_entries", system.factor_entries());
}

/// Set by a signal: the run ends after the step under way and leaves a checkpoint.
volatile std::sig_atomic_t asked_to_stop = 0;

/// A second signal ends the process at once.
void ask_to_stop(int number) {
  asked_to_stop = number;
  std::signal(number, SIG_DFL);
}

const char* name_of(int number) {
  return number == SIGTERM ? "SIGTERM" : number == SIGINT ? "SIGINT" : "SIGHUP";
}

/// Everything that must agree between the files on disk, as they stand at one time. A matrix that
/// is not forgotten before is stored.
void checkpoint(Simulation& simulation, const Measurements& measurements, RecordWriter& record) {
  Archive archive;
  simulation.save(archive);
  measurements.save(archive);
  write_numbers(simulation, record);
  std::vector<std::pair<std::string, double>> cost;
  for (const auto& [phase, seconds] : simulation.integration().effort().seconds)
    cost.emplace_back(phase, seconds);
  record.set_cost(cost);
  record.checkpoint(simulation.state().time, archive);
}

/// Marches to the end; returns a sentence if the run had to stop itself.
std::string march(Simulation& simulation, Measurements& measurements, RecordWriter& record,
                  const RunOptions& options) {
  const double end = simulation.problem().end_time;
  State& state = simulation.state();
  Effort& effort = simulation.integration().effort();
  Progress progress(options.label, end, state.time);
  for (const double event : simulation.events()) {
    if (event < state.time || same(state.time, event)) continue;  // before the resumption
    while (state.time < event) {
      if (asked_to_stop != 0) {
        checkpoint(simulation, measurements, record);
        throw RunInterrupted(fmt::format("stopped by {} at t = {:.6g} s; --resume continues there",
                                         name_of(asked_to_stop), state.time),
                             asked_to_stop);
      }
      try {
        simulation.advance(event);
      } catch (const std::runtime_error& error) {
        return fmt::format(
            "stopped after t = {:.6g} s, step {:.3g} s: {}; use a smaller "
            "reference_fem.time_step, finer cells (reference_fem.cell_size) or a larger "
            "reference_fem.mesh_stiffening",
            state.time, simulation.settings().time_step, error.what());
      }
      const Stopwatch watch(effort, "output");
      const StepReport& step = simulation.last_step();
      measurements.each_step(state, simulation.integration().weights(), step);
      progress.advance(state.time, fmt::format("dt {:.3g} ms, {} iterations", 1e3 * step.time_step,
                                               step.iterations));
    }
    const Stopwatch watch(effort, "output");
    const auto& wanted = simulation.problem().probes.all_times;
    if (std::any_of(wanted.begin(), wanted.end(), [&](double t) { return same(state.time, t); }))
      measurements.at(state.time, state);
    if (!simulation.is_checkpoint(state.time) && !same(state.time, end)) continue;
    simulation.integration().forget_matrix();
    checkpoint(simulation, measurements, record);
    if (options.until > 0.0 && state.time >= options.until) break;
  }
  return {};
}

}  // namespace

Outcome run(const Document& document, const Problem& problem, const Settings& settings,
            const RunOptions& options) {
  dealii::MultithreadInfo::set_thread_limit(static_cast<unsigned>(options.threads));
  const Manifest manifest = manifest_of(document, problem, options.threads);
  const double began = processor_seconds();
  Simulation simulation(problem, settings);
  simulation.integration().effort().seconds["set-up"] = processor_seconds() - began;
  const bool go_on = options.resume && std::filesystem::exists(options.out / "checkpoint.h5");
  Archive archive;
  if (go_on) {
    archive = read_archive(options.out / "checkpoint.h5");
    simulation.restore(archive);
  }
  RecordWriter record =
      go_on ? RecordWriter::resume(options.out, manifest, simulation.state().time)
            : RecordWriter(options.out, manifest, options.overwrite || options.resume);
  Measurements measurements(simulation.system(), record);
  if (go_on)
    measurements.restore(archive);
  else
    measurements.each_step(simulation.state(), {}, {});
  write_numbers(simulation, record);
  asked_to_stop = 0;
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) std::signal(number, ask_to_stop);
  std::string stopped;
  try {
    stopped = march(simulation, measurements, record, options);
  } catch (const RunInterrupted& interrupted) {
    record.finish(interrupted.what());
    throw;
  }
  write_numbers(simulation, record);
  std::vector<std::pair<std::string, double>> cost;
  for (const auto& [phase, seconds] : simulation.integration().effort().seconds)
    cost.emplace_back(phase, seconds);
  record.set_cost(cost);
  const bool finished = stopped.empty() && same(simulation.state().time, problem.end_time);
  record.finish(!stopped.empty() ? stopped : finished ? "finished" : "paused");
  if (!stopped.empty()) throw RunStopped(stopped);
  return finished ? Outcome::finished : Outcome::paused;
}

}  // namespace sprung::reference
