/// synthetic_records FOLDER: a reference and two runs made from formulas, as a comparison finds
/// them, for the tests of the report.

#include <cstdio>
#include <filesystem>

#include "synthetic_record.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: synthetic_records FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  using namespace sprung::synthetic;
  write_reference(folder / "reference", true);
  write_error_bar(folder / "reference", 0.002);
  Deviation close;
  close.lag = 0.004;
  close.amplitude = 1.02;
  close.velocity_offset = 0.01;
  close.force_noise = 3.0;
  write_run(folder / "runs" / "recommended", close, "recommended", true);
  Deviation soft;
  soft.lag = 0.02;
  soft.amplitude = 1.5;
  soft.velocity_offset = -0.04;
  soft.force_offset = 2.0;
  soft.force_noise = 8.0;
  soft.excess_outflow = 0.002;
  soft.stops_at = 0.9;
  soft.outcome = "stopped: made up";
  write_run(folder / "runs" / "paper", soft, "paper", true);
  return 0;
}
