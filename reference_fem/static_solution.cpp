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

StaticSolution solve_static(FluidStructure& system, const std::vector<double>& load, int increments,
                            double tolerance) {
  constexpr int max_iterations = 40;
  constexpr StageWeights weights{1.0, 0.0};
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
    for (int iteration = 0;; ++iteration) {
      if (iteration == max_iterations)
        throw std::runtime_error("the static solution did not converge; use more load increments");
      system.linearize(f, weights);
      system.residual(f, weights, residual);
      system.correct(residual, step, pressure_step);
      for (std::size_t i = 0; i < n; ++i) f.velocity[i] += step[i];
      for (std::size_t i = 0; i < f.pressure.size(); ++i) f.pressure[i] += pressure_step[i];
      f.mesh_velocity = f.displacement = f.velocity;
      ++solution.iterations;
      solution.last_change = largest(step) + 0.0 * largest(pressure_step);
      if (!std::isfinite(solution.last_change))
        throw std::runtime_error("the static solution met a value that is not finite");
      if (solution.last_change <= tolerance * largest(f.displacement)) break;
    }
  }
  return solution;
}

}  // namespace sprung::reference
