#pragma once
/// The arrays that every scene has. Data of one effect live in that effect.

#include "sph/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace sprung::sph {

enum class Role : std::uint8_t {
  solid,  ///< tied by springs
  fluid,
  inflow,   ///< of the prescribed columns outside an inflow side
  outflow,  ///< of the columns outside an outflow side, where the pressure is prescribed
};

/// An array of an effect that must follow the particles when they are reordered, created or
/// removed, and that a checkpoint must hold.
template <int dim>
struct CarriedArray {
  std::string name;
  std::vector<Vector<dim>>* values;
};

/// All particles have the same volume and mass. Order: solids (never reordered, so that springs can
/// name them by index), fluid, then the particles of inflow and outflow columns.
template <int dim>
struct Particles {
  double spacing = 0.0;  ///< m
  double volume = 0.0;   ///< spacing^dim
  double density = 0.0;  ///< kg/m3

  std::vector<Vector<dim>> position;            ///< m
  std::vector<Vector<dim>> velocity;            ///< m/s
  std::vector<Vector<dim>> predicted_velocity;  ///< u* of Eq. 2
  std::vector<double> pseudo_pressure;          ///< psi = -p/rho, m2/s2
  std::vector<Role> role;
  std::vector<std::int64_t> identity;  ///< number given at creation, never reused

  std::vector<CarriedArray<dim>> carried;
  std::int64_t next_identity = 0;

  std::size_t solids = 0;
  /// Solids and fluid: those with an equation of their own; the rest is prescribed.
  std::size_t unknowns = 0;

  std::size_t size() const { return position.size(); }
  double mass() const { return density * volume; }

  void add(const Vector<dim>& x, const Vector<dim>& u, double psi, Role r);
  /// Rearranges so that the new particle k is the old `order[k]`; old ones not named are dropped.
  void rearrange(const std::vector<std::int32_t>& order);
};

/// Speed of the fastest solid or fluid particle, m/s.
template <int dim>
double fastest(const Particles<dim>& particles) {
  double square = 0.0;
  for (std::size_t i = 0; i < particles.unknowns; ++i)
    square = std::max(square, particles.velocity[i].squaredNorm());
  return std::sqrt(square);
}

}  // namespace sprung::sph
