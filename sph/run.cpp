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
/// Good checkpoints in a run: by simulated time, so that a retreat does not depend on the machine.
constexpr double good_checkpoints = 20.0;
/// A state that a run survived by so many steps is good: what breaks a run grows within a few.
constexpr std::int64_t steps_that_prove = 20;
/// Each retreat halves the step; what 1/32 of it does not cure, smaller steps will not.
constexpr int most_retreats = 5;

/// Set by SIGTERM and SIGINT: the run ends after the step under way and leaves a checkpoint.
volatile std::sig_atomic_t asked_to_stop = 0;

/// What a run has learnt from its faults so far.
struct Retreats {
  int count = 0;
  double step_factor = 1.0;
  double back_to = 0.0, fault_time = 0.0;  ///< s, of the last
  std::string told;
};

std::int64_t step_of(const Archive& archive) {
  return std::get<std::vector<std::int64_t>>(archive.at("counters")).at(0);
}
double time_of(const Archive& archive) {
  return std::get<std::vector<double>>(archive.at("clock")).at(0);
}

/// A run from its start, or from a checkpoint, to its end, a pause or a fault.
template <int dim>
class RunUnderWay {
 public:
  RunUnderWay(Document& document, const ModulusTable& table, const RunOptions& options,
              const std::filesystem::path& from, Retreats& retreats);
  Outcome go();
  /// After a fault: the checkpoint to go back to (empty: the start), or none when the run may not.
  std::optional<std::filesystem::path> retreat();
  Outcome close(Outcome outcome);

 private:
  RecordWriter open(const Document& document, const std::filesystem::path& from);
  void note_retreat();
  void step();
  void look_at_step();
  template <typename Look>
  void measure(Look&& look);
  void save_good();
  std::optional<std::filesystem::path> last_good() const;
  Archive state() const;
  void costs();
  void tell_strain();

  const RunOptions& options_;
  Retreats& retreats_;
  ParticleScene<dim> scene_;
  Archive archive_;  ///< of the checkpoint that the run begins from; empty at a start
  RecordWriter record_;
  Measurements<dim> measurements_;
  Guard<dim> guard_;
  std::string fault_;
  std::int64_t good_step_ = -steps_that_prove;  ///< of the newest good checkpoint
  double last_checkpoint_ = wall_seconds();
};

std::filesystem::path good(const RunOptions& options) {
  return options.out / "checkpoint_good.h5";
}
std::filesystem::path good_before(const RunOptions& options) {
  return options.out / "checkpoint_before.h5";
}

template <int dim>
RunUnderWay<dim>::RunUnderWay(Document& document, const ModulusTable& table,
                              const RunOptions& options, const std::filesystem::path& from,
                              Retreats& retreats)
    : options_(options),
      retreats_(retreats),
      scene_(set_up<dim>(document, table)),
      record_(open(document, from)),
      measurements_(scene_, record_),
      guard_(scene_) {
  if (retreats_.count == 0)
    for (const auto& warning : scene_.warnings) fmt::print(stderr, "warning: {}\n", warning);
  if (!archive_.empty()) {
    measurements_.restore(archive_);
    guard_.restore(archive_);
  }
  if (!archive_.empty() && std::filesystem::exists(good(options_)))
    good_step_ = step_of(read_archive(good(options_)));
  if (scene_.retreat) note_retreat();
  // Whoever resumes after a kill must find the step halved too.
  if (retreats_.count > 0) record_.checkpoint(scene_.simulation->state().clock.time, state());
}

template <int dim>
RecordWriter RunUnderWay<dim>::open(const Document& document, const std::filesystem::path& from) {
  Manifest manifest = manifest_of(document, scene_);
  if (retreats_.count > 0) {
    manifest.processor_start = processor_seconds();
    manifest.wall_start = wall_seconds();
  }
  if (from.empty()) {
    RecordWriter record(options_.out, manifest, options_.overwrite || retreats_.count > 0);
    for (const auto& file : {good(options_), good_before(options_)}) std::filesystem::remove(file);
    scene_.simulation->shorten_steps(retreats_.step_factor);
    return record;
  }
  archive_ = read_archive(from);
  scene_.simulation->restore(archive_);
  const double factor = scene_.simulation->step_factor();
  scene_.simulation->shorten_steps(retreats_.count > 0 ? retreats_.step_factor : factor);
  retreats_.step_factor = scene_.simulation->step_factor();
  return RecordWriter::resume(options_.out, manifest, scene_.simulation->state().clock.time);
}

