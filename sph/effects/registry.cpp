#include "sph/effects/registry.hpp"

#include "scene/body_shape.hpp"
#include "sph/effects/calibrated_strain.hpp"
#include "sph/effects/fibre.hpp"
#include "sph/effects/gravity.hpp"
#include "sph/effects/moving_walls.hpp"
#include "sph/effects/printed_integrator.hpp"
#include "sph/effects/shifting.hpp"
#include "sph/effects/stiffening.hpp"
#include "sph/effects/viscoelastic.hpp"
#include "sph/effects/viscosity.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace sprung::sph {

namespace {

/// `law`: of the viscosity, see ViscosityEffect.
template <int dim, class Law>
void add_viscosity_of(ParticleScene<dim>& scene, Law law) {
  auto& simulation = *scene.simulation;
  const double nu = scene.problem.viscosity->dynamic / scene.problem.density;
  std::shared_ptr<SolidSurface<dim>> surface;
  if (!scene.bodies.empty() && simulation.numerics().solid_no_slip == SolidNoSlip::face) {
    std::vector<typename SolidSurface<dim>::Body> bodies;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b)
      bodies.push_back({scene.problem.solids[b], scene.bodies[b].first, scene.bodies[b].last});
    surface = std::make_shared<SolidSurface<dim>>(bodies, simulation.state().particles);
  }
  auto effect = std::make_unique<ViscosityEffect<dim, Law>>(nu, simulation.state().particles,
                                                            surface, std::move(law));
  simulation.effects().limits.push_back(effect.get());
  simulation.effects().diffusion.push_back(std::move(effect));
  scene.effects.push_back(
      fmt::format("viscosity: the scene has [viscosity], nu = {:.3g} m2/s", nu));
}

template <int dim>
bool add_viscosity(ParticleScene<dim>& scene, const ModulusTable&) {
  if (!scene.problem.viscosity) return false;
  // Else the next row's, with its law.
  if (!scene.problem.viscosity->carreau_yasuda) add_viscosity_of<dim>(scene, Newtonian<dim>{});
  return true;
}

template <int dim>
bool add_carreau_yasuda(ParticleScene<dim>& scene, const ModulusTable&) {
  if (!scene.problem.viscosity || !scene.problem.viscosity->carreau_yasuda) return false;
  for (const ForceProbe& probe : scene.problem.probes.force)
    if (!probe.curved_wall.empty())
      throw SceneError(fmt::format(
          "[probes.{}] force_on = \"{}\": the force on a curved wall is measured with a constant "
          "viscosity; leave out the probe or [viscosity.carreau_yasuda]",
          probe.name, probe.curved_wall));
  const Viscosity& viscosity = *scene.problem.viscosity;
  const CarreauYasuda& law = *viscosity.carreau_yasuda;
  add_viscosity_of<dim>(scene, CarreauYasudaLaw<dim>(law, viscosity.dynamic));
  scene.effects.push_back(
      fmt::format("Carreau-Yasuda: the scene has [viscosity.carreau_yasuda], {:.3g} Pa s at rest "
                  "to {:.3g} Pa s,"
                  " falling from {:.3g} 1/s on",
                  viscosity.dynamic, law.high_shear, 1.0 / law.relaxation_time));
  return true;
}

template <int dim>
bool add_gravity(ParticleScene<dim>& scene, const ModulusTable&) {
  if (!scene.problem.gravity) return false;
  auto& simulation = *scene.simulation;
  auto effect = std::make_unique<GravityEffect<dim>>(*scene.problem.gravity,
                                                     simulation.state().images.periodic());
  scene.effects.push_back(
      effect->drives()
          ? "gravity: the scene has [gravity], and a periodic axis along which it drives the flow"
          : "gravity: the scene has [gravity]; pressure balances it, the motion does not feel it");
  simulation.effects().time_dependence.push_back(effect.get());
  simulation.effects().body_forces.push_back(std::move(effect));
  return true;
}

template <int dim>
bool add_moving_walls(ParticleScene<dim>& scene, const ModulusTable&) {
  if (scene.problem.wall_motion.empty()) return false;
  auto& effects = scene.simulation->effects();
  effects.prescriptions.push_back(std::make_unique<MovingWalls<dim>>(
      scene.problem.wall_motion, scene.simulation->state().images));
  effects.time_dependence.push_back(effects.prescriptions.back().get());
  for (const auto& motion : scene.problem.wall_motion)
    scene.effects.push_back(fmt::format("moving wall: [wall_motion.{}]", to_string(motion.side)));
  return true;
}

