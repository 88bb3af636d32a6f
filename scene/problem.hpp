#pragma once
/// The physics and the measurements of a scene: what both solvers must agree on, read once, in SI.
/// Discretisation ([sph], [numerics], [reference_fem]) is each solver's own.

#include "scene/document.hpp"
#include "scene/waveform.hpp"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sprung {

/// Coordinates in metres; the third is 0 in a plane problem.
using Point = std::array<double, 3>;

struct Box {
  Point from{};
  Point to{};
};

/// Sides of the channel box: "left"/"right" bound x, "bottom"/"top" y, "back"/"front" z.
enum class Side { left, right, bottom, top, back, front };
const char* to_string(Side side);

/// Shear thinning or thickening (Carreau 1972, Yasuda et al. 1981), mu0 being Viscosity::dynamic:
/// mu = mu_high + (mu0 - mu_high) (1 + (relaxation_time rate)^transition)^((power - 1) / transition).
struct CarreauYasuda {
  double high_shear = 0.0;       ///< mu at unbounded shear rate, Pa s
  double relaxation_time = 0.0;  ///< s
  double power = 1.0;            ///< n; 1: Newtonian
  double transition = 2.0;       ///< a; 2: Carreau's law
};

struct Viscosity {
  double dynamic = 0.0;  ///< Pa s; with Carreau-Yasuda at vanishing shear rate
  std::optional<CarreauYasuda> carreau_yasuda;
};

struct Walls {
  std::vector<Side> no_slip;
  std::vector<Side> free_slip;
};

/// A no-slip wall of the channel that moves in its own plane: velocity x waveform(t).
struct WallMotion {
  Side side = Side::top;
  Point velocity{};  ///< m/s, no part along the normal
  Waveform waveform;
};

/// Axes across which both sides of the channel are one.
struct Periodic {
  std::array<bool, 3> axis{};
};

/// A uniform force per mass: acceleration x waveform(t).
struct Gravity {
  Point acceleration{};  ///< m/s2
  Waveform waveform;
};

/// A rigid wall at rest that need not be flat; the fluid is on one side of it.
struct CurvedWall {
  std::string name;
  enum class Shape { circle, polygon, cylinder, surface } shape = Shape::circle;
  Point centre{};              ///< circle, cylinder (its coordinate along the axis means nothing)
  double radius = 0.0;         ///< m
  int axis = 0;                ///< of a cylinder
  std::vector<Point> corners;  ///< of a polygon, in order, not repeated at the end
  std::filesystem::path file;  ///< of a triangulated surface, STL or Gmsh, in metres
  bool fluid_inside = false;
  bool no_slip = true;
};

/// Normal velocity over one side, Eq. 6 of the paper:
/// profile(s) x mean_velocity x min(t / ramp, 1) x waveform(t).
struct Inflow {
  Side side = Side::left;
  enum class Profile { parabolic, uniform } profile = Profile::parabolic;
  double mean_velocity = 0.0;  ///< m/s
  double ramp = 0.0;           ///< s; 0 means full speed from the start
  Waveform waveform;
  /// Speed at distance `s` (m) along a side of length `height` (m) at time `t` (s). Eq. 6 read as
  /// the parabola of mean `mean_velocity`: 6 u s (H - s) / H^2.
  double speed(double s, double height, double t) const;
};

/// A side held at pressure x waveform(t), through which fluid may pass either way.
struct PressureSide {
  Side side = Side::right;
  double pressure = 0.0;  ///< Pa
  Waveform waveform;
  double pressure_at(double time) const { return pressure * waveform.value(time); }
};

/// Part of a ring in the x-y plane (in space: of a tube along z), anticlockwise from `from_angle`
/// (rad, from the x axis).
struct Arc {
  Point centre{};
  double inner_radius = 0.0, outer_radius = 0.0;  ///< m
  double from_angle = 0.0, to_angle = 0.0;        ///< rad
};

/// Springs that grow stiffer when stretched, as soft tissue does beyond its toe.
struct StrainStiffening {
  double ratio = 1.0;       ///< modulus beyond the toe over Young's modulus
  double toe_strain = 0.0;  ///< strain at which it is reached
};

/// A Maxwell branch beside the springs.
struct Viscoelasticity {
  double modulus = 0.0;          ///< that a sudden strain adds to Young's modulus, Pa
  double relaxation_time = 0.0;  ///< s
};

