/// sprung-step-cost: what a time step costs in space, against what this machine can do.
///
/// A decaying Taylor-Green flow in a periodic cube is stepped; the median time of each ACTION
/// stands beside the least number of bytes that it must move, at the bandwidth that a STREAM triad
/// reaches in the same process.

#include "scene/command_line.hpp"
#include "scene/manifest.hpp"
#include "scene/progress.hpp"
#include "sph/scene_setup.hpp"
#include "sph/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <omp.h>

namespace {

using namespace sprung;

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

/// Bytes per second of a[i] = b[i] + s c[i] (McCalpin's STREAM), best of ten; arrays well beyond
/// every cache.
double stream_bandwidth() {
  constexpr std::size_t n = 1 << 24;
  std::vector<double> a(n), b(n), c(n);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) a[i] = 0.0, b[i] = 1.0, c[i] = 2.0;
  double best = 1e300;
  for (int repeat = 0; repeat < 10; ++repeat) {
    const double began = wall_seconds();
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
    best = std::min(best, wall_seconds() - began);
  }
  if (a[n / 2] != 7.0) throw std::logic_error("triad");
  return 3.0 * sizeof(double) * n / best;
}

/// Bytes that each ACTION must move per particle, every array once: `pairs` neighbours a particle,
/// 12 bytes each (index and gradient factor); vectors 24, scalars 8. What is gathered through an
/// index counts once per particle, as if the cache never missed.
std::array<double, sph::action_count> least_bytes(double pairs, double iterations) {
  const double list = 12.0 * pairs, vector = 24.0, scalar = 8.0, matrix = 72.0;
  std::array<double, sph::action_count> bytes{};
  auto at = [&](sph::Action action) -> double& { return bytes[std::size_t(action)]; };
  at(sph::Action::body_forces) = vector;
  // Viscosity: list, velocity, factor; its own term and the last one; u*.
  at(sph::Action::predictor) = list + 6 * vector + scalar;
  // Divergence: list, places, velocity, correction. Diagonal: factors. Cells: list.
  at(sph::Action::pressure_assembly) = list + 2 * vector + matrix + 8.0 * pairs + list + 6 * scalar;
  // An iteration reads the list once for the product, half of it for each part of the forward
  // sweep, once for the backward sweep, and ten vectors.
  at(sph::Action::pressure_solve) = (3.0 * list + 10 * scalar) * iterations + list + 4 * scalar;
  at(sph::Action::corrector) = list + 5 * vector + matrix + scalar;
  // Shifting: list, places, velocity, correction.
  at(sph::Action::motion) = list + 6 * vector + matrix;
  // Search: places in and sorted, lists out; correction: list, places.
  at(sph::Action::support) = list + 5 * vector + list + vector + matrix;
  return bytes;
}

std::string cube(int n, double tolerance) {
  return fmt::format(R"scene(title = "Taylor-Green flow in a cube"
[domain]
channel = {{ from = ["0 m", "0 m", "0 m"], to = ["1 m", "1 m", "1 m"] }}
[time]
end = "100 s"
[fluid]
density = "1 kg/m3"
[viscosity]
dynamic = "0.01 Pa s"
[periodic]
axes = ["x", "y", "z"]
[initial]
velocity = ["cos(2*pi*x)*sin(2*pi*y)*cos(2*pi*z)", "-sin(2*pi*x)*cos(2*pi*y)*cos(2*pi*z)", "0"]
[sph]
spacing = "{:.17g} m"
[numerics]
pressure_tolerance = {}
)scene",
                     1.0 / n, tolerance);
}

void measure(int n, int steps, double tolerance, const std::string& table_file) {
  Document document = Document::from_text(cube(n, tolerance));
  const sph::ModulusTable table(table_file);
  auto scene = sph::set_up<3>(document, table);
  auto& simulation = *scene.simulation;
  constexpr int warm_up = 3;
  std::array<std::vector<double>, sph::action_count> seconds;
  std::vector<double> whole, iterations;
  for (int k = 0; k < warm_up + steps; ++k) {
    const auto before = simulation.seconds();
    const double began = wall_seconds();
    sph::advance(simulation);
    if (k < warm_up) continue;
    whole.push_back(wall_seconds() - began);
    iterations.push_back(simulation.pressure_report().iterations);
    for (std::size_t a = 0; a < sph::action_count; ++a)
      seconds[a].push_back(simulation.seconds()[a] - before[a]);
  }
  const auto& state = simulation.state();
  const auto particles = static_cast<double>(state.particles.unknowns);
  const double pairs = static_cast<double>(state.support.pairs()) / particles;
  const auto bytes = least_bytes(pairs, median(iterations));
  double least = 0.0;
  for (const double b : bytes) least += b;
  const double memory = peak_memory_bytes();  // before the triad's arrays
  const double bandwidth = stream_bandwidth();
  fmt::print(
      "particles {:.0f}, threads {}, neighbours {:.1f}, iterations {:.0f}, triad {:.2f} GB/s\n",
      particles, omp_get_max_threads(), pairs, median(iterations), 1e-9 * bandwidth);
  fmt::print("{:<32} {:>10} {:>12} {:>8}\n", "", "ms", "bytes/part.", "ratio");
  const auto line = [&](const std::string& name, double time, double b) {
    fmt::print("{:<32} {:>10.1f} {:>12.0f} {:>8.2f}\n", name, 1e3 * time, b,
               b > 0.0 ? time * bandwidth / (b * particles) : 0.0);
  };
  for (std::size_t a = 0; a < sph::action_count; ++a)
    if (bytes[a] > 0.0) line(to_string(sph::Action(a)), median(seconds[a]), bytes[a]);
  line("step", median(whole), least);
  fmt::print(
      "step {:.3f} us/particle, fastest {:.1f} ms, slowest {:.1f} ms, peak memory {:.0f} "
      "bytes/particle\n",
      1e6 * median(whole) / particles, 1e3 * *std::min_element(whole.begin(), whole.end()),
      1e3 * *std::max_element(whole.begin(), whole.end()), memory / particles);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Cost of a time step in space against the least memory traffic\n\n"
      "Examples:\n"
      "  sprung-step-cost --side 48\n"
      "  sprung-step-cost --side 84 --threads 2 --steps 20"};
  int side = 48, steps = 20, threads = 1;
  double tolerance = 1e-3;
  std::string table = SPRUNG_MODULUS_TABLE;
  app.add_option("--side", side, "particles along an edge of the cube (48: 110,592; 84: 592,704)")
      ->check(CLI::Range(8, 400));
  app.add_option("--steps", steps, "steps that are timed")->check(CLI::Range(1, 10000));
  app.add_option("--threads", threads, "threads")->check(CLI::Range(1, 256));
  app.add_option("--tolerance", tolerance, "of the pressure solver")->check(CLI::Range(1e-12, 0.5));
  app.add_option("--calibration", table, "table of lambda = E/k_e");
  return run_program(app, argc, argv, [&] {
    omp_set_num_threads(threads);
    measure(side, steps, tolerance, table);
    return 0;
  });
}
