#pragma once
/// What a scene asks to be measured, taken from the particles.

#include "scene/problem.hpp"
#include "scene/record.hpp"
#include "sph/effects/elastic_solid.hpp"

namespace sprung::sph {

/// Moving least squares with complete quadratics: exact for a velocity that is quadratic in space,
/// where a plain kernel average of a parabola would be off by its curvature. Weights: the kernel
/// at 1.25 times the support; images count as particles, so walls act. Falls back to lower order
/// where neighbours are few.
template <int dim>
std::vector<Vector<dim>> velocity_at(const State<dim>& state,
                                     const std::vector<Vector<dim>>& places);

/// Pressure (Pa) by the same least squares; images included (dp/dn = 0 at walls). A
/// single step's pressure is noisy; its mean over time is what a comparison may use.
template <int dim>
std::vector<double> pressure_at(const State<dim>& state, const std::vector<Vector<dim>>& places);

/// Displacement of material points of the solid: the linear least-squares fit of the displacements
/// of the solid particles that lay within 2.1 dx of the point at rest (farther at a corner, until
/// there are twice as many as the fit has terms). `first`, `last`: the body's particles.
template <int dim>
std::vector<Vector<dim>> displacement_of(const ElasticSolid<dim>& solid,
                                         const Particles<dim>& particles, std::size_t first,
                                         std::size_t last, const std::vector<Vector<dim>>& points);

}  // namespace sprung::sph
