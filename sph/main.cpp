/// sprung-sph: checks, explains and runs a scene with the particle method.

#include "scene/command_line.hpp"
#include "sph/explain.hpp"
#include "sph/run.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <cstdlib>

namespace {

using namespace sprung;

struct Arguments {
  std::string scene;
  std::vector<std::string> overrides;
  std::string table = SPRUNG_MODULUS_TABLE;
  std::string out;
  int threads = 1;
  bool resume = false;
  bool overwrite = false;
  double until = 0.0;
};

void add_scene_arguments(CLI::App& verb, Arguments& a) {
  verb.add_option("scene", a.scene, "scene file (TOML)")->required();
  verb.add_option("overrides", a.overrides, "table.key=value, checked like the file");
  verb.add_option("--calibration", a.table, "table of lambda = E/k_e");
}

int dispatch(const CLI::App& app, const Arguments& a) {
  Document document(a.scene, a.overrides);
  const sph::ModulusTable table(a.table);
  const bool plane = read_problem(document).dimension == 2;
  if (app.got_subcommand("check")) {
    const auto warnings =
        plane ? sph::set_up<2>(document, table).warnings : sph::set_up<3>(document, table).warnings;
    for (const auto& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
    fmt::print("{}: sound\n", a.scene);
    return 0;
  }
  if (app.got_subcommand("explain")) {
    const std::string text =
        plane ? sph::explain<2>(document, table) : sph::explain<3>(document, table);
    fmt::print("{}", text);
    return 0;
  }
  omp_set_num_threads(a.threads);
  const sph::RunOptions options{a.out, a.resume, a.overwrite, a.until};
  const auto outcome =
      plane ? sph::run<2>(document, table, options) : sph::run<3>(document, table, options);
  return outcome == sph::Outcome::stopped ? 3 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Particle method: incompressible SPH with springs (Monteleone et al.)\n\n"
      "Examples:\n"
      "  sprung-sph check beam.toml\n"
      "  sprung-sph explain beam.toml sph.spacing=\"2.5 mm\"\n"
      "  sprung-sph run beam.toml numerics.preset=paper --out results/paper\n"
      "  sprung-sph run beam.toml --out results/beam --resume\n\n"
      "Exit codes: 0 finished; 1 the scene or a file is not usable; 2 the command line is not "
      "understood;\n3 the run left its sound range and stopped itself, its record whole up to "
      "there."};
  app.require_subcommand(1);
  Arguments a;
  add_scene_arguments(*app.add_subcommand("check", "read the scene and say whether it can be run"),
                      a);
  add_scene_arguments(
      *app.add_subcommand("explain", "say what the scene calls for, and its time step"), a);
  CLI::App& run = *app.add_subcommand("run", "run the scene and write its record");
  add_scene_arguments(run, a);
  run.add_option("--out", a.out, "folder of the record")->required();
  run.add_option("--threads", a.threads, "threads; the bits do not depend on it")
      ->check(CLI::Range(1, 256));
  run.add_flag("--resume", a.resume, "continue from the last checkpoint, if there is one");
  run.add_flag("--overwrite", a.overwrite, "replace a record that stands in --out");
  run.add_option("--until", a.until,
                 "pause after the step that reaches this time (s) and leave a checkpoint")
      ->check([](const std::string& text) {
        return std::atof(text.c_str()) > 0.0 ? "" : "is a time in s above zero, not " + text;
      });
  return run_program(app, argc, argv, [&] { return dispatch(app, a); });
}
