/// A fluid's step and nothing else: six steps of decaying vortices, set up without the registry, so
/// that the linker takes in only what the step itself names. absence_test.py counts instructions.

#include "sph/effects/viscosity.hpp"
#include "sph/simulation.hpp"
#include "sph/time_step.hpp"

#include "tests/unit/sph/particle_blocks.hpp"

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <numbers>

namespace {

std::atomic<long> allocations{0};

}  // namespace

// Not inlined: the compiler would take new and free() for a pair that does not match.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* place = std::malloc(size)) return place;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* place) noexcept {
  std::free(place);
}
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept {
  std::free(place);
}

namespace sprung::sph {
namespace {

/// Sixteen by sixteen particles in a periodic square; the choices of `recommended` that are a
/// fluid's, written out: reading them would link the scene's reader.
Simulation<2> vortices() {
  constexpr int n = 16;
  constexpr double dx = 1.0 / n, tau = 2.0 * std::numbers::pi;
  Numerics numerics;
  numerics.smoothing_length_ratio = 1.3;
  numerics.normalised_gradient = true;
  numerics.gradient_correction = true;
  numerics.position_update = PositionUpdate::new_velocity;
  numerics.volume_along_step = true;
  numerics.density_feedback = 0.1;
  numerics.void_feedback = 2.0;
  numerics.pressure_tolerance = 1e-3;
  numerics.pressure_solver = PressureSolverKind::two_level;
  numerics.courant = 0.4;
  auto particles = test::particles_at<2>(test::lattice<2>({n, n}, dx), dx);
  Simulation<2> simulation(numerics, std::move(particles),
                           Images<2>({}, {{0, 0.0, 1.0}, {1, 0.0, 1.0}}));
  auto effect = std::make_unique<ViscosityEffect<2>>(0.01, simulation.state().particles, nullptr);
  simulation.effects().limits.push_back(effect.get());
  simulation.effects().diffusion.push_back(std::move(effect));
  simulation.start(1.0, 0.01);
  auto& p = simulation.state().particles;
  for (std::size_t i = 0; i < p.size(); ++i)
    p.velocity[i] = {std::sin(tau * p.position[i][0]) * std::cos(tau * p.position[i][1]),
                     -std::cos(tau * p.position[i][0]) * std::sin(tau * p.position[i][1])};
  return simulation;
}

/// What stands for the state's bits: a sum in which each double counts as an integer.
unsigned long long bits_of(const Particles<2>& particles) {
  unsigned long long sum = 0, word = 0;
  for (const auto* field : {&particles.position, &particles.velocity})
    for (const auto& value : *field)
      for (int d = 0; d < 2; ++d) {
        std::memcpy(&word, &value[d], sizeof word);
        sum = sum * 1099511628211ULL + word;
      }
  return sum;
}

}  // namespace
}  // namespace sprung::sph

int main() {
  auto simulation = sprung::sph::vortices();
  long before = 0;
  for (int step = 0; step < 6; ++step) {
    if (step == 3) before = allocations;  // the first steps find the sizes of their arrays
    advance(simulation);
  }
  std::printf("bits %llx\nallocations %ld\n", sprung::sph::bits_of(simulation.state().particles),
              allocations - before);
  return 0;
}
