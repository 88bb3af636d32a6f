/// sprung-reference-solid: a block of elastic solid in space under stresses on its faces, by finite
/// elements. What is solved, and how: solid_block.hpp.

#include "reference_fem/solid_block.hpp"

#include "scene/atomic_file.hpp"
#include "scene/command_line.hpp"
#include "scene/manifest.hpp"
#include "scene/progress.hpp"

#include <deal.II/base/config.h>
#include <deal.II/base/multithread_info.h>

#include <fmt/format.h>

#include <filesystem>

namespace {

using namespace sprung;
using reference::BlockState;
using reference::SolidBlock;

struct Arguments {
  SolidBlock block;
  std::vector<double> size = {0.1, 0.1, 0.1};
  std::vector<int> cells = {2, 2, 2};
  std::vector<double> stress = {0.0, 0.0, 0.0};
  std::filesystem::path out;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("--youngs-modulus", a.block.youngs_modulus, "Pa, at small strain")
      ->required()
      ->check(CLI::Range(1e-3, 1e15));
  app.add_option("--poisson-ratio", a.block.poisson_ratio, "0.5: incompressible")
      ->capture_default_str();
  app.add_option("--size", a.size, "edges of the block, m")->expected(3)->capture_default_str();
  app.add_option("--cells", a.cells, "cells along each edge")->expected(3)->capture_default_str();
  app.add_option("--stress", a.stress,
                 "tensile stress on the faces across x, y and z, Pa; a pressure is negative")
      ->expected(3);
  app.add_flag(
      "--follows", a.block.follows,
      "stresses are per deformed area and stay normal, as a fluid's pressure; else nominal");
  app.add_flag("--glued", a.block.glued, "both faces across x are glued to rigid plates");
  app.add_option("--shear", a.block.shear,
                 "simple shear u_x = shear y, prescribed on the faces across x and y");
  app.add_option("--increments", a.block.increments, "load increments, each a row of the table")
      ->capture_default_str();
  app.add_option("--out", a.out, "CSV file; its manifest gets the same name with .json")
      ->required();
}

std::string table(const SolidBlock& block, const std::vector<BlockState>& states) {
  std::string csv =
      "load [1],stretch_x [1],stretch_y [1],stretch_z [1],nominal_x [Pa],nominal_y [Pa],"
      "nominal_z [Pa],shear_stress [Pa],pressure [Pa],volume_ratio [1],energy [J],"
      "spread_x [1],uniaxial_x [Pa],newton_iterations [1]\n";
  for (const BlockState& s : states)
    csv += fmt::format(
        "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},"
        "{:.17g},{:.17g},{}\n",
        s.load, s.stretch[0], s.stretch[1], s.stretch[2], s.nominal[0], s.nominal[1], s.nominal[2],
        s.shear_stress, s.mean_pressure, s.volume_ratio, s.energy, s.spread[0],
        reference::uniaxial_stress(block.youngs_modulus, s.stretch[0]), s.iterations);
  return csv;
}

std::string manifest(const Arguments& a, double processor_start, double wall_start) {
  const SolidBlock& b = a.block;
  FullManifest manifest;
  manifest.run.solver = "reference_solid";
  manifest.run.scene_title = "A block of elastic solid";
  manifest.run.scene_file = a.out.filename().string();
  manifest.run.scene_toml = fmt::format(
      "size = [{}]\ncells = [{}]\nyoungs_modulus = {}\npoisson_ratio = {}\nstress = [{}]\n"
      "follows = {}\nglued = {}\nshear = {}\nincrements = {}\n",
      fmt::join(b.size, ", "), fmt::join(b.cells, ", "), b.youngs_modulus, b.poisson_ratio,
      fmt::join(b.stress, ", "), b.follows, b.glued, b.shear, b.increments);
  manifest.run.libraries = {{"deal.II", DEAL_II_PACKAGE_VERSION}};
  manifest.run.notes["uniaxial_x"] =
      "E/3 (s - s^-2) at s = stretch_x: the closed form of incompressible uniaxial tension";
  manifest.run.notes["nominal"] = "mean first Piola-Kirchhoff stress over the undeformed block";
  manifest.run.processor_start = processor_start;
  manifest.run.wall_start = wall_start;
  manifest.start_time_utc = utc_now();
  manifest.outcome = "finished";
  return manifest_json(manifest);
}

int work(Arguments& a) {
  const double processor_start = processor_seconds(), wall_start = wall_seconds();
  dealii::MultithreadInfo::set_thread_limit(1);
  for (std::size_t d = 0; d < 3; ++d)
    a.block.size[d] = a.size[d], a.block.cells[d] = a.cells[d], a.block.stress[d] = a.stress[d];
  const std::string csv = table(a.block, reference::solve_block(a.block));
  write_text_file(a.out, csv);
  std::filesystem::path json = a.out;
  write_text_file(json.replace_extension(".json"), manifest(a, processor_start, wall_start));
  fmt::print("{}", csv);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "A block of elastic solid under stresses on its faces, by finite elements in space "
      "(deal.II)\n\n"
      "Examples:\n"
      "  sprung-reference-solid --youngs-modulus 1e5 --stress 1e4 0 0 --out cube.csv\n"
      "  sprung-reference-solid --youngs-modulus 1e5 --stress 1e4 1e4 0 --follows --out "
      "biaxial.csv\n"
      "  sprung-reference-solid --youngs-modulus 1e5 --shear 0.3 --out shear.csv\n\n"
      "Exit codes: 0 done; 1 no equilibrium, or a file cannot be written; 2 the command line is "
      "not "
      "understood"};
  Arguments a;
  declare(app, a);
  return run_program(app, argc, argv, [&] { return work(a); });
}