/// Tells in the record where the run went back, and how it goes on.
template <int dim>
void RunUnderWay<dim>::note_retreat() {
  record_.declare_series("ledger_retreats",
                         {{"time", "s"}, {"fault_time", "s"}, {"step_factor", "1"}});
  if (retreats_.count == 0) return;
  record_.append("ledger_retreats",
                 std::array{retreats_.back_to, retreats_.fault_time, retreats_.step_factor});
  record_.set_number("retreats", retreats_.count);
  record_.set_note("retreats", retreats_.told);
}

template <int dim>
Archive RunUnderWay<dim>::state() const {
  Archive archive;
  scene_.simulation->save(archive);
  measurements_.save(archive);
  guard_.save(archive);
  return archive;
}

template <int dim>
void RunUnderWay<dim>::costs() {
  std::vector<std::pair<std::string, double>> seconds;
  for (std::size_t a = 0; a < action_count; ++a)
    seconds.emplace_back(to_string(Action(a)), scene_.simulation->seconds()[a]);
  record_.set_cost(seconds);
  record_.set_number("steps", static_cast<double>(scene_.simulation->state().clock.step));
}

/// The newest good checkpoint becomes the one before, once it has been survived itself: of the two
/// one always has been.
template <int dim>
void RunUnderWay<dim>::save_good() {
  const auto step = scene_.simulation->state().clock.step;
  if (step - good_step_ < steps_that_prove) return;
  good_step_ = step;
  if (std::filesystem::exists(good(options_)))
    std::filesystem::rename(good(options_), good_before(options_));
  write_archive(good(options_), state());
}

/// A checkpoint that the run survived by enough steps; empty: none but the start.
template <int dim>
std::optional<std::filesystem::path> RunUnderWay<dim>::last_good() const {
  const auto step = scene_.simulation->state().clock.step;
  for (const auto& file : {good(options_), good_before(options_)})
    if (std::filesystem::exists(file) && step - step_of(read_archive(file)) >= steps_that_prove)
      return file;
  return std::nullopt;
}

template <int dim>
void RunUnderWay<dim>::step() {
  auto& simulation = *scene_.simulation;
  const Clock& clock = simulation.state().clock;
  try {
    advance(simulation);
    const double began = wall_seconds();
    fault_ = guard_.find_fault().value_or("");
    simulation.add_seconds(Action::guard, wall_seconds() - began);
  } catch (const std::runtime_error& error) {
    fault_ = fmt::format("{}, at t = {:.6g} s, step {}; use a smaller time step (now {:.3g} s)",
                         error.what(), clock.time, clock.step, clock.time_step);
  }
}

/// What cannot be measured (no particle near a probe, a number that is none) is a fault of the run.
template <int dim>
template <typename Look>
void RunUnderWay<dim>::measure(Look&& look) {
  auto& simulation = *scene_.simulation;
  const Clock& clock = simulation.state().clock;
  const double began = wall_seconds();
  try {
    look();
  } catch (const std::runtime_error& error) {
    fault_ = fmt::format("{}, at t = {:.6g} s, step {}", error.what(), clock.time, clock.step);
  }
  simulation.add_seconds(Action::output, wall_seconds() - began);
}

template <int dim>
void RunUnderWay<dim>::look_at_step() {
  const Clock& clock = scene_.simulation->state().clock;
  const auto crossed = [&](double parts) {
    const double interval = scene_.problem.end_time / parts;
    return std::floor(clock.time / interval + 1e-9) >
           std::floor((clock.time - clock.time_step) / interval + 1e-9);
  };
  measurements_.each_step();
  if (crossed(ledger_rows)) measurements_.ledgers();
  if (crossed(good_checkpoints)) save_good();
  if (wall_seconds() - last_checkpoint_ > checkpoint_interval) {
    costs();
    record_.checkpoint(clock.time, state());
    last_checkpoint_ = wall_seconds();
  }
}

