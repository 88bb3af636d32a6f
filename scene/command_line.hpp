#pragma once
/// What every program's main() does with its command line and with what goes wrong.

#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

namespace sprung {

/// A word that is a number and no finite one ("nan", "--stress=inf"), or "". Ranges do not see it:
/// a comparison with nan is false.
inline std::string no_finite_number(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    const bool option = word.starts_with("--");
    const std::string value =
        option && word.find('=') != word.npos ? word.substr(word.find('=') + 1) : word;
    char* end = nullptr;
    const double number = std::strtod(value.c_str(), &end);
    if (!value.empty() && *end == '\0' && !std::isfinite(number)) return word;
  }
  return "";
}

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
  if (const std::string word = no_finite_number(argc, argv); !word.empty()) {
    std::fprintf(stderr, "%s: not a finite number\n", word.c_str());
    return 2;
  }
  try {
    return work();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}

}  // namespace sprung
