#pragma once
/// From a scene file to a simulation: lattice, solid particles (ACTIONs 1 and 2), boundaries,
/// effects.

#include "scene/problem.hpp"
#include "sph/effects/elastic_solid.hpp"
#include "sph/simulation.hpp"
#include "sph/wall_force.hpp"

#include <filesystem>
#include <map>

namespace sprung::sph {

/// lambda = E/k_e by dimension, lattice and area stiffness, as calibrated by this code.
class ModulusTable {
 public:
  /// Throws std::runtime_error naming the file and the command that makes it, if it is missing.
  explicit ModulusTable(std::filesystem::path file);
  /// Throws std::runtime_error that states the range when there is no row for the request.
  double modulus_per_stiffness(int dimension, Bonds bonds, double area_stiffness) const;

 private:
  struct Row {
    int dimension;
    std::string bonds;
    double area_stiffness;
    double modulus_per_stiffness;
  };
  std::filesystem::path file_;
  std::vector<Row> rows_;
};

struct BodyRange {
  std::string name;
  std::size_t first, last;  ///< particles of this body
};

/// A scene as the particle method sees it.
template <int dim>
struct ParticleScene {
  Problem problem;
  std::unique_ptr<Simulation<dim>> simulation;
  ElasticSolid<dim>* solid = nullptr;  ///< null where the scene has none; owned by the simulation
  std::vector<BodyRange> bodies;
  std::map<std::string, WallForce<dim>> wall_forces;  ///< by curved wall, where a probe asks for it
  bool retreat = false;  ///< a fault sends the run back to a good checkpoint, with half the step
  std::vector<std::string> warnings;
  std::vector<std::string> effects;      ///< what the scene calls for, one line each
  std::vector<std::string> effects_off;  ///< what it does not
};

/// Reads [sph] and [numerics] and everything else that the particle solver needs, and refuses what
/// is left unread. Throws SceneError.
template <int dim>
ParticleScene<dim> set_up(Document& document, const ModulusTable& table);

}  // namespace sprung::sph
