#include "sph/guard.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace sprung::sph {

namespace {

/// Steps between two looks at what takes a pass over all pairs.
constexpr std::int64_t steps_between_sweeps = 10;

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
std::string Guard<dim>::where(std::size_t i) const {
  const auto& particles = scene_.simulation->state().particles;
  return fmt::format("particle {} ({}) at {}", particles.identity[i], name_of(particles.role[i]),
                     place<dim>(particles.position[i]));
}

template <int dim>
std::string Guard<dim>::when() const {
  const Clock& clock = scene_.simulation->state().clock;
  return fmt::format("at t = {:.6g} s, step {}", clock.time, clock.step);
}

template <int dim>
std::optional<std::string> Guard<dim>::find_fault() {
  if (auto fault = motion_fault()) return fault;
  if (auto fault = spring_fault()) return fault;
  const auto& simulation = *scene_.simulation;
  const auto lost = simulation.books().lost + simulation.books().upstream;
  if (static_cast<double>(lost) >
      range_.crowd * static_cast<double>(simulation.state().particles.unknowns))
    return fmt::format(
        "{} particles have been lost ({} through walls, {} against the inflow), {}; use a smaller "
        "time step, a smaller spacing or stronger shifting",
        lost, simulation.books().lost, simulation.books().upstream, when());
  if (simulation.state().clock.step % steps_between_sweeps != 0) return std::nullopt;
  if (auto fault = crowd_fault()) return fault;
  return volume_fault();
}

/// Numbers that are none, single speeds, and the energy of all.
template <int dim>
std::optional<std::string> Guard<dim>::motion_fault() const {
  const auto& simulation = *scene_.simulation;
  const auto& particles = simulation.state().particles;
  const double scale = simulation.velocity_scale();
  const double fastest2 = std::pow(range_.speed * scale, 2);
  double sum2 = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double speed2 = particles.velocity[i].squaredNorm();
    // Any of them not a number makes the sum none.
    if (!std::isfinite(particles.position[i].sum() + particles.pseudo_pressure[i] + speed2))
      return fmt::format(
          "{} has a place, speed or pressure that is not a number, {}; use a "
          "smaller time step (now {:.3g} s)",
          where(i), when(), simulation.state().clock.time_step);
    if (speed2 > fastest2)
      return fmt::format(
          "{} moves at {:.4g} m/s, more than {} times the velocity scale of {:.4g} "
          "m/s, {}; use a smaller time step (now {:.3g} s){}",
          where(i), std::sqrt(speed2), range_.speed, scale, when(),
          simulation.state().clock.time_step,
          particles.role[i] == Role::solid
              ? " or numerics.spring_integration = \"implicit\""
              : ", a smaller spacing or, if the flow is that fast, a larger "
                "sph.velocity_scale");
    if (i < particles.unknowns) sum2 += speed2;
  }
  const double rms = std::sqrt(sum2 / static_cast<double>(particles.unknowns));
  if (rms > range_.rms_speed * scale)
    return fmt::format(
        "the kinetic energy is that of a speed of {:.4g} m/s everywhere, more than "
        "{} times the velocity scale of {:.4g} m/s, {}; use a smaller time step "
        "(now {:.3g} s), a smaller spacing or, if the flow is that fast, a larger "
        "sph.velocity_scale",
        rms, range_.rms_speed, scale, when(), simulation.state().clock.time_step);
  return std::nullopt;
}

template <int dim>
std::optional<std::string> Guard<dim>::spring_fault() {
  if (!scene_.solid) return std::nullopt;
  const auto& particles = scene_.simulation->state().particles;
  const auto& network = scene_.solid->network();
  const auto at = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network.movable ? particles.position[node]
                                                            : network.reference[node];
  };
  std::size_t beyond = 0;
  for (const Bond& bond : network.bonds) {
    const double stretch = (at(bond.a) - at(bond.b)).norm() / bond.rest_length;
    const double strain = std::abs(stretch - 1.0);
    beyond += strain > calibrated_strain(dim);
    if (strain > strain_.largest) {
      const auto end = static_cast<std::size_t>(std::min(bond.a, bond.b));
      strain_.largest = strain;
      strain_.time = scene_.simulation->state().clock.time;
      strain_.particle = end < network.movable ? particles.identity[end] : -1;
    }
    if (stretch > range_.least_stretch && stretch < range_.most_stretch) continue;
    return fmt::format(
        "the spring of {} has {:.3g} times its rest length, {} (sound range: {} to "
        "{}); use a smaller time step (now {:.3g} s) or a stiffer body",
        where(static_cast<std::size_t>(std::min(bond.a, bond.b))), stretch, when(),
        range_.least_stretch, range_.most_stretch, scene_.simulation->state().clock.time_step);
  }
  strain_.share = std::max(strain_.share,
                           static_cast<double>(beyond) / static_cast<double>(network.bonds.size()));
  return std::nullopt;
}

