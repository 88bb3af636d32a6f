#include "sph/time_step.hpp"

#include "sph/simulation.hpp"

namespace sprung::sph {

template <int dim>
void advance(Simulation<dim>& simulation) {
  simulation.choose_time_step();
  simulation.add_body_forces();             // ACTION 4, Eq. 5
  simulation.predict_velocity();            // ACTION 5, Eq. 2
  simulation.solve_pressure();              // ACTION 6, Eq. 3
  simulation.correct_velocity();            // ACTION 7, Eq. 4
  simulation.move_particles();              // ACTION 8
  simulation.update_support_and_mirrors();  // ACTION 9 (and 3)
}

template void advance<2>(Simulation<2>&);
template void advance<3>(Simulation<3>&);

}  // namespace sprung::sph
