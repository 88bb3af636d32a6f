#pragma once
/// Distance between two outlines of one body: between the curves, and between material points.

#include <array>
#include <span>

namespace sprung {

using PlanePoint = std::array<double, 2>;

struct OutlineDistance {
  double largest = 0.0;           ///< m, between the curves (Hausdorff distance of the vertices)
  double rms = 0.0;               ///< m, over the vertices of both
  double largest_material = 0.0;  ///< m, between the same material points
  double rms_material = 0.0;      ///< m
};

/// Distance (m) of `point` from the open polygon through `curve` (two points or more).
double distance_to_curve(const PlanePoint& point, std::span<const PlanePoint> curve);

/// Compares two outlines given by as many material points each. The distance between curves does
/// not see material sliding along the outline, that between material points does. Throws
/// std::invalid_argument if the numbers of points differ or are below two.
OutlineDistance outline_distance(std::span<const PlanePoint> reference,
                                 std::span<const PlanePoint> candidate);

}  // namespace sprung
