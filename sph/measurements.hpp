#pragma once
/// The measurements of one run, handed to its record: probes, ledgers, field snapshots.

#include "scene/record.hpp"
#include "sph/scene_setup.hpp"

namespace sprung::sph {

template <int dim>
class Measurements {
 public:
  /// Declares the series; both must outlive it.
  Measurements(ParticleScene<dim>& scene, RecordWriter& record);
  /// Quantities of every step: displacement, force.
  void each_step();
  /// What the fluid did to the body in the last step.
  Vector<dim> force_on(const BodyRange& body) const;
  /// A row in every ledger.
  void ledgers();
  /// What was asked for at this time: profiles, outlines, and a snapshot of the fields.
  void at(double time);
  void save(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  void append_pressure(const PressureProbe& probe);
  static bool due(const std::vector<double>& times, double time);
  void declare(const std::string& name, std::vector<Column> columns);
  void append(const std::string& name, const Vector<dim>& value);
  const BodyRange& body_named(const std::string& name) const;
  /// Normal velocity integrated over a line one support radius inside each outflow side.
  double outflow_flux() const;
  /// Volume of the solid over its volume at rest, from the lattice cells (the plane only).
  void write_profile(const VelocityProfileProbe& probe, double time);
  void write_outline(const OutlineProbe& probe, double time);
  void write_fields(const State<dim>& state, double time);

  ParticleScene<dim>& scene_;
  RecordWriter& record_;
  double excess_ = 0.0;            ///< integral of outflow - inflow, m2 (m3)
  double ledger_time_ = 0.0;       ///< of the last ledger row, s
  double last_excess_rate_ = 0.0;  ///< then
};

}  // namespace sprung::sph
