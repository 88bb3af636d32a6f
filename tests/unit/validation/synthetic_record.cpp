#include "synthetic_record.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "scene/problem.hpp"
#include "scene/record.hpp"

namespace sprung::synthetic {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double height = 0.3, length = 0.9, beam_left = 0.3, beam_width = 0.015, beam_height = 0.1;

std::string scene_text(double youngs_modulus, const std::string& preset) {
  return R"(title = "Made-up beam"
source = "formulas, no run"
[domain]
channel = { from = ["0 m", "0 m"], to = ["0.9 m", "0.3 m"] }
[time]
end = "3 s"
[fluid]
density = "1000 kg/m3"
[viscosity]
dynamic = "1 Pa s"
[walls]
no_slip = ["bottom", "top"]
[inflow]
side = "left"
profile = "parabolic"
mean_velocity = "0.5 m/s"
ramp = "1 s"
[outflow]
side = "right"
pressure = "0 Pa"
[solid.beam]
body = { from = ["0.3 m", "0 m"], to = ["0.315 m", "0.1 m"] }
youngs_modulus = ")" +
         std::to_string(youngs_modulus) + R"( Pa"
clamped = "bottom"
[probes.tip]
displacement_of = ["0.3075 m", "0.1 m"]
[probes.profile]
velocity_along = { from = ["0.4 m", "0 m"], to = ["0.4 m", "0.3 m"], points = 121 }
times = ["0.2 s", "0.4 s", "0.6 s", "0.8 s", "1 s", "2 s", "3 s"]
[probes.force]
force_on = "beam"
[probes.outline]
outline_of = "beam"
points = 87
times = ["0.2 s", "0.4 s", "0.6 s", "0.8 s", "1 s", "2 s", "3 s"]
[numerics]
preset = ")" +
         preset + R"("
[sph]
spacing = "3.75 mm"
[reference_fem]
cell_size = "10 mm"
)";
}

double ramp(double t) {
  return std::min(t, 1.0);
}

double streamwise(double x, double y, double t) {
  const double wake =
      0.5 * std::exp(-std::pow((x - 0.42) / 0.1, 2) - std::pow((y - 0.05) / 0.06, 2));
  return ramp(t) * (6.0 * 0.5 * y * (height - y) / (height * height)) * (1.0 - wake);
}

double drag(double t) {
  return 20.0 * ramp(t) + 1.0 * std::sin(2.0 * pi * t / 0.055) * std::exp(-5.0 * t);
}

/// Where a material point of the beam has moved to: a parabolic bend.
std::array<double, 2> bent(double x, double y, double tip_x) {
  const double s = y / beam_height;
  return {x + tip_x * s * s, y - 0.6 * tip_x * tip_x / beam_height * s * s};
}

Manifest manifest_of(const std::string& solver, const Deviation& deviation,
                     const std::string& preset) {
  Manifest manifest;
  manifest.solver = solver;
  manifest.scene_title = "Made-up beam";
  manifest.scene_file = "scene.toml";
  manifest.scene_toml = scene_text(deviation.youngs_modulus, preset);
  manifest.libraries = {{"formulas", "1"}};
  return manifest;
}

void write_series(RecordWriter& writer, const Deviation& deviation, double step, bool particles) {
  writer.declare_series("tip", {{"time", "s"}, {"displacement_x", "m"}, {"displacement_y", "m"}});
  writer.declare_series("force", {{"time", "s"}, {"force_x", "N/m"}, {"force_y", "N/m"}});
  std::vector<Column> mass{
      {"time", "s"}, {"inflow", "m2/s"}, {"outflow", "m2/s"}, {"excess_outflow", "m2"}};
  if (particles) {
    mass.insert(mass.end(),
                {{"particles", "1"}, {"created", "1"}, {"removed", "1"}, {"lost", "1"}});
  }
  writer.declare_series("ledger_mass", mass);
  writer.declare_series(
      "ledger_energy",
      {{"time", "s"}, {"kinetic_fluid", "J/m"}, {"kinetic_solid", "J/m"}, {"elastic", "J/m"}});
  writer.declare_series("ledger_solid", {{"time", "s"}, {"area_ratio", "1"}, {"max_stretch", "1"}});
  writer.declare_series("ledger_divergence", {{"time", "s"}, {"rms_divergence", "1/s"}});
  const auto steps = static_cast<int>(std::lround(deviation.stops_at / step));
  for (int i = 0; i <= steps; ++i) {
    const double t = i * step;
    const double bend = deviation.amplitude * tip(t - deviation.lag);
    const double noise = deviation.force_noise * std::sin(2.0 * pi * 200.0 * t);
    const double flow = 0.15 * ramp(t);
    writer.append("tip", std::array{t, bend, -0.6 * bend * bend / beam_height});
    writer.append("force", std::array{t, drag(t) + deviation.force_offset + noise, 3.0 * ramp(t)});
    std::vector<double> row{t, flow, flow, deviation.excess_outflow * t / 3.0};
    if (particles) {
      const double through = std::floor(100.0 * t);
      const double lost = t >= 2.9 ? deviation.lost : 0.0;
      const double vanished = t >= 2.9 ? deviation.vanished : 0.0;
      row.insert(row.end(), {19200.0 - lost - vanished, through, through + lost, lost});
    }
    writer.append("ledger_mass", row);
    writer.append("ledger_energy",
                  std::array{t, 40.0 * ramp(t) * ramp(t), 0.1 * bend, 50.0 * bend * bend});
    writer.append("ledger_solid", std::array{t, 1.0 + 0.001 * ramp(t), 1.0 + bend});
    writer.append("ledger_divergence", std::array{t, 0.05 * ramp(t)});
  }
}

