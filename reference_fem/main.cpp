/// sprung-reference: the finite element reference of a scene.
///
///   +-------------------------------------------+      1  read the scene and its overrides
///   |  inflow ->        _                       |      2  mesh fluid and bodies (mesh.hpp)
///   |                  | |   fluid          ->  |      3  march the coupled equations
///   (fluid_structure.hpp, |                  |b|                      |         mesh_motion.hpp,
///   time_integration.hpp)
///   +------------------+-+----------------------+      4  measure and record (measurements.hpp)
///                                                      5  say how good the answer is
///                                                      (convergence.hpp)

#include "reference_fem/convergence.hpp"
#include "scene/command_line.hpp"

#include <fmt/format.h>

namespace {

using namespace sprung;

struct Arguments {
  std::string scene;
  std::vector<std::string> overrides;
  reference::RunOptions options;
  bool converge = false;
};

void declare(CLI::App& app, Arguments& a) {
  app.add_option("scene", a.scene, "scene file (TOML)")->required();
  app.add_option("overrides", a.overrides, "table.key=value, checked like the file");
  app.add_option("--out", a.options.out, "folder of the record")->required();
  app.add_option("--threads", a.options.threads,
                 "threads for assembly; the bits do not depend on it")
      ->check(CLI::Range(1, 256));
  app.add_flag("--resume", a.options.resume, "continue from the last checkpoint, if there is one");
  app.add_flag("--overwrite", a.options.overwrite, "replace a record that stands in --out");
  app.add_flag(
      "--converge", a.converge,
      "also run coarser and finer meshes and steps, and write the reference's own error bar");
  app.add_option("--until", a.options.until, "pause at the first checkpoint from this time (s) on");
}

int work(const Arguments& a) {
  if (a.converge) {
    reference::run_convergence(a.scene, a.overrides, a.options);
    return 0;
  }
  Document document(a.scene, a.overrides);
  const Problem problem = read_problem(document);
  const reference::Settings settings = reference::read_settings(document, problem);
  document.refuse_unread();
  reference::run(document, problem, settings, a.options);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Finite element reference: monolithic fluid-structure interaction on a moving mesh "
      "(deal.II)\n\n"
      "Examples:\n"
      "  sprung-reference beam.toml --out results/reference\n"
      "  sprung-reference beam.toml reference_fem.cell_size=\"40 mm\" --out results/coarse\n"
      "  sprung-reference beam.toml --out results/reference --converge\n"
      "  sprung-reference beam.toml --out results/reference --resume\n\n"
      "Exit codes: 0 finished; 1 the scene or a file is not usable; 2 the command line is not "
      "understood;\n3 the run stopped itself, its record whole up to there; 128 + number: a signal "
      "stopped it, "
      "--resume\ncontinues."};
  Arguments a;
  declare(app, a);
  return run_program(app, argc, argv, [&] {
    try {
      return work(a);
    } catch (const reference::RunStopped& error) {
      fmt::print(stderr, "error: {}\n", error.what());
      return 3;
    } catch (const reference::RunInterrupted& interrupted) {
      fmt::print(stderr, "{}\n", interrupted.what());
      return 128 + interrupted.signal();
    }
  });
}
