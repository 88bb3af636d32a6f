#include "sph/explain.hpp"

#include "scene/body_shape.hpp"

#include "scene/manifest.hpp"
#include "scene/progress.hpp"
#include "sph/effects/carreau_yasuda.hpp"
#include "sph/time_step.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <omp.h>

namespace sprung::sph {

namespace {

/// The dimensionless numbers that decide, and what each one means for the scene.
std::string numbers_of(const Problem& problem, double velocity_scale, double spacing) {
  std::string text;
  const double height = problem.channel.to[1] - problem.channel.from[1];
  const double speed = problem.inflow ? problem.inflow->mean_velocity : velocity_scale;
  if (problem.viscosity) {
    const double nu = problem.viscosity->dynamic / problem.density;
    text +=
        fmt::format("  Reynolds number       {:10.4g}   mean inflow speed x channel height / nu\n",
                    speed * height / nu);
    text += fmt::format(
        "  cell Reynolds number  {:10.4g}   velocity scale x spacing / nu; above 10 the "
        "boundary layers are thinner than the particles show\n",
        velocity_scale * spacing / nu);
  }
  if (problem.viscosity && problem.viscosity->carreau_yasuda) {
    const auto& law = *problem.viscosity->carreau_yasuda;
    const double number = law.relaxation_time * velocity_scale / height;
    text += fmt::format(
        "  Carreau number        {:10.4g}   relaxation time x velocity scale / channel height: the "
        "fluid flows with {:.3g} of its viscosity at rest\n",
        number, viscosity_ratio(law, problem.viscosity->dynamic, velocity_scale / height));
  }
  for (const Solid& solid : problem.solids) {
    const Point extent = own_extent(solid);
    const auto [thinnest, longest] =
        std::minmax_element(extent.begin(), extent.begin() + problem.dimension);
    const double thickness = *thinnest, length = *longest;
    const double cauchy = problem.density * speed * speed / solid.youngs_modulus;
    text += fmt::format(
        "  Cauchy number         {:10.4g}   rho U^2 / E of [solid.{}]; times (length / "
        "thickness)^3 = {:.3g}: {}\n",
        cauchy, solid.name, cauchy * std::pow(length / thickness, 3),
        cauchy * std::pow(length / thickness, 3) > 1e-3 ? "the flow bends it"
                                                        : "all but rigid in this flow");
    text += fmt::format("  particles across      {:10.1f}   of [solid.{}]\n", thickness / spacing,
                        solid.name);
  }
  return text;
}

std::string sides_of(const std::vector<Side>& sides) {
  std::string text;
  for (const Side side : sides) text += (text.empty() ? "" : ", ") + std::string(to_string(side));
  return text;
}

/// What bounds the scene and drives it: the boundary's effects, on or off as those of the registry.
struct Boundary {
  std::vector<std::string> on, off;
  void note(bool called_for, const std::string& line, const std::string& absent) {
    (called_for ? on : off).push_back(called_for ? line : absent + " would call for it");
  }
};

Boundary boundary_of(const Problem& problem) {
  Boundary b;
  const bool flat =
      problem.walls && problem.walls->no_slip.size() + problem.walls->free_slip.size() > 0;
  b.note(flat,
         flat ? fmt::format(
                    "mirrors at flat walls: [walls], no slip at {}; free slip at {}",
                    problem.walls->no_slip.empty() ? "none" : sides_of(problem.walls->no_slip),
                    problem.walls->free_slip.empty() ? "none" : sides_of(problem.walls->free_slip))
              : "",
         "mirrors at flat walls: a table [walls]");
  b.note(!problem.curved_walls.empty(),
         fmt::format("mirrors at curved walls: {} tables [curved_wall.<name>]",
                     problem.curved_walls.size()),
         "mirrors at curved walls: a table [curved_wall.<name>]");
  b.note(problem.periodic.has_value(), "periodic sides: [periodic]",
         "periodic sides: a table [periodic]");
  const bool entered = problem.inflow || problem.pressure_inflow;
  b.note(entered,
         problem.inflow ? fmt::format("inflow: [inflow], {:.4g} m/s in the mean, ramp of {:.4g} s",
                                      problem.inflow->mean_velocity, problem.inflow->ramp)
                        : "inflow: [inflow] with a pressure",
         "inflow: a table [inflow]");
  b.note(problem.outflow.has_value(), "outflow: [outflow]", "outflow: a table [outflow]");
  const bool timed = (problem.inflow && !problem.inflow->waveform.constant()) ||
                     (problem.pressure_inflow && !problem.pressure_inflow->waveform.constant()) ||
                     (problem.outflow && !problem.outflow->waveform.constant()) ||
                     (problem.gravity && !problem.gravity->waveform.constant()) ||
                     std::any_of(problem.wall_motion.begin(), problem.wall_motion.end(),
                                 [](const WallMotion& one) { return !one.waveform.constant(); });
  b.note(timed, "waveform: a table has one", "waveforms: a key waveform");
  const auto clamped = std::count_if(problem.solids.begin(), problem.solids.end(),
                                     [](const Solid& solid) { return solid.clamped.has_value(); });
  b.note(clamped > 0, fmt::format("clamps: {} bodies are clamped", clamped),
         "clamps: a key clamped of a body");
  return b;
}

/// Steps of the scene itself, for a while: what a step takes and what it all takes, once the first
/// steps have found their memory. What comes later is dearer than the beginning, when the particles
/// stand on their lattice and the flow is young; `later` was measured on the scenes of validation/.
struct Sample {
  int steps = 0;
  double per_step = 0.0;  ///< s of processor time
  static constexpr double later = 1.15;
};

template <int dim>
Sample sample(Simulation<dim>& simulation, double end_time) {
  constexpr int first = 2, least = 8;
  constexpr double enough = 2.0;  // s of processor time
  Sample found;
  double began = 0.0, spent = 0.0;
  while ((found.steps < least || spent < enough) &&
         simulation.state().clock.time < end_time * (1.0 - 1e-9)) {
    if (found.steps == first) began = processor_seconds();
    advance(simulation);
    ++found.steps;
    if (found.steps > first) spent = processor_seconds() - began;
  }
  found.per_step = spent / std::max(1, found.steps - first);
  return found;
}

}  // namespace

template <int dim>
std::string explain(Document& document, const ModulusTable& table) {
  omp_set_num_threads(1);  // before the set-up, which is part of what a run takes
  auto scene = set_up<dim>(document, table);
  auto& simulation = *scene.simulation;
  const auto& particles = simulation.state().particles;
  std::string text = fmt::format("{}\n{} particles with an equation ({} solid), {} prescribed\n",
                                 scene.problem.title, particles.unknowns, particles.solids,
                                 particles.size() - particles.unknowns);
  text += "\nNumbers that decide\n" +
          numbers_of(scene.problem, simulation.velocity_scale(), particles.spacing);
  text += "\nEffects that the scene calls for\n";
  const Boundary boundary = boundary_of(scene.problem);
  for (const auto& line : scene.effects) text += "  " + line + "\n";
  for (const auto& line : boundary.on) text += "  " + line + "\n";
  text += "\nOff: no object, no array, no time\n";
  for (const auto& line : scene.effects_off) text += "  " + line + "\n";
  for (const auto& line : boundary.off) text += "  " + line + "\n";
  const auto& numerics = simulation.numerics();
  const auto step = simulation.chosen_time_step();
  text += fmt::format("\nTime step\n  {:.4g} s, set by {}\n", step.value, step.limit);
  text += fmt::format("  {:.4g} s: CFL, courant {} x spacing / velocity scale ({} m/s)\n",
                      numerics.courant * particles.spacing / simulation.velocity_scale(),
                      numerics.courant, simulation.velocity_scale());
  const std::string of_mode = fmt::format(", {} of what its fastest mode holds", kept_of_limit);
  for (const auto* limit : simulation.effects().limits) {
    const double explicitly = stable_time_step(limit->fastest_mode(simulation.state()));
    const bool of_a_mode = std::isfinite(explicitly);
    text += fmt::format(
        "  {:.4g} s: {}{}\n",
        of_a_mode ? kept_of_limit * explicitly : limit->largest_time_step(simulation.state()),
        limit->limit_name(), of_a_mode ? of_mode : "");
  }
  if (scene.solid && numerics.spring_integration == SpringIntegration::implicit_force)
    text += fmt::format(
        "  no limit: springs, implicit (explicit ones would need {:.4g} s)\n",
        kept_of_limit * stable_time_step(scene.solid->fastest_mode(simulation.state())));

  const double set_up = processor_seconds();
  const Sample steps = sample(simulation, scene.problem.end_time);
  const double count = std::ceil(scene.problem.end_time / step.value);
  const bool whole = steps.steps >= 0.9 * count;  // then the later steps were sampled, too
  const double expected = set_up + count * steps.per_step * (whole ? 1.0 : Sample::later);
  constexpr double record_bytes = 8e6;  // the record's buffers, measured, at any size
  text += fmt::format(
      "\nCost on this machine, one thread, from {} steps of this scene\n"
      "  {:.0f} steps of {:.3g} ms{}, {:.2g} s of set-up: {:.3g} s of processor time, within a "
      "factor "
      "of 1.5\n"
      "  {:.0f} MB of memory\n",
      steps.steps, count, 1e3 * steps.per_step,
      whole ? ""
            : fmt::format(" and {:.0f} % more once the flow moves", 100.0 * (Sample::later - 1.0)),
      set_up, expected, 1e-6 * (peak_memory_bytes() + record_bytes));
  for (const auto& warning : scene.warnings) text += fmt::format("\nwarning: {}\n", warning);
  return text;
}

template std::string explain<2>(Document&, const ModulusTable&);
template std::string explain<3>(Document&, const ModulusTable&);

}  // namespace sprung::sph
