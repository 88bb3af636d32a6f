#pragma once
/// The beam scene of the tests: coarse, short, of dyadic size where asked, and changed by the
/// tests.

#include "sph/scene_setup.hpp"

#include <fmt/format.h>

#include <fstream>
#include <string>

namespace sprung::sph::test {

/// The paper's beam (section 4.1) in a channel; lengths in m.
struct ChannelScene {
  double length = 0.9, height = 0.3, spacing = 0.0075;
  double y_low = 0.0;  ///< lower wall
  double beam_x = 0.3, beam_width = 0.015, beam_height = 0.1;
  bool beam = true;
  bool beam_on_top = false;
  double density = 1000.0, viscosity = 1.0, youngs_modulus = 0.7e6;
  double mean_velocity = 0.5, ramp = 1.0;
  double end = 0.04;
  std::string walls = "no_slip";
  std::string profile = "parabolic";
  std::string preset = "recommended";
  std::string probe_times = "\"0.02 s\", \"0.04 s\"";
  double probe_x = 0.4;
  std::string numerics;  ///< further lines of [numerics]
  std::string sph;       ///< further lines of [sph]

  std::string text() const {
    const double y_high = y_low + height;
    std::string toml = fmt::format(
        "title = \"Beam\"\nsource = \"a test\"\n"
        "[domain]\nchannel = {{ from = [\"0 m\", \"{} m\"], to = [\"{} m\", \"{} m\"] }}\n"
        "[time]\nend = \"{} s\"\n[fluid]\ndensity = \"{} kg/m3\"\n[viscosity]\ndynamic = \"{} Pa "
        "s\"\n"
        "[walls]\n{} = [\"bottom\", \"top\"]\n"
        "[inflow]\nside = \"left\"\nprofile = \"{}\"\nmean_velocity = \"{} m/s\"\nramp = \"{} s\"\n"
        "[outflow]\nside = \"right\"\npressure = \"0 Pa\"\n",
        y_low, length, y_high, end, density, viscosity, walls, profile, mean_velocity, ramp);
    if (beam) {
      const double from = beam_on_top ? y_high - beam_height : y_low;
      const double tip = beam_on_top ? from : from + beam_height;
      toml += fmt::format(
          "[solid.beam]\nbody = {{ from = [\"{} m\", \"{} m\"], to = [\"{} m\", \"{} m\"] }}\n"
          "youngs_modulus = \"{} Pa\"\nclamped = \"{}\"\n"
          "[probes.tip]\ndisplacement_of = [\"{} m\", \"{} m\"]\n[probes.force]\nforce_on = "
          "\"beam\"\n"
          "[probes.outline]\noutline_of = \"beam\"\npoints = 21\ntimes = [{}]\n",
          beam_x, from, beam_x + beam_width, from + beam_height, youngs_modulus,
          beam_on_top ? "top" : "bottom", beam_x + 0.5 * beam_width, tip, probe_times);
    }
    toml += fmt::format(
        "[probes.profile]\nvelocity_along = {{ from = [\"{0} m\", \"{1} m\"], to = [\"{0} m\", "
        "\"{2} m\"], "
        "points = 31 }}\ntimes = [{3}]\n"
        "[numerics]\npreset = \"{4}\"\n{5}\n[sph]\nspacing = \"{6} m\"\n{7}\n",
        probe_x, y_low, y_high, probe_times, preset, numerics, spacing, sph);
    return toml;
  }
  Document document() const { return Document::from_text(text(), "beam.toml"); }
};

/// lambda = E/k_e of the plane lattices in closed form (plane strain, incompressible): 3/2; with
/// area springs of kappa G, E = 3G (2 + kappa)/(3 + kappa), G = k_e/2. Written to `file` and read
/// back.
inline ModulusTable plane_modulus_table(const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "dimension,bonds,area_stiffness,modulus_per_stiffness\n"
         "2,equal,0,1.5\n2,isotropic,0,1.5\n2,isotropic,300,1.49504950495\n";
  out.close();
  return ModulusTable(file);
}

}  // namespace sprung::sph::test
