#pragma once
/// How far a spring may be strained before lambda = E/k_e, the table's, says less than it seems to.

#include <cstdint>
#include <string>

namespace sprung::sph {

/// The strain to which a body pulled along an axis carries the stress of an incompressible
/// neo-Hookean solid of the same E within about 1 %: 1 % in space, where springs stiffen to first
/// order (0.84 per unit of strain), 5 % in the plane (to second). calibration/stress_strain.csv
/// holds what they carry beyond. Of the bulk: parts of few layers differ by more.
constexpr double calibrated_strain(int dimension) {
  return dimension == 2 ? 0.05 : 0.01;
}

/// How far the springs of a run have been strained, and whether that is within the calibration.
struct SpringStrain {
  double largest = 0.0;        ///< |length/rest length - 1| of any spring at any step
  double time = 0.0;           ///< s, of the largest
  std::int64_t particle = -1;  ///< identity of one of its two ends; -1: at a clamp or none
  double share = 0.0;  ///< of all springs beyond calibrated_strain, at the step with most of them

  bool within(int dimension) const { return largest <= calibrated_strain(dimension); }
  /// A sentence for stderr and the record.
  std::string told(int dimension) const;
};

}  // namespace sprung::sph
