#pragma once
/// What every program's main() does with its command line and with what goes wrong.

#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>

namespace sprung {

/// Reads the command line, then calls `work`, whose int is the exit code. 0 for --help; 2 for a
/// command line that is not understood; 1, with the reason on standard error, for what `work`
/// throws.
template <typename Work>
int run_program(CLI::App& app, int argc, char** argv, Work&& work) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return work();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}

}  // namespace sprung
