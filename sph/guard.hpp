#pragma once
/// Watches a run: when a value leaves its sound range the run stops and says what, where, when and
/// what to change. Each step costs one pass over the particles and one over the springs, every
/// tenth step two more over the pairs; the record's cost table shows it as "guard".

#include "sph/effects/calibrated_strain.hpp"
#include "sph/scene_setup.hpp"

#include <optional>
#include <string>

namespace sprung::sph {

/// What is sound. A speed is compared with the scene's velocity scale (the fastest flow expected),
/// a length with the particle spacing.
struct SoundRange {
  double speed = 10.0;      ///< of any particle / scale: such a step carries it past its neighbours
  double rms_speed = 2.0;   ///< all kinetic energy: four times what the fastest flow could hold
  double divergence = 0.5;  ///< rms x spacing / scale: the volume of half a particle per passage
  double closest = 0.2;     ///< distance / spacing below which two particles have clumped
  double emptiest = 0.2;    ///< of a full support, below which a particle stands in a void
  double crowd = 0.01;      ///< part of the fluid that may clump, stand in a void, or be lost
  double few = 4.0;         ///< and as many particles may clump or stand in a void anyway
  double least_stretch = 0.5, most_stretch = 2.0;      ///< of a spring
  double least_volume = 0.9, most_volume = 1.0 / 0.9;  ///< of all bodies over that at rest
};

template <int dim>
class Guard {
 public:
  explicit Guard(const ParticleScene<dim>& scene) : scene_(scene) {}
  /// A message when the state is not sound. Called once after each step.
  std::optional<std::string> find_fault();
  /// Over all steps looked at, those before a checkpoint included.
  const SpringStrain& spring_strain() const { return strain_; }

  void save(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  std::optional<std::string> motion_fault() const;
  std::optional<std::string> spring_fault();
  std::optional<std::string> crowd_fault() const;
  std::optional<std::string> volume_fault();
  std::string where(std::size_t i) const;
  std::string when() const;

  const ParticleScene<dim>& scene_;
  SoundRange range_;
  SpringStrain strain_;
};

}  // namespace sprung::sph
