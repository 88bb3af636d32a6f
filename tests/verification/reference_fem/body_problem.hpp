#pragma once
/// A scene that is one body and nothing else: the channel is its box.

#include "reference_fem/mesh.hpp"
#include "reference_fem/static_solution.hpp"
#include "scene/problem.hpp"

#include <memory>

namespace sprung::reference::testing {

inline Problem body_problem(double width, double height, double youngs_modulus) {
  Problem problem;
  problem.channel = {{0, 0, 0}, {width, height, 0}};
  problem.density = 1000.0;
  Solid solid;
  solid.name = "body";
  solid.body = problem.channel;
  solid.youngs_modulus = youngs_modulus;
  problem.solids = {solid};
  return problem;
}

inline MeshSizes sizes_of(double bulk, double corner, double face, int splittings) {
  return {bulk, corner, corner, face, 2.0, splittings};
}

/// Mesh, space and equations of a body.
struct Body {
  Body(const Problem& problem, const MeshSizes& sizes, const Material& material, int degree = 2) {
    make_mesh(problem, sizes, mesh);
    space = std::make_unique<Space>(mesh, degree);
    system = std::make_unique<FluidStructure>(*space, problem, std::vector<Material>{material});
  }
  Vec2 displacement_at(const Fields& fields, const Vec2& point) const {
    const std::vector<double> rest(fields.displacement.size(), 0.0);
    return evaluate(*space, fields.displacement, Locator(*space, rest).find(point));
  }
  dealii::Triangulation<2> mesh;
  std::unique_ptr<Space> space;
  std::unique_ptr<FluidStructure> system;
};

}  // namespace sprung::reference::testing