template <int dim>
void Guard<dim>::save(Archive& archive) const {
  if (!scene_.solid) return;
  archive["spring_strain"] = std::vector<double>{
      strain_.largest, strain_.time, static_cast<double>(strain_.particle), strain_.share};
}

template <int dim>
void Guard<dim>::restore(const Archive& archive) {
  if (!scene_.solid) return;
  const auto& values = std::get<std::vector<double>>(archive.at("spring_strain"));
  strain_ = {values[0], values[1], static_cast<std::int64_t>(values[2]), values[3]};
}

std::string SpringStrain::told(int dimension) const {
  const double range = calibrated_strain(dimension);
  if (within(dimension))
    return fmt::format(
        "springs strained by up to {:.2g} %, within the {:g} % that lambda holds for",
        100.0 * largest, 100.0 * range);
  return fmt::format(
      "springs were strained by up to {:.3g} % (particle {}, at t = {:.4g} s), up to {:.2g} % of "
      "them beyond the {:g} % to which a body of these springs carries the stress of its E within "
      "1 %; calibration/stress_strain.csv holds what springs carry at larger strains",
      100.0 * largest, particle, time, 100.0 * share, 100.0 * range);
}

/// Clumps and voids: the gradient factor falls with the distance, so the largest is the closest
/// pair's; the partition without the particle's own part says how full the support is.
template <int dim>
std::optional<std::string> Guard<dim>::crowd_fault() const {
  const auto& state = scene_.simulation->state();
  const auto& particles = state.particles;
  const double own = particles.volume * state.kernel.value(0.0);
  const double near = std::abs(state.kernel.gradient_factor(range_.closest * particles.spacing));
  std::size_t clumped = 0, starved = 0, tightest = 0, emptiest = 0;
  double largest = 0.0, least = 2.0;
  for (std::size_t i = particles.solids; i < particles.unknowns; ++i) {
    double factor = 0.0;
    for (const double f : state.support.of(i).gradient_factor)
      factor = std::max(factor, std::abs(f));
    const double filling = (state.support.partition()[i] - own) / (1.0 - own);
    clumped += factor > near;
    starved += filling < range_.emptiest;
    if (factor > largest) largest = factor, tightest = i;
    if (filling < least) least = filling, emptiest = i;
  }
  const double allowed = std::max(
      range_.few, range_.crowd * static_cast<double>(particles.unknowns - particles.solids));
  if (static_cast<double>(clumped) > allowed)
    return fmt::format(
        "{} particles have a neighbour closer than {} spacings, {} the closest, {}; "
        "use stronger shifting or a smaller time step (now {:.3g} s)",
        clumped, range_.closest, where(tightest), when(), state.clock.time_step);
  if (static_cast<double>(starved) > allowed)
    return fmt::format(
        "{} particles stand in a void, with less than {} of their support filled, "
        "{} the most ({:.2g}), {}; use a smaller spacing, more numerics.density_"
        "feedback or a smaller time step (now {:.3g} s)",
        starved, range_.emptiest, where(emptiest), least, when(), state.clock.time_step);
  return std::nullopt;
}

template <int dim>
std::optional<std::string> Guard<dim>::volume_fault() {
  auto& simulation = *scene_.simulation;
  const double passage = simulation.state().particles.spacing / simulation.velocity_scale();
  const double divergence = simulation.remaining_divergence();
  if (!(divergence * passage < range_.divergence))
    return fmt::format(
        "the velocity has a divergence of {:.4g} 1/s (rms), more than {} of velocity "
        "scale over spacing, {}; use a smaller time step (now {:.3g} s) or a smaller "
        "numerics.pressure_tolerance",
        divergence, range_.divergence, when(), simulation.state().clock.time_step);
  if (!scene_.solid) return std::nullopt;
  const auto& particles = simulation.state().particles;
  const double volume =
      volume_ratio<dim>(scene_.solid->network(), {particles.position.data(), particles.solids});
  if (!(volume > range_.least_volume && volume < range_.most_volume))
    return fmt::format(
        "the bodies have {:.4g} times their volume at rest, {} (sound range: {:.3g} "
        "to {:.3g}); use a larger numerics.area_stiffness or a smaller time step "
        "(now {:.3g} s)",
        volume, when(), range_.least_volume, range_.most_volume,
        simulation.state().clock.time_step);
  return std::nullopt;
}

template class Guard<2>;
template class Guard<3>;

}  // namespace sprung::sph
