#include "sph/numerics.hpp"

#include "sph/effects/shifting.hpp"

#include <array>
#include <utility>

#include <fmt/format.h>

namespace sprung::sph {

namespace {

Numerics paper() {
  return {.preset = "paper",
          .smoothing_length_ratio = 1.0,
          .normalised_gradient = false,
          .gradient_correction = false,
          .position_update = PositionUpdate::mean_velocity,
          .shifting = Shifting::xu,
          .volume_along_step = false,
          .density_feedback = 0.0,
          .void_feedback = 0.0,
          .pressure_tolerance = 1e-4,
          .pressure_solver = PressureSolverKind::two_level,
          .body_projections = 1,
          .bonds = Bonds::equal,
          .fitted_bodies = false,
          .solid_no_slip = SolidNoSlip::centres,
          .surface_correction = false,
          .area_stiffness = 0.0,
          .spring_integration = SpringIntegration::explicit_force,
          .courant = 0.25};
}

Numerics recommended() {
  return {.preset = "recommended",
          .smoothing_length_ratio = 1.3,
          .normalised_gradient = true,
          .gradient_correction = true,
          .position_update = PositionUpdate::new_velocity,
          .shifting = Shifting::sliding,
          .volume_along_step = true,
          .density_feedback = 0.1,
          .void_feedback = 2.0,
          .pressure_tolerance = 1e-3,
          .pressure_solver = PressureSolverKind::two_level,
          .body_projections = 3,
          .bonds = Bonds::isotropic,
          .fitted_bodies = true,
          .solid_no_slip = SolidNoSlip::face,
          .surface_correction = true,
          .area_stiffness = 300.0,
          .spring_integration = SpringIntegration::implicit_force,
          .courant = 0.4};
}

double default_coefficient(Shifting shifting) {
  switch (shifting) {
    case Shifting::none:
      return 0.0;
    case Shifting::xu:
      return XuDirection::default_coefficient;
    case Shifting::fickian:
      return FickianDirection::default_coefficient;
    case Shifting::sliding:
      return SlidingDirection::default_coefficient;
  }
  return 0.0;
}

/// Reads a choice written as a word; the words stand in the order of the enumeration.
template <typename Choice>
void choose(const Table& table, const std::string& key, const std::vector<std::string>& words,
            Choice& value) {
  const std::string word = table.word_or(key, words, words[static_cast<std::size_t>(value)]);
  for (std::size_t k = 0; k < words.size(); ++k)
    if (words[k] == word) value = static_cast<Choice>(k);
}

void read_between(const Table& table, const std::string& key, double low, double high,
                  double& value) {
  value = table.number_or(key, value);
  if (value < low || value > high)
    table.refuse(key, fmt::format("must lie between {} and {}", low, high));
}

}  // namespace

Numerics read_numerics(Document& document) {
  const Table table = document.table_or_new("numerics");
  Numerics n = table.word_or("preset", {"recommended", "paper"}, "recommended") == "paper"
                   ? paper()
                   : recommended();
  read_between(table, "smoothing_length_ratio", 0.8, 2.0, n.smoothing_length_ratio);
  n.normalised_gradient = table.flag_or("normalised_gradient", n.normalised_gradient);
  n.gradient_correction = table.flag_or("gradient_correction", n.gradient_correction);
  choose(table, "position_update", {"mean_velocity", "new_velocity"}, n.position_update);
  choose(table, "shifting", {"none", "xu", "fickian", "sliding"}, n.shifting);
  n.shifting_coefficient = default_coefficient(n.shifting);
  read_between(table, "shifting_coefficient", 0.0, 10.0, n.shifting_coefficient);
  // The mean of two velocities moves the particles otherwise: no single aim keeps its volume.
  n.volume_along_step =
      table.flag_or("volume_along_step",
                    n.volume_along_step && n.position_update == PositionUpdate::new_velocity);
  if (n.volume_along_step && n.position_update != PositionUpdate::new_velocity)
    table.refuse("volume_along_step", "needs position_update = \"new_velocity\"");
  read_between(table, "density_feedback", 0.0, 100.0, n.density_feedback);
  read_between(table, "void_feedback", 0.0, 100.0, n.void_feedback);
  read_between(table, "pressure_tolerance", 1e-14, 0.5, n.pressure_tolerance);
  choose(table, "pressure_solver",
         {"bicgstab", "two_level", "jacobi_cg", "incomplete_cholesky", "cholmod", "boomeramg"},
         n.pressure_solver);
  const long projections = table.integer_or("body_projections", n.body_projections);
  if (projections < 1 || projections > 10)
    table.refuse("body_projections", "must lie between 1 and 10");
  n.body_projections = static_cast<int>(projections);
  choose(table, "bonds", {"equal", "isotropic"}, n.bonds);
  n.fitted_bodies = table.flag_or("fitted_bodies", n.fitted_bodies);
  choose(table, "solid_no_slip", {"centres", "face"}, n.solid_no_slip);
  n.surface_correction = table.flag_or("surface_correction", n.surface_correction);
  read_between(table, "area_stiffness", 0.0, 1e4, n.area_stiffness);
  choose(table, "spring_integration", {"explicit", "implicit"}, n.spring_integration);
  read_between(table, "courant", 1e-4, 2.0, n.courant);
  return n;
}

}  // namespace sprung::sph