template <int dim>
Outcome RunUnderWay<dim>::go() {
  auto& simulation = *scene_.simulation;
  const Clock& clock = simulation.state().clock;
  const std::vector<double> stops = stops_of(scene_.problem);
  // A pause falls between two steps of the run that is not paused, or the resumed run would be
  // another one.
  const double end = options_.until > 0.0 ? std::min(options_.until, scene_.problem.end_time)
                                          : scene_.problem.end_time;
  if (archive_.empty())
    measure([&] {
      measurements_.ledgers();
      if (stops.front() == 0.0) measurements_.at(0.0);
    });
  if (!fault_.empty()) return Outcome::stopped;
  Progress progress("particles", end, clock.time);
  for (const double stop : stops) {
    if (stop <= clock.time) continue;
    simulation.stop_at(stop);
    while (clock.time < std::min(stop, end) && asked_to_stop == 0) {
      step();
      if (fault_.empty()) measure([&] { look_at_step(); });
      if (!fault_.empty()) return Outcome::stopped;
      progress.advance(clock.time, fmt::format("dt {:.3g} ms, {} iterations", 1e3 * clock.time_step,
                                               simulation.pressure_report().iterations));
    }
    if (clock.time < stop) return Outcome::paused;
    measure([&] { measurements_.at(stop); });
    if (!fault_.empty()) return Outcome::stopped;
  }
  return Outcome::finished;
}

template <int dim>
std::optional<std::filesystem::path> RunUnderWay<dim>::retreat() {
  if (!scene_.retreat || retreats_.count >= most_retreats) return std::nullopt;
  const auto file = last_good();
  ++retreats_.count;
  retreats_.step_factor *= 0.5;
  retreats_.fault_time = scene_.simulation->state().clock.time;
  retreats_.back_to = file ? time_of(read_archive(*file)) : 0.0;
  const std::string text = fmt::format("{}: back to t = {:.6g} s with {} of the step", fault_,
                                       retreats_.back_to, retreats_.step_factor);
  retreats_.told += (retreats_.told.empty() ? "" : "\n") + text;
  fmt::print(stderr, "retreat: {}\n", text);
  // What was saved after that state may hold the seed of the fault.
  if (file == good_before(options_)) {
    std::filesystem::rename(good_before(options_), good(options_));
  } else if (!file) {
    for (const auto& young : {good(options_), good_before(options_)})
      std::filesystem::remove(young);
  }
  costs();
  record_.finish("went back after a fault");
  return file ? good(options_) : std::filesystem::path();
}

/// Says in the record how far the springs were strained, and aloud where that is beyond the strain
/// to which E means what the scene says.
template <int dim>
void RunUnderWay<dim>::tell_strain() {
  if (!scene_.solid) return;
  const SpringStrain& strain = guard_.spring_strain();
  record_.set_number("largest_spring_strain", strain.largest);
  record_.set_number("springs_beyond_calibration", strain.share);
  record_.set_note("calibration", strain.told(dim));
  if (!strain.within(dim)) fmt::print(stderr, "warning: {}\n", strain.told(dim));
}

template <int dim>
Outcome RunUnderWay<dim>::close(Outcome outcome) {
  costs();
  if (outcome != Outcome::paused) tell_strain();
  if (outcome == Outcome::stopped) {
    const auto file = last_good();
    const auto checkpoint = options_.out / "checkpoint.h5";
    // A later one may hold the seed of the fault.
    if (file)
      std::filesystem::copy_file(*file, checkpoint,
                                 std::filesystem::copy_options::overwrite_existing);
    else
      std::filesystem::remove(checkpoint);
    const std::string kept = file ? fmt::format("the last good checkpoint is at t = {:.6g} s",
                                                time_of(read_archive(*file)))
                                  : std::string("there is no good checkpoint but the start");
    record_.set_note("fault", fault_);
    record_.finish("stopped: " + fault_);
    fmt::print(stderr, "stopped: {}\nthe record up to there is in {}; {}\n", fault_,
               options_.out.string(), kept);
    return outcome;
  }
  const double time = scene_.simulation->state().clock.time;
  record_.checkpoint(time, state());
  record_.finish(outcome == Outcome::paused
                     ? fmt::format("paused at t = {:.6g} s; --resume goes on", time)
                     : std::string("finished"));
  return outcome;
}

}  // namespace

template <int dim>
Outcome run(Document& document, const ModulusTable& table, const RunOptions& options) {
  for (const int signal : {SIGTERM, SIGINT}) std::signal(signal, [](int) { asked_to_stop = 1; });
  Retreats retreats;
  std::filesystem::path from;
  if (options.resume && std::filesystem::exists(options.out / "checkpoint.h5"))
    from = options.out / "checkpoint.h5";
  for (;;) {
    RunUnderWay<dim> under_way(document, table, options, from, retreats);
    const Outcome outcome = under_way.go();
    const auto back = outcome == Outcome::stopped ? under_way.retreat() : std::nullopt;
    if (!back) return under_way.close(outcome);
    from = *back;
  }
}

template Outcome run<2>(Document&, const ModulusTable&, const RunOptions&);
template Outcome run<3>(Document&, const ModulusTable&, const RunOptions&);

}  // namespace sprung::sph