/// Bonds of one body: appended in one go.
struct BondRange {
  std::size_t first, last;
};

template <int dim>
void note_law(ParticleScene<dim>& scene, const char* law, const Solid& solid,
              const std::string& numbers) {
  scene.effects.push_back(fmt::format("{}: [solid.{}.{}], {}", law, solid.name, law, numbers));
}

template <int dim>
BondRange bonds_of_body(const ParticleScene<dim>& scene, std::size_t body) {
  const auto& network = scene.solid->network();
  const auto first = static_cast<std::int32_t>(scene.bodies[body].first);
  const auto last = static_cast<std::int32_t>(scene.bodies[body].last);
  const auto own = [&](const Bond& bond) {
    const std::int32_t node = std::min(bond.a, bond.b);  // ghosts have the larger numbers
    return node >= first && node < last;
  };
  const auto begin = std::find_if(network.bonds.begin(), network.bonds.end(), own);
  const auto end = std::find_if_not(begin, network.bonds.end(), own);
  return {static_cast<std::size_t>(begin - network.bonds.begin()),
          static_cast<std::size_t>(end - network.bonds.begin())};
}

template <int dim>
std::vector<double> bulk_stiffness(const ParticleScene<dim>& scene, const BondRange& range) {
  const auto& all = scene.solid->network().bulk_stiffness;
  return {all.begin() + static_cast<std::ptrdiff_t>(range.first),
          all.begin() + static_cast<std::ptrdiff_t>(range.last)};
}

template <int dim>
bool add_stiffening(ParticleScene<dim>& scene, const ModulusTable&) {
  bool any = false;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Solid& solid = scene.problem.solids[b];
    if (!solid.stiffening) continue;
    const BondRange range = bonds_of_body(scene, b);
    std::vector<double> rest;
    for (std::size_t k = range.first; k < range.last; ++k)
      rest.push_back(scene.solid->network().bonds[k].rest_length);
    scene.solid->add(std::make_unique<Stiffening>(range.first, bulk_stiffness(scene, range),
                                                  std::move(rest), *solid.stiffening));
    note_law(scene, "stiffening", solid,
             fmt::format("{} x the modulus beyond a strain of {}", solid.stiffening->ratio,
                         solid.stiffening->toe_strain));
    any = true;
  }
  return any;
}

template <int dim>
bool add_viscoelastic(ParticleScene<dim>& scene, const ModulusTable&) {
  bool any = false;
  auto& simulation = *scene.simulation;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Solid& solid = scene.problem.solids[b];
    if (!solid.viscoelasticity) continue;
    if (simulation.numerics().spring_integration != SpringIntegration::implicit_force)
      throw SceneError(
          fmt::format("[solid.{}.viscoelastic] needs numerics.spring_integration = "
                      "\"implicit\"",
                      solid.name));
    const BondRange range = bonds_of_body(scene, b);
    std::vector<std::int32_t> owner;
    for (std::size_t k = range.first; k < range.last; ++k) {
      const Bond& bond = scene.solid->network().bonds[k];
      owner.push_back(std::min(bond.a, bond.b));
    }
    const auto& law = *solid.viscoelasticity;
    scene.solid->add(std::make_unique<Viscoelastic<dim>>(
        range.first, bulk_stiffness(scene, range), std::move(owner),
        law.modulus / solid.youngs_modulus, law.relaxation_time, simulation.state().particles,
        solid.name));
    note_law(scene, "viscoelastic", solid,
             fmt::format("{:.4g} Pa, relaxing in {:.4g} s", law.modulus, law.relaxation_time));
    any = true;
  }
  return any;
}

/// Largest strain that the flow's dynamic pressure rho U^2 (over both faces) makes in a body: of a
/// clamped one at the clamp, bent like a plate of thickness t over its length L, 3 q (L/t)^2/E; of
/// a free one q/E. Right within a factor of a few: drag depends on shape and Reynolds number.
double expected_strain(const Problem& problem, const Solid& solid, double velocity_scale) {
  const double speed = problem.inflow ? problem.inflow->mean_velocity : velocity_scale;
  const double load = problem.density * speed * speed / solid.youngs_modulus;
  if (!solid.clamped) return load;
  const Point extent = own_extent(solid);
  const auto [thinnest, longest] =
      std::minmax_element(extent.begin(), extent.begin() + problem.dimension);
  return 3.0 * load * std::pow(*longest / *thinnest, 2);
}

