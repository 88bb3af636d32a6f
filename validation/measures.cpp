#include "validation/measures.hpp"

#include <array>
#include <stdexcept>

namespace sprung {

namespace {

constexpr std::array<Measure, 24> all_measures{{
    {"velocity_difference", "1", true,
     "largest difference of the x component of velocity along the probe's line, over the peak "
     "inlet "
     "speed at full flow"},
    {"velocity_difference_rms", "1", true,
     "root mean square of the same difference over the line's points, over the peak inlet speed"},
    {"velocity_difference_transverse", "1", true,
     "largest difference of the y component of velocity along the line, over the peak inlet speed"},
    {"displacement_difference", "1", true,
     "length of the difference of the two displacement vectors over the length of the reference's, "
     "at that time"},
    {"displacement_difference_x", "1", true,
     "x component of that difference, signed, over the length of the reference's displacement"},
    {"displacement_difference_y", "1", true,
     "y component of that difference, signed, over the length of the reference's displacement"},
    {"displacement_l2", "1", true,
     "relative L2 norm of the difference of the displacement histories, both components, over the "
     "common time"},
    {"displacement_lag", "s", true,
     "lag of the displacement along its larger component: the shift that maximises the correlation "
     "with the reference, between the samples too; positive: late"},
    {"displacement_amplitude_ratio", "1", true,
     "least-squares factor between the two histories once the lag is taken out"},
    {"outline_distance", "m", true,
     "largest distance between the two outlines as curves (from the points of either to the "
     "other)"},
    {"outline_distance_rms", "m", true, "root mean square of the same distances over all points"},
    {"outline_distance_relative", "1", true,
     "largest distance between the outlines over the reference's largest displacement at that "
     "time"},
    {"outline_distance_material", "m", true,
     "largest distance between the same material points of the two outlines"},
    {"force_difference_x", "1", true,
     "difference of the x component of the force on the body, each averaged over the window, "
     "signed, "
     "over the length of the reference's mean force"},
    {"force_difference_y", "1", true, "the same for the y component"},
    {"force_scatter", "N/m", false,
     "standard deviation of the x component of the force within the window: how noisy it is"},
    {"excess_outflow", "1", false,
     "largest amount, over the run, of the time integral of outflow minus inflow, over the area of "
     "the channel"},
    {"particle_drift", "1", false,
     "largest change of the number of particles over the run, over the number at the start"},
    {"lost_particles", "1", false,
     "particles that the run itself counts as lost (gone through no outlet), plus any that its "
     "books "
     "(start + created - removed - end) do not account for"},
    {"divergence_rms", "1/s", false,
     "root mean square of the remaining divergence of velocity, averaged over the run"},
    {"solid_area_change", "1", false, "largest relative change of the solids' area over the run"},
    {"solid_max_stretch", "1", false, "largest stretch in a solid over the run"},
    {"processor_time", "s", false, "processor time of the run, all threads"},
    {"wall_time", "s", false, "wall time of the run"},
}};

}  // namespace

std::span<const Measure> measures() {
  return all_measures;
}

const Measure& measure(const std::string& name) {
  std::string known;
  for (const Measure& entry : all_measures) {
    if (name == entry.name) return entry;
    known += std::string(known.empty() ? "" : ", ") + entry.name;
  }
  throw std::invalid_argument("there is no measure '" + name + "'; there are: " + known);
}

}  // namespace sprung
