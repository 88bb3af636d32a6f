#include "reference_fem/static_solution.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace sprung::reference {

std::vector<double> traction_load(const Space& space, Side side, const Vec2& traction) {
  std::vector<double> load(2 * static_cast<std::size_t>(space.nodes()), 0.0);
  const auto na = static_cast<std::size_t>(space.nodes_per_cell());
  for (const BoundaryFace& face : space.boundary()) {
    if (face.boundary != static_cast<unsigned>(side)) continue;
    for (std::size_t q = 0; q < face.normal_weight.size(); ++q) {
      const double ds = std::hypot(face.normal_weight[q][0], face.normal_weight[q][1]);
      for (std::size_t a = 0; a < na; ++a)
        for (std::size_t d = 0; d < 2; ++d)
          load[2 * static_cast<std::size_t>(space.cell_nodes(face.cell)[a]) + d] +=
              traction[d] * face.value[q * na + a] * ds;
    }
  }
  return load;
}

namespace {

constexpr StageWeights static_weights{1.0, 0.0};
/// Below this part of an increment's first residual round-off decides whether it still falls.
constexpr double round_off = 1e-8;

/// Size of what is left of equilibrium and of the volume constraint, the latter as the force that
/// the shear modulus would set against it on one cell.
double merit_of(const FluidStructure& system, const Residual& residual) {
  const Space& space = system.space();
  double sum = 0.0;
  for (int n = 0; n < space.nodes(); ++n)
    for (int d = 0; d < 2; ++d)
      if (system.unknown(n, d) >= 0) {
        const double r =
            residual.momentum[2 * static_cast<std::size_t>(n) + static_cast<std::size_t>(d)];
        sum += r * r;
      }
  const int np = space.pressures_per_cell();
  for (int c = 0; c < space.cells(); ++c) {
    double area = 0.0, volume = 0.0;
    for (int q = 0; q < space.points_per_cell(); ++q) area += space.weight(c)[q];
    for (int m = 0; m < np; ++m) {
      const double r = residual.continuity[static_cast<std::size_t>(c * np + m)];
      volume += r * r;
    }
    const double g =
        space.body(c) == 0 ? system.viscosity() : system.material(space.body(c)).shear_modulus;
    sum += volume * g * g / area;
  }
  return std::sqrt(sum);
}

Fields moved(const Fields& from, double length, const std::vector<double>& step,
             const std::vector<double>& pressure_step) {
  Fields to = from;
  for (std::size_t i = 0; i < step.size(); ++i) to.velocity[i] += length * step[i];
  for (std::size_t i = 0; i < pressure_step.size(); ++i)
    to.pressure[i] += length * pressure_step[i];
  to.mesh_velocity = to.displacement = to.velocity;
  return to;
}

/// Line search: the correction is halved until the residual falls and no cell is inside out.
/// `first`: the increment's first residual, below a small part of which the whole step is taken.
void search(const FluidStructure& system, const std::vector<double>& step,
            const std::vector<double>& pressure_step, double first, Fields& fields,
            Residual& residual) {
  constexpr int halvings = 10;
  const double merit = merit_of(system, residual);
  std::string last = "the residual does not fall";
  double length = 1.0;
  for (int k = 0; k < halvings; ++k, length *= 0.5) {
    Fields tried = moved(fields, length, step, pressure_step);
    try {
      system.residual(tried, static_weights, residual);
    } catch (const InvertedCell& error) {
      last = error.what();
      continue;
    }
    const double now = merit_of(system, residual);
    if (now < (1.0 - 0.1 * length) * merit || merit <= round_off * first) {
      fields = std::move(tried);
      return;
    }
  }
  throw std::runtime_error("the static solution did not converge (" + last +
                           "); use more load increments");
}

}  // namespace

StaticSolution solve_static(FluidStructure& system, const std::vector<double>& load, int increments,
                            double tolerance) {
  constexpr int max_iterations = 40;
  const auto n = 2 * static_cast<std::size_t>(system.space().nodes());
  StaticSolution solution;
  Fields& f = solution.fields;
  f = {std::vector<double>(n),
       std::vector<double>(static_cast<std::size_t>(system.pressure_unknowns())),
       std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  Residual residual;
  std::vector<double> step, pressure_step;
  for (int increment = 1; increment <= increments; ++increment) {
    std::vector<double> part = load;
    for (double& x : part) x *= static_cast<double>(increment) / increments;
    system.set_load(std::move(part));
    system.residual(f, static_weights, residual);
    const double first = merit_of(system, residual);
    for (int iteration = 0;; ++iteration) {
      if (iteration == max_iterations)
        throw std::runtime_error("the static solution did not converge; use more load increments");
      system.linearize(f, static_weights);
      system.correct(residual, step, pressure_step);
      ++solution.iterations;
      solution.last_change = largest(step) + 0.0 * largest(pressure_step);
      if (!std::isfinite(solution.last_change))
        throw std::runtime_error("the static solution met a value that is not finite");
      search(system, step, pressure_step, first, f, residual);
      if (solution.last_change <= tolerance * largest(f.displacement)) break;
    }
  }
  return solution;
}

}  // namespace sprung::reference
