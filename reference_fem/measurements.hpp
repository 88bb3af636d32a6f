#pragma once
/// What a run measures and hands to its record: probes, ledgers, snapshots.

#include "reference_fem/time_integration.hpp"
#include "scene/record.hpp"

namespace sprung::reference {

/// Integrals over the plane at one time.
struct Balance {
  double inflow = 0.0, outflow = 0.0;               ///< m2/s
  double kinetic_fluid = 0.0, kinetic_solid = 0.0;  ///< J/m
  double elastic = 0.0;                             ///< J/m
  double dissipation = 0.0;                         ///< W/m
  double power = 0.0;       ///< W/m, put in through the sides, less what is carried out
  double fluid_area = 0.0;  ///< m2
  double solid_area = 0.0, solid_area_at_rest = 0.0;  ///< m2
  double min_stretch = 1.0, max_stretch = 1.0;        ///< smallest and largest principal stretch
  double rms_divergence = 0.0;                        ///< 1/s
  double smallest_volume_ratio = 1.0;                 ///< least det F of the fluid's mesh
};

Balance balance(const FluidStructure& system, const Fields& fields, const StageWeights& weights);

/// What a step was.
struct StepReport {
  double time_step = 0.0;  ///< s
  long iterations = 0;
  bool from_kink = false;  ///< the boundary values' rates jumped where it began
};

class Measurements {
 public:
  Measurements(const FluidStructure& system, RecordWriter& record);
  /// A row of every series; at the very start, where forces are not defined, of displacements only.
  void each_step(const State& state, const StageWeights& weights, const StepReport& step);
  /// Profiles and outlines due at `time`, and a snapshot of the fields.
  void at(double time, const State& state);
  void save(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  void append_pressures(const State& state);
  void write_profile(const VelocityProfileProbe& probe, double time, const State& state);
  void write_outline(const OutlineProbe& probe, double time, const State& state);
  void write_fields(double time, const State& state);

  const FluidStructure& system_;
  RecordWriter& record_;
  std::vector<Place> displacement_places_;
  std::vector<std::vector<std::vector<Place>>> pressure_places_;  ///< while no body moves the mesh
  std::vector<std::vector<Place>> outline_places_;
  std::vector<std::vector<Point>> outline_points_;
  // Running integrals, by the trapezoidal rule, and the rates at their last point.
  double time_ = 0.0, excess_ = 0.0, work_ = 0.0, dissipated_ = 0.0;
  double excess_rate_ = 0.0, power_ = 0.0, dissipation_ = 0.0;
};

}  // namespace sprung::reference