void write_tables(RecordWriter& writer, const Deviation& deviation) {
  Solid beam;
  beam.name = "beam";
  beam.body = {{beam_left, 0, 0}, {beam_left + beam_width, beam_height, 0}};
  beam.youngs_modulus = 0.7e6;
  beam.clamped = Side::bottom;
  const auto points = outline_points(beam, 87);
  for (const double t : probe_times()) {
    if (t > deviation.stops_at) continue;
    std::vector<double> rows;
    for (int i = 0; i < 121; ++i) {
      const double y = height * i / 120.0;
      rows.insert(rows.end(), {0.4, y, streamwise(0.4, y, t) + deviation.velocity_offset, 0.0});
    }
    writer.write_table(
        "profile", t, {{"x", "m"}, {"y", "m"}, {"velocity_x", "m/s"}, {"velocity_y", "m/s"}}, rows);
    rows.clear();
    for (const Point& p : points) {
      const auto moved = bent(p[0], p[1], deviation.amplitude * tip(t));
      rows.insert(rows.end(), {p[0], p[1], moved[0], moved[1]});
    }
    writer.write_table("outline", t,
                       {{"reference_x", "m"}, {"reference_y", "m"}, {"x", "m"}, {"y", "m"}}, rows);
  }
}

bool in_beam(double x, double y) {
  return x > beam_left && x < beam_left + beam_width && y < beam_height;
}

void write_particles(RecordWriter& writer, double t, double amplitude) {
  constexpr double dx = 0.0075;
  std::vector<double> position, velocity, pressure, role;
  for (double y = 0.5 * dx; y < height; y += dx) {
    for (double x = 0.5 * dx; x < length; x += dx) {
      const bool beam = in_beam(x, y);
      const auto moved = beam ? bent(x, y, amplitude * tip(t)) : std::array{x, y};
      position.insert(position.end(), {moved[0], moved[1], 0.0});
      velocity.insert(velocity.end(), {beam ? 0.0 : streamwise(x, y, t), 0.0, 0.0});
      pressure.push_back(66.67 * (length - x) * ramp(t));
      role.push_back(beam ? 0.0 : 1.0);
    }
  }
  writer.write_points(t, position,
                      {{"velocity", 3, velocity}, {"pressure", 1, pressure}, {"role", 1, role}});
}

void write_cells(RecordWriter& writer, double t) {
  constexpr int columns = 90, rows = 30;
  std::vector<double> position, velocity, body;
  std::vector<std::int64_t> cells;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double x = length * i / columns, y = height * j / rows;
      position.insert(position.end(), {x, y, 0.0});
      velocity.insert(velocity.end(), {streamwise(x, y, t), 0.0, 0.0});
      body.push_back(in_beam(x, y) ? 1.0 : 0.0);
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const std::int64_t a = j * (columns + 1) + i;
      cells.insert(cells.end(), {a, a + 1, a + columns + 2, a + columns + 1});
    }
  }
  writer.write_mesh(t, position, 4, cells, {{"velocity", 3, velocity}, {"body", 1, body}});
}

}  // namespace

double tip(double t) {
  if (t < 0.0) return 0.0;
  return 0.04 * ramp(t) + 0.004 * std::exp(-4.0 * t) * std::sin(2.0 * pi * t / 0.35);
}

const std::vector<double>& probe_times() {
  static const std::vector<double> times{0.2, 0.4, 0.6, 0.8, 1.0, 2.0, 3.0};
  return times;
}

void write_reference(const std::filesystem::path& folder, bool with_fields) {
  RecordWriter writer(folder, manifest_of("reference_fem", {}, "recommended"), true);
  write_series(writer, {}, 0.01, false);
  write_tables(writer, {});
  if (with_fields) {
    for (const double t : probe_times()) write_cells(writer, t);
  }
  writer.set_cost({{"assemble", 20.0}, {"factorise", 15.0}, {"solve", 5.0}});
  writer.set_number("unknowns", 15700.0);
  writer.finish("finished");
}

void write_run(const std::filesystem::path& folder, const Deviation& deviation,
               const std::string& preset, bool with_fields) {
  RecordWriter writer(folder, manifest_of("sph", deviation, preset), true);
  write_series(writer, deviation, 0.001, true);
  write_tables(writer, deviation);
  if (with_fields) {
    for (const double t : probe_times()) {
      if (t <= deviation.stops_at) write_particles(writer, t, deviation.amplitude);
    }
  }
  writer.set_cost({{"ACTION 3 support and mirrors", 8.0},
                   {"ACTION 4 body forces", 3.0},
                   {"ACTION 5 predictor", 6.0},
                   {"ACTION 6 pressure", 25.0},
                   {"ACTION 7 corrector", 5.0},
                   {"ACTION 8 motion", 3.0}});
  writer.set_number("particles", 19200.0);
  writer.finish(deviation.outcome);
}

void write_error_bar(const std::filesystem::path& folder, double relative) {
  nlohmann::json quantities = nlohmann::json::array();
  const auto add = [&](const char* name, double scale) {
    for (const double t : probe_times()) {
      quantities.push_back({{"name", name}, {"time", t}, {"error", relative * scale}});
    }
  };
  add("tip.displacement_x", 0.04);
  add("tip.displacement_y", 0.04);
  add("profile.velocity_x", 0.75);
  add("force.force_x", 20.0);
  add("outline.x", 0.04);
  add("outline.y", 0.04);
  std::ofstream(folder / "error_bar.json") << nlohmann::json{{"quantities", quantities}}.dump(1);
}

}  // namespace sprung::synthetic
