#include "validation/same_physics.hpp"

#include <fmt/format.h>

#include <vector>

namespace sprung {

namespace {

/// Every fact of a problem by name, in words: two problems are the same if their lists are.
using Facts = std::vector<std::pair<std::string, std::string>>;

std::string text(double value) {
  return fmt::format("{:.12g}", value);
}
std::string text(const Point& p) {
  return fmt::format("({:.12g}, {:.12g}, {:.12g})", p[0], p[1], p[2]);
}
std::string text(const Box& box) {
  return text(box.from) + " to " + text(box.to);
}
std::string text(const std::vector<Side>& sides) {
  std::string all;
  for (const Side side : sides) all += std::string(all.empty() ? "" : ", ") + to_string(side);
  return all.empty() ? "none" : all;
}
std::string text(const std::vector<double>& values) {
  std::string all;
  for (const double value : values) all += (all.empty() ? "" : ", ") + text(value);
  return all;
}

void add_boundaries(const Problem& problem, Facts& facts) {
  facts.emplace_back("walls no_slip", problem.walls ? text(problem.walls->no_slip) : "no walls");
  facts.emplace_back("walls free_slip",
                     problem.walls ? text(problem.walls->free_slip) : "no walls");
  std::string inflow = "none", outflow = "none";
  if (problem.inflow) {
    const Inflow& in = *problem.inflow;
    inflow = fmt::format("{}, {}, mean {} m/s, ramp {} s", to_string(in.side),
                         in.profile == Inflow::Profile::parabolic ? "parabolic" : "uniform",
                         text(in.mean_velocity), text(in.ramp));
  }
  if (problem.outflow) {
    outflow =
        fmt::format("{}, {} Pa", to_string(problem.outflow->side), text(problem.outflow->pressure));
  }
  if (problem.pressure_inflow)
    inflow = fmt::format("{}, {} Pa", to_string(problem.pressure_inflow->side),
                         text(problem.pressure_inflow->pressure));
  facts.emplace_back("inflow", inflow);
  facts.emplace_back("outflow", outflow);
}

void add_probes(const Probes& probes, Facts& facts) {
  for (const auto& probe : probes.displacement) {
    facts.emplace_back("probe " + probe.name, "displacement of " + text(probe.point));
  }
  for (const auto& probe : probes.velocity_profile) {
    facts.emplace_back("probe " + probe.name,
                       fmt::format("velocity from {} to {}, {} points, at {} s", text(probe.from),
                                   text(probe.to), probe.points, text(probe.times)));
  }
  for (const auto& probe : probes.force) {
    facts.emplace_back("probe " + probe.name, "force on " + probe.solid + probe.curved_wall);
  }
  for (const auto& probe : probes.outline) {
    facts.emplace_back("probe " + probe.name,
                       fmt::format("outline of {}, {} points, at {} s", probe.solid, probe.points,
                                   text(probe.times)));
  }
}

Facts facts_of(const Problem& problem) {
  Facts facts;
  facts.emplace_back("dimension", std::to_string(problem.dimension));
  facts.emplace_back("channel", text(problem.channel));
  facts.emplace_back("end time", text(problem.end_time));
  facts.emplace_back("density", text(problem.density));
  facts.emplace_back("viscosity",
                     problem.viscosity ? text(problem.viscosity->dynamic) : std::string("none"));
  if (problem.viscosity && problem.viscosity->carreau_yasuda) {
    const auto& law = *problem.viscosity->carreau_yasuda;
    facts.emplace_back("carreau_yasuda", fmt::format("{}, {}, {}, {}", text(law.high_shear),
                                                     text(law.relaxation_time), text(law.power),
                                                     text(law.transition)));
  }
  add_boundaries(problem, facts);
  for (const Solid& solid : problem.solids) {
    const std::string name = "solid." + solid.name;
    facts.emplace_back(name + " body", text(solid.body));
    facts.emplace_back(name + " angle", text(solid.angle));
    if (solid.arc)
      facts.emplace_back(name + " ring",
                         fmt::format("centre ({}, {}), radii {} to {}, angles {} to {}",
                                     text(solid.arc->centre[0]), text(solid.arc->centre[1]),
                                     text(solid.arc->inner_radius), text(solid.arc->outer_radius),
                                     text(solid.arc->from_angle), text(solid.arc->to_angle)));
    facts.emplace_back(name + " youngs_modulus", text(solid.youngs_modulus));
    if (const auto& law = solid.stiffening)
      facts.emplace_back(name + " stiffening", text(law->ratio) + ", " + text(law->toe_strain));
    if (const auto& law = solid.viscoelasticity)
      facts.emplace_back(name + " viscoelastic",
                         text(law->modulus) + ", " + text(law->relaxation_time));
    if (const auto& law = solid.fibre)
      facts.emplace_back(name + " fibre", text(law->angle) + ", " + text(law->elevation) + ", " +
                                              text(law->modulus));
    facts.emplace_back(name + " clamped", solid.clamped ? to_string(*solid.clamped) : "free");
  }
  add_probes(problem.probes, facts);
  return facts;
}

}  // namespace

std::optional<std::string> first_difference(const Problem& reference, const Problem& candidate) {
  const Facts a = facts_of(reference), b = facts_of(candidate);
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    if (i >= a.size()) return b[i].first + ": not in the reference";
    if (i >= b.size()) return a[i].first + ": in the reference only";
    if (a[i].first != b[i].first) return a[i].first + " against " + b[i].first;
    if (a[i].second != b[i].second)
      return a[i].first + ": " + a[i].second + " against " + b[i].second;
  }
  return std::nullopt;
}

}  // namespace sprung
