#include "scene/body_shape.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sprung {
namespace {

/// A point nearer to a corner than this part of the side is the corner.
constexpr double round_off = 1e-12;

}  // namespace

std::vector<Point> outline_points(const Solid& solid, int points) {
  if (is_oblique(solid)) {
    Solid own = solid;  // as a box in its own frame
    own.body = {{}, own_extent(solid)};
    own.angle = 0.0;
    own.arc.reset();
    auto outline = outline_points(own, points);
    for (Point& point : outline) point = from_own(solid, point);
    return outline;
  }
  const auto& [from, to] = solid.body;
  // Clockwise from the lower left corner; side i runs from corner i to corner i + 1.
  const std::array<Point, 4> corners{from, Point{from[0], to[1], from[2]}, to,
                                     Point{to[0], from[1], from[2]}};
  constexpr std::array clockwise{Side::left, Side::top, Side::right, Side::bottom};
  std::size_t first = 0;
  std::size_t sides = 4;
  if (solid.clamped) {
    const auto clamp = std::find(clockwise.begin(), clockwise.end(), *solid.clamped);
    if (clamp == clockwise.end())
      throw std::invalid_argument("outline of " + solid.name + ": outlines are for plane problems");
    first = static_cast<std::size_t>(clamp - clockwise.begin()) + 1;
    sides = 3;
  }
  if (points < 2) throw std::invalid_argument("outline of " + solid.name + ": at least two points");

  std::vector<double> reached{0.0};  // arc length at each corner
  const auto corner = [&](std::size_t i) { return corners[(first + i) % 4]; };
  for (std::size_t i = 0; i < sides; ++i)
    reached.push_back(reached.back() + std::abs(corner(i + 1)[0] - corner(i)[0]) +
                      std::abs(corner(i + 1)[1] - corner(i)[1]));
  const double total = reached.back();
  const int intervals = solid.clamped ? points - 1 : points;
  std::vector<Point> outline;
  for (int k = 0; k < points; ++k) {
    const double s = total * k / intervals;
    std::size_t i = 0;
    while (i + 1 < sides && s > reached[i + 1]) ++i;
    double part = (s - reached[i]) / (reached[i + 1] - reached[i]);
    if (std::abs(part) < round_off) part = 0.0;
    if (std::abs(1.0 - part) < round_off) part = 1.0;
    Point point = corner(i);
    for (int axis = 0; axis < 2; ++axis)
      point[axis] = part == 1.0 ? corner(i + 1)[axis]
                                : corner(i)[axis] + part * (corner(i + 1)[axis] - corner(i)[axis]);
    outline.push_back(point);
  }
  return outline;
}

}  // namespace sprung