/// Fibres along one direction of the body's own axes at rest.
struct Fibre {
  double angle = 0.0;      ///< rad from the first axis towards the second
  double elevation = 0.0;  ///< rad from their plane towards the third
  double modulus = 0.0;    ///< added along the fibres, Pa
};

/// An elastic body, incompressible, with the fluid's density: a box, possibly turned about its
/// middle, or part of a ring. body_shape.hpp has its own frame.
struct Solid {
  std::string name;
  /// Before it is turned; of an arc the box around it, in space with its extent along z.
  Box body;
  double angle = 0.0;  ///< rad, anticlockwise about the middle of `body`, in the x-y plane
  std::optional<Arc> arc;
  double youngs_modulus = 0.0;  ///< Pa
  /// A side of the channel that the body touches; of a turned body or an arc, a side of the body
  /// in its own frame, which is held where it is.
  std::optional<Side> clamped;
  std::optional<StrainStiffening> stiffening;
  std::optional<Viscoelasticity> viscoelasticity;
  std::optional<Fibre> fibre;
};

/// Displacement (m) of the material point that was at `point` at the start.
struct DisplacementProbe {
  std::string name;
  Point point{};
  std::string solid;  ///< the body that holds the point
};

/// Velocity at `points` places evenly spaced from one end to the other (both included), at `times`.
struct VelocityProfileProbe {
  std::string name;
  Point from{}, to{};
  int points = 0;
  std::vector<double> times;
};

/// Force of the fluid on a solid or on a curved wall, components along the axes; N per metre of
/// depth in a plane problem.
struct ForceProbe {
  std::string name;
  std::string solid;        ///< empty when it is a curved wall
  std::string curved_wall;  ///< empty when it is a solid
};

/// Pressure (Pa) at fixed places.
struct PressureProbe {
  std::string name;
  std::vector<Point> places;
};

/// Where the material points of a body's wetted outline have moved to, at `times`. Points are
/// spaced evenly along the outline from one clamped corner round to the other.
struct OutlineProbe {
  std::string name;
  std::string solid;
  int points = 0;
  std::vector<double> times;
};

struct Probes {
  std::vector<DisplacementProbe> displacement;
  std::vector<VelocityProfileProbe> velocity_profile;
  std::vector<ForceProbe> force;
  std::vector<PressureProbe> pressure;
  std::vector<OutlineProbe> outline;
  /// Every time at which some probe or field output wants the state, ascending, without repeats.
  std::vector<double> all_times;
};

struct Problem {
  std::string title;
  std::string source;
  int dimension = 2;
  Box channel;
  double end_time = 0.0;  ///< s
  double density = 0.0;   ///< kg/m3, fluid and solid alike
  std::optional<Viscosity> viscosity;
  std::optional<Walls> walls;
  std::vector<WallMotion> wall_motion;
  std::vector<CurvedWall> curved_walls;
  std::optional<Periodic> periodic;
  std::optional<Gravity> gravity;
  /// Velocity at the start (m/s), one formula of x, y, z (m) a component; empty: at rest.
  std::vector<Formula> initial_velocity;
  std::optional<Inflow> inflow;                 ///< [inflow] with a velocity
  std::optional<PressureSide> pressure_inflow;  ///< [inflow] with a pressure
  std::optional<PressureSide> outflow;
  std::vector<Solid> solids;
  Probes probes;
  double fields_every = 0.0;  ///< s between field snapshots; 0: only at the probes' times
};

/// Reads and checks the shared tables. Refuses, with file, line, value and remedy: a body that is
/// not inside the channel or does not touch the side it is clamped to, a probe outside the domain
/// or its body, times beyond the end, a side that is given two conditions.
Problem read_problem(const Document& document);

/// The material points of an outline probe, `points` of them, evenly spaced along the body's free
/// sides, clockwise as seen with x to the right and y up. A clamped body: from one clamped corner
/// to the other, both included ("bottom": up the left side, along the top, down the right side). A
/// free one: once round from the lower left corner, which is not repeated at the end. Sides and
/// corners of an oblique body are those of its own frame. Throws
/// std::invalid_argument for fewer than two points or a body clamped in the third direction.
std::vector<Point> outline_points(const Solid& solid, int points);

}  // namespace sprung
