#pragma once
/// Records made from formulas instead of runs: what a comparison must find in them is known
/// beforehand.

#include <filesystem>
#include <string>
#include <vector>

namespace sprung::synthetic {

/// How a made-up run differs from the made-up reference.
struct Deviation {
  double lag = 0.0;               ///< s, of the tip
  double amplitude = 1.0;         ///< of the tip and of the outline's bend
  double velocity_offset = 0.0;   ///< m/s, added to velocity_x along the profile
  double force_offset = 0.0;      ///< N/m, added to force_x
  double force_noise = 0.0;       ///< N/m, amplitude of a 200 Hz sine upon force_x
  double excess_outflow = 0.0;    ///< m2, reached at the end
  int lost = 0;                   ///< particles that the run counts as lost by the end
  int vanished = 0;               ///< particles gone by the end that no book mentions
  double stops_at = 3.0;          ///< s
  double youngs_modulus = 0.7e6;  ///< Pa, as the manifest's scene has it
  std::string outcome = "finished";
};

/// Displacement (m) of the reference's tip along x: a ramp to 40 mm within 1 s and a ringing mode
/// of 0.35 s upon it.
double tip(double t);

/// Times (s) of the made-up scene's profile and outline.
const std::vector<double>& probe_times();

/// Writes the reference's record; `with_fields` adds a snapshot of a mesh at 1 s.
void write_reference(const std::filesystem::path& folder, bool with_fields = false);

/// Writes a particle record; `with_fields` adds snapshots of particles.
void write_run(const std::filesystem::path& folder, const Deviation& deviation,
               const std::string& preset = "recommended", bool with_fields = false);

/// Writes error_bar.json with one half-width per quantity at all probe times: `relative` times 40
/// mm for the tip and the outline, times 0.75 m/s for the profile, times 20 N/m for the force.
void write_error_bar(const std::filesystem::path& folder, double relative);

}  // namespace sprung::synthetic
