#include "sph/guard.hpp"

#include <cmath>

#include <fmt/format.h>

namespace sprung::sph {

namespace {

const char* name_of(Role role) {
  switch (role) {
    case Role::solid:
      return "solid";
    case Role::fluid:
      return "fluid";
    case Role::inflow:
      return "of an inflow column";
    case Role::outflow:
      return "of an outflow column";
  }
  return "";
}

template <int dim>
std::string place(const Vector<dim>& x) {
  std::string text = fmt::format("({:.4g}", x[0]);
  for (int d = 1; d < dim; ++d) text += fmt::format(", {:.4g}", x[d]);
  return text + ") m";
}

}  // namespace

template <int dim>
std::optional<std::string> find_fault(const ParticleScene<dim>& scene) {
  const auto& simulation = *scene.simulation;
  const auto& particles = simulation.state().particles;
  const Clock& clock = simulation.state().clock;
  const double fastest = 10.0 * simulation.velocity_scale();
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double speed = particles.velocity[i].norm();
    if (std::isfinite(speed) && speed <= fastest) continue;
    return fmt::format(
        "particle {} ({}) at {} moves at {:.4g} m/s, more than 10 times the velocity scale of "
        "{:.4g} m/s, "
        "at t = {:.6g} s; use a smaller time step (now {:.3g} s){}",
        particles.identity[i], name_of(particles.role[i]), place<dim>(particles.position[i]), speed,
        simulation.velocity_scale(), clock.time, clock.time_step,
        particles.role[i] == Role::solid ? " or numerics.spring_integration = \"implicit\"" : "");
  }
  if (scene.solid) {
    const std::span<const Vector<dim>> position{particles.position.data(), particles.solids};
    const auto [least, most] = stretch_range(scene.solid->network(), position);
    if (!(least > 0.5 && most < 2.0))
      return fmt::format(
          "a spring has {:.3g} times its rest length at t = {:.6g} s (sound range: 0.5 to "
          "2); use a smaller time step or a stiffer body",
          least < 0.5 ? least : most, clock.time);
  }
  const auto lost = simulation.books().lost + simulation.books().upstream;
  if (lost > static_cast<std::int64_t>(particles.unknowns / 100))
    return fmt::format(
        "{} particles have been lost by t = {:.6g} s ({} through walls, {} against the "
        "inflow); use a smaller time step or stronger shifting",
        lost, clock.time, simulation.books().lost, simulation.books().upstream);
  return std::nullopt;
}

template std::optional<std::string> find_fault<2>(const ParticleScene<2>&);
template std::optional<std::string> find_fault<3>(const ParticleScene<3>&);

}  // namespace sprung::sph
