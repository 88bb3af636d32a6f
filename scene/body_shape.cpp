#include "scene/body_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sprung {

namespace {

double middle_radius(const Arc& arc) {
  return 0.5 * (arc.inner_radius + arc.outer_radius);
}

/// `offset` turned by `angle` in the x-y plane.
Point turned(const Point& offset, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * offset[0] - s * offset[1], s * offset[0] + c * offset[1], offset[2]};
}

Point middle(const Box& box) {
  Point point{};
  for (int d = 0; d < 3; ++d) point[d] = 0.5 * (box.from[d] + box.to[d]);
  return point;
}

}  // namespace

Point own_extent(const Solid& solid) {
  if (solid.arc)
    return {solid.arc->outer_radius - solid.arc->inner_radius,
            middle_radius(*solid.arc) * (solid.arc->to_angle - solid.arc->from_angle),
            solid.body.to[2] - solid.body.from[2]};
  Point extent{};
  for (int d = 0; d < 3; ++d) extent[d] = solid.body.to[d] - solid.body.from[d];
  return extent;
}

Point from_own(const Solid& solid, const Point& own) {
  if (solid.arc) {
    const Arc& arc = *solid.arc;
    const double r = arc.inner_radius + own[0];
    const double angle = arc.from_angle + own[1] / middle_radius(arc);
    return {arc.centre[0] + r * std::cos(angle), arc.centre[1] + r * std::sin(angle),
            solid.body.from[2] + own[2]};
  }
  Point place{};
  for (int d = 0; d < 3; ++d) place[d] = solid.body.from[d] + own[d];
  if (solid.angle == 0.0) return place;
  const Point centre = middle(solid.body);
  for (int d = 0; d < 3; ++d) place[d] -= centre[d];
  place = turned(place, solid.angle);
  for (int d = 0; d < 3; ++d) place[d] += centre[d];
  return place;
}

Point to_own(const Solid& solid, const Point& place) {
  if (solid.arc) {
    const Arc& arc = *solid.arc;
    const double x = place[0] - arc.centre[0], y = place[1] - arc.centre[1];
    // The angle nearest to the arc's middle, so that the cut of atan2 lies opposite to it.
    const double aim = 0.5 * (arc.from_angle + arc.to_angle);
    const double off = std::remainder(std::atan2(y, x) - aim, 2.0 * std::numbers::pi);
    return {std::hypot(x, y) - arc.inner_radius, middle_radius(arc) * (aim + off - arc.from_angle),
            place[2] - solid.body.from[2]};
  }
  Point own = place;
  if (solid.angle != 0.0) {
    const Point centre = middle(solid.body);
    for (int d = 0; d < 3; ++d) own[d] -= centre[d];
    own = turned(own, -solid.angle);
    for (int d = 0; d < 3; ++d) own[d] += centre[d];
  }
  for (int d = 0; d < 3; ++d) own[d] -= solid.body.from[d];
  return own;
}

double own_stretch(const Solid& solid, const Point& own) {
  return solid.arc ? (solid.arc->inner_radius + own[0]) / middle_radius(*solid.arc) : 1.0;
}

Point own_direction(const Solid& solid, const Point& own, int axis) {
  Point direction{};
  direction[axis] = 1.0;
  const double angle =
      solid.arc ? solid.arc->from_angle + own[1] / middle_radius(*solid.arc) : solid.angle;
  return angle == 0.0 ? direction : turned(direction, angle);
}

bool is_oblique(const Solid& solid) {
  return solid.arc.has_value() || solid.angle != 0.0;
}

bool body_contains(const Solid& solid, const Point& place, double tolerance) {
  const Point own = to_own(solid, place), extent = own_extent(solid);
  for (int d = 0; d < 3; ++d) {
    if (extent[d] == 0.0) continue;  // a plane body has no third extent
    if (own[d] < -tolerance || own[d] > extent[d] + tolerance) return false;
  }
  return true;
}

Box bounding_box(const Solid& solid, int dimension) {
  if (!is_oblique(solid)) return solid.body;
  const Point extent = own_extent(solid);
  Box box{from_own(solid, {}), from_own(solid, {})};
  // A straight side's extremes are its ends; of an arc's side they are sampled every tenth of a
  // degree or less: off by less than 4e-7 of the radius.
  const int along = solid.arc ? 3600 : 1;
  for (int j = 0; j <= along; ++j)
    for (const double u : {0.0, extent[0]})
      for (const double w : {0.0, extent[2]}) {
        const Point at = from_own(solid, {u, extent[1] * j / along, w});
        for (int d = 0; d < dimension; ++d) {
          box.from[d] = std::min(box.from[d], at[d]);
          box.to[d] = std::max(box.to[d], at[d]);
        }
      }
  return box;
}

}  // namespace sprung
