#pragma once
/// A body in a frame of its own, in which it is a box: aligned with the axes, turned, or bent to
/// an arc. Own coordinates are lengths (m) from the body's first corner along its own axes.

#include "scene/problem.hpp"

namespace sprung {

/// Extent of the body along its own axes, m. Of an arc: thickness, length of the middle line,
/// width.
Point own_extent(const Solid& solid);

/// Where the point of own coordinates `own` is at rest.
Point from_own(const Solid& solid, const Point& own);

/// Own coordinates of a place; the inverse of from_own.
Point to_own(const Solid& solid, const Point& place);

/// Volume at rest over volume in own coordinates, near `own`: 1, or of an arc r over the radius of
/// the middle line.
double own_stretch(const Solid& solid, const Point& own);

/// Unit vector along own axis `axis` at `own`.
Point own_direction(const Solid& solid, const Point& own, int axis);

/// Whether the body does not lie along the axes, so that a lattice along them would cut it in
/// steps.
bool is_oblique(const Solid& solid);

/// Whether `place` lies in the body or within `tolerance` (m) of it.
bool body_contains(const Solid& solid, const Point& place, double tolerance);

/// Smallest box along the axes that holds the body at rest.
Box bounding_box(const Solid& solid, int dimension);

}  // namespace sprung