template <int dim>
void warn_of_strain(ParticleScene<dim>& scene, const Solid& solid) {
  const double strain = expected_strain(scene.problem, solid, scene.simulation->velocity_scale());
  if (strain <= calibrated_strain(dim)) return;
  scene.warnings.push_back(fmt::format(
      "[solid.{}] is expected to be strained by about {:.2g} % (rho U^2 against E, within a factor "
      "of a few); a body of these springs carries the stress of its E within 1 % up to {:g} %, see "
      "calibration/README.md, Large strains. The run will say how far it was",
      solid.name, 100.0 * strain, 100.0 * calibrated_strain(dim)));
}

template <int dim>
bool add_springs(ParticleScene<dim>& scene, const ModulusTable& table) {
  if (scene.problem.solids.empty()) return false;
  auto& simulation = *scene.simulation;
  auto& particles = simulation.state().particles;
  const Numerics& numerics = simulation.numerics();
  const double lambda = table.modulus_per_stiffness(dim, numerics.bonds, numerics.area_stiffness);
  auto network = network_at_rest(particles);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Solid& solid = scene.problem.solids[b];
    const double k_e = solid.youngs_modulus / lambda;
    append_body(network, particles, scene.bodies[b].first, scene.bodies[b].last, solid, numerics,
                {k_e, network_shear_modulus<dim>(k_e, numerics.bonds)});
    scene.effects.push_back(fmt::format(
        "springs: [solid.{}], {} particles, E = {:.4g} Pa, lambda = {:.4f}, k_e = {:.4g} Pa",
        solid.name, scene.bodies[b].last - scene.bodies[b].first, solid.youngs_modulus, lambda,
        k_e));
    warn_of_strain(scene, solid);
    if (solid.fibre) {
      add_fibres(network, particles, scene.bodies[b].first, scene.bodies[b].last, solid);
      note_law(scene, "fibre", solid, fmt::format("{:.4g} Pa", solid.fibre->modulus));
    }
  }
  auto effect = std::make_unique<ElasticSolid<dim>>(std::move(network), particles,
                                                    numerics.spring_integration);
  scene.solid = effect.get();
  if (numerics.spring_integration == SpringIntegration::implicit_force)
    simulation.effects().constraints.push_back(effect.get());
  else
    simulation.effects().limits.push_back(effect.get());
  simulation.effects().body_forces.push_back(std::move(effect));
  return true;
}

/// Whether a body stands closer to a flat wall that does not hold it than it is long.
template <int dim>
bool may_reach_a_wall(const ParticleScene<dim>& scene, std::size_t body) {
  const auto& state = scene.simulation->state();
  const Point extent = own_extent(scene.problem.solids[body]);
  const double longest = *std::max_element(extent.begin(), extent.begin() + dim);
  const double held = 2.0 * state.particles.spacing;
  for (const auto& wall : state.images.walls()) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = scene.bodies[body].first; i < scene.bodies[body].last; ++i)
      nearest =
          std::min(nearest, wall.inward * (state.particles.position[i][wall.axis] - wall.place));
    if (nearest < longest && (nearest > held || !scene.problem.solids[body].clamped)) return true;
  }
  return false;
}

template <int dim>
bool add_contact(ParticleScene<dim>& scene, const ModulusTable&) {
  bool called_for = scene.bodies.size() > 1;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    called_for = called_for || may_reach_a_wall(scene, b);
  const auto& simulation = *scene.simulation;
  if (!called_for || simulation.numerics().spring_integration != SpringIntegration::implicit_force)
    return false;
  std::vector<typename Contact<dim>::Body> bodies;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    bodies.push_back({scene.bodies[b].first, scene.bodies[b].last,
                      scene.problem.solids[b].youngs_modulus,
                      scene.problem.solids[b].clamped.has_value()});
  const auto& state = simulation.state();
  auto contact =
      std::make_unique<Contact<dim>>(std::move(bodies), state.particles, state.images.walls());
  scene.simulation->effects().limits.push_back(contact.get());
  scene.solid->add(std::move(contact));
  scene.effects.push_back(
      scene.bodies.size() > 1
          ? fmt::format("contact: {} bodies, with each other and with flat walls",
                        scene.bodies.size())
          : fmt::format("contact: [solid.{}] is closer to a wall than it is long",
                        scene.bodies[0].name));
  return true;
}

