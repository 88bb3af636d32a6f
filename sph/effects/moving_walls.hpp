#pragma once
/// Flat walls that move in their own plane. Their mirror particles carry the wall's velocity.

#include "scene/problem.hpp"
#include "sph/effects/roles.hpp"

namespace sprung::sph {

template <int dim>
class MovingWalls final : public TimeDependence<dim> {
 public:
  /// `motions`: each names a wall that `images` has.
  MovingWalls(const std::vector<WallMotion>& motions, const Images<dim>& images);
  void set(State<dim>& state) override;

 private:
  struct Motion {
    std::size_t wall;
    Vector<dim> velocity;
    Waveform waveform;
  };
  std::vector<Motion> motions_;
};

}  // namespace sprung::sph
