#pragma once
/// Inflow and outflow: columns of prescribed particles outside a side of the channel box.

#include "sph/boundary/open_plane.hpp"
#include "sph/particles.hpp"

namespace sprung::sph {

/// Why particles were created and removed.
struct ParticleBooks {
  std::int64_t entered = 0;   ///< became fluid at an inflow side
  std::int64_t left = 0;      ///< became part of a pressure column
  std::int64_t returned = 0;  ///< became fluid out of a pressure column
  std::int64_t upstream = 0;  ///< fluid that crossed an inflow side outwards, removed
  std::int64_t lost = 0;      ///< fluid found outside a wall by more than half a spacing, removed
  std::int64_t turned = 0;    ///< fluid that had crossed a wall within one step, mirrored back
};

/// Columns of particles that move with the prescribed velocity; one that crosses the side becomes
/// fluid and a new one enters the outermost column in its row.
template <int dim>
class InflowSide {
 public:
  InflowSide(const Inflow& inflow, const Box& channel, double spacing, double reach);
  void fill(Particles<dim>& particles) const;
  /// Prescribes u(t) on the columns.
  void prescribe(std::span<const Role> role, std::span<const Vector<dim>> position,
                 std::span<Vector<dim>> velocity, double time) const;
  /// Adds to the columns' predicted velocity what the fluid beside the side lacks of the prescribed
  /// one at `time` (kernel average at the mirrored place, along the normal). Of a jump between
  /// fluid and columns the divergence of the fluid holds one half; the columns, which have no
  /// equation, the other. With the plain velocity the flux follows the inflow a step late.
  void meet_at_plane(Particles<dim>& particles, double time, const Kernel<dim>& kernel) const;
  /// After the motion: roles change, particles are created. Order is restored by sort_by_role.
  void exchange(Particles<dim>& particles, double time, ParticleBooks& books) const;
  Vector<dim> velocity_at(const Vector<dim>& x, double time) const;
  /// Whether a fluid particle has drifted out against the inflow. One that has just entered may be
  /// shifted back over the side by a hair; it is carried in again.
  bool upstream(const Vector<dim>& x) const { return plane_.depth(x) > 0.5 * spacing_; }
  /// Volume flux that the rows carry into the domain, m2/s (m3/s in space), at time t.
  double flux(double time) const;
  const OpenPlane<dim>& plane() const { return plane_; }

 private:
  bool owns(const Vector<dim>& x) const { return plane_.depth(x) > -spacing_; }
  Inflow inflow_;
  OpenPlane<dim> plane_;
  Vector<dim> low_, high_;
  double spacing_;
  int columns_;
};

/// Columns at the prescribed pressure, through which fluid passes either way. A particle that
/// crosses the side outwards joins them, and past the outermost it is removed; one that crosses
/// inwards becomes fluid, and a new one enters the outermost column in its row if there is room.
/// Their velocity is that of the interior, mirrored in the side, so that du/dn = 0 there.
template <int dim>
class PressureColumns {
 public:
  PressureColumns(const PressureSide& side, const Box& channel, double spacing, double reach);
  void fill(Particles<dim>& particles) const;
  void exchange(Particles<dim>& particles, ParticleBooks& books) const;
  /// The prescribed pressure, as it is at the side; `balanced` as in State.
  void prescribe(Particles<dim>& particles, double time, const Vector<dim>& balanced) const;
  /// Gives the columns the velocity of the interior at the mirrored place (kernel average).
  void copy_velocity(Particles<dim>& particles, const Kernel<dim>& kernel) const;
  /// Turns the displacement along the side round where the columns move outwards. Copied as it is,
  /// a flow that still bends at the side is not free of divergence in the columns: where it speeds
  /// up along a wall they would pile up in the corner. (u_n, -u_t) of the mirrored place is free of
  /// it. Where they come in, particles on both sides of the plane must not part ways.
  void keep_volume(const Particles<dim>& particles, std::vector<Vector<dim>>& displacement) const;
  double depth() const { return columns_ * spacing_; }
  /// Whether a particle has passed the outermost column.
  bool beyond(const Vector<dim>& x) const { return plane_.depth(x) > depth(); }
  const OpenPlane<dim>& plane() const { return plane_; }

 private:
  bool owns(const Vector<dim>& x) const { return plane_.depth(x) > -spacing_; }
  PressureSide side_;
  OpenPlane<dim> plane_;
  Vector<dim> low_, high_;
  double spacing_;
  int columns_;
};

/// Puts particles in the order that Particles states and drops those marked. `cell` > 0 also sorts
/// the fluid by search cell.
template <int dim>
void sort_by_role(Particles<dim>& particles, const std::vector<bool>& dropped, double cell);

}  // namespace sprung::sph