template <int dim>
bool add_shifting(ParticleScene<dim>& scene, const ModulusTable&) {
  auto& simulation = *scene.simulation;
  const Numerics& numerics = simulation.numerics();
  if (numerics.shifting == Shifting::none) return false;
  const double c = numerics.shifting_coefficient;
  std::unique_ptr<Motion<dim>> effect;
  std::string name = "Lind et al. 2012";
  if (numerics.shifting == Shifting::xu) {
    effect = std::make_unique<ShiftingEffect<dim, XuDirection>>(c);
    name = "Xu et al. 2009";
  } else if (numerics.shifting == Shifting::sliding) {
    effect = std::make_unique<ShiftingEffect<dim, SlidingDirection>>(c);
    name += " at the speed of sliding";
  } else {
    effect = std::make_unique<ShiftingEffect<dim, FickianDirection>>(c);
  }
  simulation.effects().motion.push_back(std::move(effect));
  scene.effects.push_back(fmt::format("shifting: numerics, {}, C = {}", name, c));
  return true;
}

/// Implicit springs moved with the mean velocity: the step's determinant is 1 + (1/2 - a) Z > 1 for
/// every mode.
void refuse_implicit_mean(const Numerics& numerics) {
  if (numerics.position_update == PositionUpdate::mean_velocity &&
      numerics.spring_integration == SpringIntegration::implicit_force)
    throw SceneError(
        "numerics.spring_integration = \"implicit\" with position_update = \"mean_velocity\" is "
        "unstable "
        "at any time step; use position_update = \"new_velocity\"");
}

/// The printed update is unstable for springs without viscosity, so such a scene gets no step at
/// all.
template <int dim>
bool add_printed_integrator(ParticleScene<dim>& scene, const ModulusTable& table) {
  auto& simulation = *scene.simulation;
  const Numerics& numerics = simulation.numerics();
  if (!scene.problem.solids.empty()) refuse_implicit_mean(numerics);
  if (scene.problem.solids.empty() || numerics.position_update != PositionUpdate::mean_velocity ||
      numerics.spring_integration != SpringIntegration::explicit_force)
    return false;
  if (!scene.problem.viscosity)
    throw SceneError(
        "numerics.position_update = \"mean_velocity\" with explicit springs is unstable at any "
        "time step "
        "unless viscosity damps it; add a table [viscosity] or use \"new_velocity\"");
  double stiffest = 0.0;
  for (const Solid& solid : scene.problem.solids)
    stiffest = std::max(stiffest, solid.youngs_modulus);
  const double k_e =
      stiffest / table.modulus_per_stiffness(dim, numerics.bonds, numerics.area_stiffness);
  auto& effects = simulation.effects();
  effects.pure_limits.push_back(std::make_unique<PrintedIntegratorLimit<dim>>(
      scene.problem.viscosity->dynamic, shear_stiffness<dim>(k_e, numerics.bonds), *scene.solid));
  effects.limits.push_back(effects.pure_limits.back().get());
  return true;
}

/// Adds the effect if the scene calls for it; `false` when it does not.
template <int dim>
struct Row {
  const char* effect;
  bool (*add)(ParticleScene<dim>&, const ModulusTable&);
  const char* called_for_by;
};

}  // namespace

template <int dim>
void add_effects(ParticleScene<dim>& scene, const ModulusTable& table) {
  constexpr Row<dim> rows[] = {
      {"viscosity", add_viscosity<dim>, "a table [viscosity]"},
      {"Carreau-Yasuda viscosity", add_carreau_yasuda<dim>, "a table [viscosity.carreau_yasuda]"},
      {"gravity", add_gravity<dim>, "a table [gravity]"},
      {"moving walls", add_moving_walls<dim>, "a table [wall_motion.<side>]"},
      {"springs", add_springs<dim>, "a table [solid.<name>]"},
      {"strain stiffening", add_stiffening<dim>, "a table [solid.<name>.stiffening]"},
      {"viscoelastic springs", add_viscoelastic<dim>, "a table [solid.<name>.viscoelastic]"},
      {"contact", add_contact<dim>,
       "two bodies or more, or one closer to a flat wall than it is long, with implicit springs"},
      {"limit of the printed integrator", add_printed_integrator<dim>,
       "numerics.position_update = \"mean_velocity\" with explicit springs"},
      {"shifting", add_shifting<dim>, "numerics.shifting"},
  };
  for (const auto& row : rows)
    if (!row.add(scene, table))
      scene.effects_off.push_back(
          fmt::format("{}: {} would call for it", row.effect, row.called_for_by));
}

template void add_effects<2>(ParticleScene<2>&, const ModulusTable&);
template void add_effects<3>(ParticleScene<3>&, const ModulusTable&);

}  // namespace sprung::sph
