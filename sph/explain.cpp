#include "sph/explain.hpp"

#include "scene/body_shape.hpp"

#include "scene/progress.hpp"
#include "sph/time_step.hpp"

#include <sys/resource.h>

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

}  // namespace

template <int dim>
std::string explain(Document& document, const ModulusTable& table) {
  auto scene = set_up<dim>(document, table);
  auto& simulation = *scene.simulation;
  const auto& particles = simulation.state().particles;
  std::string text = fmt::format("{}\n{} particles with an equation ({} solid), {} prescribed\n",
                                 scene.problem.title, particles.unknowns, particles.solids,
                                 particles.size() - particles.unknowns);
  text += "\nNumbers that decide\n" +
          numbers_of(scene.problem, simulation.velocity_scale(), particles.spacing);
  text += "\nEffects that the scene calls for\n";
  for (const auto& line : scene.effects) text += "  " + line + "\n";
  text += "\nOff\n";
  for (const auto& line : scene.effects_off) text += "  " + line + "\n";
  if (scene.effects_off.empty()) text += "  none\n";
  const auto& numerics = simulation.numerics();
  const auto step = simulation.chosen_time_step();
  text += fmt::format("\nTime step\n  {:.4g} s, set by {}\n", step.value, step.limit);
  text += fmt::format("  {:.4g} s: CFL, courant {} x spacing / velocity scale ({} m/s)\n",
                      numerics.courant * particles.spacing / simulation.velocity_scale(),
                      numerics.courant, simulation.velocity_scale());
  for (const auto* limit : simulation.effects().limits)
    text += fmt::format("  {:.4g} s: {}\n", limit->largest_time_step(simulation.state()),
                        limit->limit_name());
  if (scene.solid && numerics.spring_integration == SpringIntegration::implicit_force)
    text += fmt::format("  no limit: springs, implicit (explicit ones would need {:.4g} s)\n",
                        scene.solid->largest_time_step(simulation.state()));

  omp_set_num_threads(1);
  constexpr int first = 2, steps = 8;
  double began = 0.0;
  for (int k = 0; k < steps; ++k) {
    if (k == first) began = processor_seconds();
    advance(simulation);
  }
  const double per_step = (processor_seconds() - began) / (steps - first);
  const double count = std::ceil(scene.problem.end_time / step.value);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  text += fmt::format(
      "\nCost on this machine, one thread, from {} steps of this scene\n"
      "  {:.0f} steps of {:.3g} ms: {:.3g} s of processor time (a moving flow takes about "
      "a quarter more)\n  {:.0f} MB of memory\n",
      steps, count, 1e3 * per_step, count * per_step, double(usage.ru_maxrss) / 1024.0);
  for (const auto& warning : scene.warnings) text += fmt::format("\nwarning: {}\n", warning);
  return text;
}

template std::string explain<2>(Document&, const ModulusTable&);
template std::string explain<3>(Document&, const ModulusTable&);

}  // namespace sprung::sph
