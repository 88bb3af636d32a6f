/// sprung-calibrate: measures lambda = E/k_e of the spring lattices by tests that run through sph/.

#include <CLI/CLI.hpp>

#include <cstdio>

int main(int argc, char** argv) {
  CLI::App app{"Calibration of the spring lattices"};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  std::fputs("error: no test is written yet\n", stderr);
  return 1;
}
