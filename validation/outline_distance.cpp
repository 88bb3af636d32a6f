#include "validation/outline_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace sprung {

double distance_to_curve(const PlanePoint& point, std::span<const PlanePoint> curve) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < curve.size(); ++i) {
    const double ex = curve[i + 1][0] - curve[i][0], ey = curve[i + 1][1] - curve[i][1];
    const double px = point[0] - curve[i][0], py = point[1] - curve[i][1];
    const double square = ex * ex + ey * ey;
    const double s = square > 0.0 ? std::clamp((px * ex + py * ey) / square, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, std::hypot(px - s * ex, py - s * ey));
  }
  return nearest;
}

OutlineDistance outline_distance(std::span<const PlanePoint> reference,
                                 std::span<const PlanePoint> candidate) {
  if (reference.size() != candidate.size() || reference.size() < 2) {
    throw std::invalid_argument("two outlines are compared point by point: their numbers differ");
  }
  OutlineDistance result;
  double squares = 0.0, material_squares = 0.0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double there = distance_to_curve(candidate[i], reference);
    const double back = distance_to_curve(reference[i], candidate);
    const double material =
        std::hypot(candidate[i][0] - reference[i][0], candidate[i][1] - reference[i][1]);
    result.largest = std::max({result.largest, there, back});
    result.largest_material = std::max(result.largest_material, material);
    squares += there * there + back * back;
    material_squares += material * material;
  }
  const auto n = static_cast<double>(reference.size());
  result.rms = std::sqrt(squares / (2.0 * n));
  result.rms_material = std::sqrt(material_squares / n);
  return result;
}

}  // namespace sprung
