#include "sph/effects/moving_walls.hpp"

namespace sprung::sph {

template <int dim>
MovingWalls<dim>::MovingWalls(const std::vector<WallMotion>& motions, const Images<dim>& images) {
  for (const auto& motion : motions) {
    const int axis = static_cast<int>(motion.side) / 2;
    const int inward = static_cast<int>(motion.side) % 2 == 0 ? 1 : -1;
    for (std::size_t w = 0; w < images.walls().size(); ++w)
      if (images.walls()[w].axis == axis && images.walls()[w].inward == inward)
        motions_.push_back({w, as_vector<dim>(motion.velocity), motion.waveform});
  }
}

template <int dim>
void MovingWalls<dim>::set(State<dim>& state) {
  for (const auto& motion : motions_)
    state.images.set_wall_velocity(motion.wall,
                                   motion.waveform.value(state.clock.time) * motion.velocity);
}

template class MovingWalls<2>;
template class MovingWalls<3>;

}  // namespace sprung::sph
