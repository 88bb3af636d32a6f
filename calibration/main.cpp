/// sprung-calibrate: measures lambda = E/k_e of the spring lattices by tests that run through sph/.

#include "calibration/bending_test.hpp"
#include "calibration/finite_strain.hpp"
#include "calibration/lattice_modulus.hpp"
#include "calibration/published.hpp"
#include "calibration/surface_layer.hpp"
#include "scene/command_line.hpp"
#include "scene/progress.hpp"
#include "sph/scene_setup.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <array>
#include <cmath>
#include <numbers>

namespace {

using namespace sprung;
using namespace sprung::calibration;

struct Arguments {
  std::string out = SPRUNG_CALIBRATION_FOLDER;
  std::vector<double> area_stiffness;
  std::string row;  ///< "3,isotropic,300": the only one to measure
  bool resume = false;
  int threads = 1;
  int layers = 20;
  double seconds = 10.0;
  double stress = 1e-4;   ///< nominal, over Young's modulus
  bool pressure = false;  ///< the cube's volume kept by the pressure equation, not by springs
  std::string command;
};

/// The rows that the particle solver's presets and studies need.
std::vector<Material> backbone() {
  using enum sph::Bonds;
  return {{2, equal, 0.0},       {2, isotropic, 0.0},   {2, isotropic, 30.0},
          {2, isotropic, 100.0}, {2, isotropic, 300.0}, {2, isotropic, 1000.0},
          {3, equal, 0.0},       {3, isotropic, 0.0},   {3, isotropic, 300.0},
          {3, equal, 300.0}};
}

/// Measures rows of the table. A row is written as soon as it is measured, so that what was stopped
/// goes on with --resume.
int measure_table(const Arguments& a) {
  std::vector<Material> materials;
  for (const double kappa : a.area_stiffness)
    materials.push_back({2, sph::Bonds::isotropic, kappa});
  if (materials.empty()) materials = backbone();
  if (!a.row.empty()) {
    std::erase_if(materials, [&](const Material& m) { return key_of(m) != a.row; });
    if (materials.empty())
      throw std::runtime_error("--row: there is no row " + a.row +
                               "; such as 2,equal,0 or 3,isotropic,300");
  }
  const auto folder = std::filesystem::path(a.out);
  const auto file = folder / "modulus_per_stiffness.csv";
  Sheet table = read_sheet(file), pulls = read_sheet(folder / "pulls.csv");
  if (table.header != modulus_header()) table = {modulus_header(), {}};
  pulls.header = pull_header();
  for (const Material& material : materials) {
    const std::string key = key_of(material);
    if (a.resume && row_is_current(file, key)) {
      fmt::print("{:>22}  measured before by this program\n", key);
      continue;
    }
    Progress progress(key, 1.0);
    const BulkModulus bulk = measure_bulk(
        material, [&](double done, const std::string& remark) { progress.advance(done, remark); });
    fmt::print(
        "{:>22}  lambda {:.4f} +- {:.4f}, theory {:.4f} ({:+.2f} %), Poisson {:.4f}, {:.0f} s\n",
        key, bulk.lambda, bulk.interval, theoretical_lambda(material),
        100.0 * (bulk.lambda / theoretical_lambda(material) - 1.0), bulk.poisson_ratio,
        bulk.seconds);
    std::fflush(stdout);
    replace_row(table, key, modulus_row(bulk));
    for (const auto& pull : bulk.pulls)
      replace_row(pulls, fmt::format("{},{}", key, pull.layers), pull_row(pull));
    const Provenance provenance{a.command, modulus_definition(), bulk.seconds, {key}};
    publish(folder / "pulls.csv", pulls, provenance);
    publish(file, table, provenance);
  }
  return 0;
}

/// The paper's experiment (its Fig. 4): k_e from 0.05 to 3.1 MPa under +-0.01 MPa.
constexpr double cube_stress = 1.0e4;                 // Pa
constexpr double softest = 0.05e6, stiffest = 3.1e6;  // k_e, Pa

std::vector<double> stiffnesses(int count) {
  std::vector<double> k_e;
  for (int k = 0; k < count; ++k)
    k_e.push_back(softest * std::pow(stiffest / softest, double(k) / (count - 1)));
  return k_e;
}

/// A cube of side 0.1 m, +-0.01 MPa on two faces, ten springs.
int sweep(const Arguments& a) {
  const Material material{3, sph::Bonds::equal, 0.0};
  Sheet sheet{"k_e_pa,stress_pa," + pull_header(), {}};
  const double began = wall_seconds();
  const auto springs = stiffnesses(10);
  Progress progress("sweep of k_e", 2.0 * static_cast<double>(springs.size()));
  for (const double k_e : springs)
    for (const double sign : {1.0, -1.0}) {
      Pull pull;
      pull.layers = a.layers;
      pull.load = sign * cube_stress / k_e;
      pull.smoothing_length_ratio = 1.0;
      sheet.rows.push_back(fmt::format("{:.6g},{:.6g},{}", k_e, sign * cube_stress,
                                       pull_row(pull_block(material, pull))));
      progress.advance(static_cast<double>(sheet.rows.size()),
                       fmt::format("k_e {:.3g} MPa", 1e-6 * k_e));
    }
  publish(std::filesystem::path(a.out) / fmt::format("sweep_{}.csv", a.layers), sheet,
          {a.command,
           "Cube of the paper's section 3.4: +-0.01 MPa on (n dx)^2 as a dead force on the "
           "particles of "
           "two end layers, bonds equal, particle solver in vacuum. lambda by three gauges, stress "
           "on (n dx)^2.",
           wall_seconds() - began,
           {}});
  return 0;
}

/// One cube of the corrected isotropic lattice under a nominal stress, k_e from the published
/// table: what a user's body of that many layers does, for a comparison of its error and its cost.
/// The strain that counts is that of the middle half: the load sits on the particles of two layers,
/// and near them it is no uniform traction.
int cube(const Arguments& a) {
  const Material material{3, sph::Bonds::isotropic, a.pressure ? 0.0 : 300.0};
  const sph::ModulusTable table(SPRUNG_CALIBRATION_FOLDER "/modulus_per_stiffness.csv");
  Pull pull;
  pull.layers = a.layers;
  pull.surface_correction = true;
  pull.load = a.stress * table.modulus_per_stiffness(3, material.bonds, material.area_stiffness);
  const double began = wall_seconds();
  const PulledBlock block =
      a.pressure ? pull_by_particle_solver<3>(material, pull) : pull_network<3>(material, pull);
  publish(std::filesystem::path(a.out) / "cube.csv",
          {"dimension,bonds,area_stiffness,layers,stress_over_modulus,strain_middle_half,"
           "strain_ends,steps",
           {fmt::format("{},{},{:.17g},{:.17g},{:.17g},{}", key_of(material), a.layers, a.stress,
                        block.strain_inner, block.strain_ends, block.steps)}},
          {a.command,
           "Cube of n layers, isotropic bonds with surface correction, under a dead force on the "
           "particles of two end layers, k_e by modulus_per_stiffness.csv. Strain between the "
           "layers n/4 from either end, and between the end layers. area_stiffness 0: the particle "
           "solver in vacuum, volume kept by the pressure equation; else the network at rest.",
           wall_seconds() - began,
           {}});
  return 0;
}

/// Poisson's ratio of a cube through the sweep's range of strain: by the pressure equation at two
/// smoothing lengths, and of the corrected network with volume springs.
int poisson(const Arguments& a) {
  struct Case {
    sph::Bonds bonds;
    double area_stiffness, smoothing_length_ratio;
    int layers;
  };
  // The core of 24 layers begins 6 below a face, where little is left of the face's pressure
  // layer (surface_layer.csv).
  const Case cases[] = {{sph::Bonds::equal, 0.0, 1.0, 24},
                        {sph::Bonds::equal, 0.0, 1.3, 24},
                        {sph::Bonds::isotropic, 300.0, 0.0, 8}};
  Sheet sheet{
      "k_e_pa,stress_pa,dimension,bonds,area_stiffness,smoothing_length_ratio,layers,axial_strain,"
      "lateral_strain,poisson_ratio,poisson_derived",
      {}};
  const double began = wall_seconds();
  Progress progress("Poisson's ratio", 30.0);
  for (const Case& c : cases)
    for (const double k_e : stiffnesses(5))
      for (const double sign : {1.0, -1.0}) {
        Pull pull;
        pull.layers = c.layers;
        pull.load = sign * cube_stress / k_e;
        pull.smoothing_length_ratio = c.smoothing_length_ratio;
        pull.surface_correction = c.area_stiffness > 0.0;
        pull.load_steps = 1 + static_cast<int>(20.0 * std::abs(pull.load));
        const Material material{3, c.bonds, c.area_stiffness};
        const PulledBlock block = pull_block(material, pull).block;
        // Of volume springs: Lame's first constant (1 + kappa) G, nu = lambda/(2 (lambda + G)).
        const double derived =
            c.area_stiffness > 0.0
                ? 0.5 * (1.0 + c.area_stiffness) / (2.0 + c.area_stiffness)
                : kernel_sum_poisson_ratio<3>(c.smoothing_length_ratio, block.mean_axial);
        sheet.rows.push_back(fmt::format(
            "{:.6g},{:.6g},{},{:g},{},{:.8g},{:.8g},{:.5f},{:.5f}", k_e, sign * cube_stress,
            key_of(material), c.smoothing_length_ratio, c.layers, block.mean_axial,
            block.mean_lateral, poisson_ratio(3, block.mean_axial, block.mean_lateral), derived));
        progress.advance(static_cast<double>(sheet.rows.size()), sheet.rows.back());
      }
  publish(std::filesystem::path(a.out) / "poisson.csv", sheet,
          {a.command,
           "Poisson's ratio of the core (mean over its cells) of the sweep's cube, by fewer "
           "layers: -ln(lateral "
           "stretch)/ln(stretch). "
           "Without volume springs: particle solver in vacuum, volume kept by the pressure "
           "equation with density feedback at h = smoothing_length_ratio x dx; derived: the "
           "uniformly stretched lattice whose kernel sum is that at rest. With: network with "
           "surface correction; derived: (1 + kappa)/(2 (2 + kappa)), small strain.",
           wall_seconds() - began,
           {}});
  return 0;
}

/// How deep below a free face the pressure equation does not keep the volume, and what that makes
/// of Poisson's ratio of cores that begin at several depths.
int surface_layer(const Arguments& a) {
  const Material material{3, sph::Bonds::equal, 0.0};
  Sheet sheet{
      "dimension,bonds,area_stiffness,smoothing_length_ratio,layers,axial_strain,courant,"
      "decay_derived,period_derived,layers_below_face,density_error_over_strain,poisson_ratio",
      {}};
  const double began = wall_seconds();
  const std::array sizes{10, 12, 16, 20, 28};
  double whole = 0.0, done = 0.0;
  const auto cost = [](int n, double ratio) { return std::pow(n, 4) * std::pow(ratio, 3); };
  for (const double ratio : {1.0, 1.3})
    for (const int n : sizes) whole += cost(n, ratio);
  Progress progress("surface layer", whole);
  for (const double ratio : {1.0, 1.3})
    for (const int n : sizes) {
      Pull pull;
      pull.layers = n;
      pull.load = 1e-2;
      pull.smoothing_length_ratio = ratio;
      const SurfaceLayer layer = measure_surface_layer<3>(material, pull);
      const auto decay = surface_layer_decay(material, ratio, layer.courant, pull.density_feedback);
      for (std::size_t m = 0; m < layer.poisson_ratio.size(); ++m)
        sheet.rows.push_back(fmt::format("{},{:g},{},{:.6g},{:.4f},{:.4f},{:.3f},{},{:.5f},{:.5f}",
                                         key_of(material), ratio, n, layer.block.mean_axial,
                                         layer.courant, std::abs(decay),
                                         2.0 * std::numbers::pi / std::arg(decay), m,
                                         layer.density_error[m], layer.poisson_ratio[m]));
      progress.advance(done += cost(n, ratio), fmt::format("{} layers", n));
    }
  publish(std::filesystem::path(a.out) / "surface_layer.csv", sheet,
          {a.command,
           "Cubes of n layers pulled by the particle solver in vacuum to a strain of 0.35 %, their "
           "volume kept by the pressure equation with density feedback at h = "
           "smoothing_length_ratio x dx. density_error_over_strain: kernel sum over that at rest "
           "less 1, over the axial strain of the core n/4 layers below the faces, of the particle "
           "so many layers below the middle of a lateral face. poisson_ratio: of the core that "
           "begins so many layers below every face, mean over its cells. Derived for a plane face: "
           "the error's factor from a layer to the next and the layers of its period, from the "
           "difference between the divergence of the gradient and the Laplacian.",
           wall_seconds() - began,
           {}});
  return 0;
}

/// lambda in directions of one lattice plane spanned by `from` and the perpendicular `to`, every 5
/// degrees.
template <int dim>
void turn(const Material& material, const std::string& plane, const Vector<dim>& from,
          const Vector<dim>& to, Sheet& sheet) {
  const BulkLattice<dim> lattice(material);
  for (int degrees = 0; degrees < 360; degrees += 5) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vector<dim> direction =
        std::cos(angle) * from.normalized() + std::sin(angle) * to.normalized();
    sheet.rows.push_back(fmt::format("{},{},{},{:.6f}", key_of(material), plane, degrees,
                                     lattice.modulus_per_stiffness(direction)));
  }
}

/// lambda against the direction of the load, of the lattice without boundaries.
int directions(const Arguments& a) {
  const double began = wall_seconds();
  Sheet sheet{"dimension,bonds,area_stiffness,plane,angle_degrees,modulus_per_stiffness", {}};
  for (const auto bonds : {sph::Bonds::equal, sph::Bonds::isotropic}) {
    turn<2>({2, bonds, 0.0}, "xy", {1, 0}, {0, 1}, sheet);
    turn<3>({3, bonds, 0.0}, "001", {1, 0, 0}, {0, 1, 0}, sheet);   // [100] at 0, [110] at 45
    turn<3>({3, bonds, 0.0}, "1-10", {1, 1, 0}, {0, 0, 1}, sheet);  // [110] at 0, [111] at 35.26
  }
  publish(
      std::filesystem::path(a.out) / "directions.csv", sheet,
      {a.command,
       "lambda = E/k_e for a pull along a direction at an angle to the lattice: second derivatives "
       "of the "
       "energy that the springs of one particle in the bulk store under homogeneous strains, "
       "strain isochoric, sides free. Angles from the first axis (xy, 001) or from [110] towards "
       "[001] (1-10).",
       wall_seconds() - began,
       {}});
  return 0;
}

/// One kind of plate in the table of plates.
struct PlateCase {
  Material material;
  bool corrected;
  double angle_degrees, bend;
  const char* law;  ///< derived law of EI: "springs", "cells" or "exact"
};

std::string key_of(const PlateCase& c) {
  return fmt::format("{},{},{:g},{:g}", key_of(c.material), c.corrected ? "yes" : "no",
                     c.angle_degrees, c.bend);
}

double derived_bending(const PlateCase& c, const Plate& plate) {
  const std::string law = c.law;
  if (law == "springs") return 0.75 * (plate.layers - 1.0) / plate.layers;
  return law == "cells" ? uncorrected_bending_law(plate) : 1.0;
}

std::string plate_row(const PlateCase& c, int layers) {
  Plate plate{layers, c.material, c.corrected};
  plate.angle = c.angle_degrees * std::numbers::pi / 180.0;
  plate.bend = c.bend;
  plate.width = c.material.dimension == 3 ? layers + 1 : 1;
  const bool straight = c.bend == 0.0;
  const std::string stretching = straight ? fmt::format("{:.5f}", stretching_ratio(plate)) : "";
  const std::string frequency =
      straight && c.material.dimension == 2 ? fmt::format("{:.5f}", frequency_ratio(plate)) : "";
  return fmt::format("{},{},{},{},{:.5f},{},{:.5f}", key_of(c), plate.width, layers, stretching,
                     bending_ratio(plate), frequency, derived_bending(c, plate));
}

constexpr const char* bending_definition =
    "Plates over the continuum of thickness n dx and of the table's bulk modulus in theory: "
    "in the plane in plane strain, in space bars of n layers and `width` particles across. "
    "angle_degrees: to the axes, the particles fitted to the plate; bend: thickness over the "
    "radius of the middle line, compared with Golovin's curved bar. Stretching EA and "
    "bending EI: static, dead forces or couples on the end rows, strain and change of slope "
    "of the middle half, 16 n rows (in space 8 n). Frequency: first of the plate clamped at "
    "one end, 10 n rows, over that of the Timoshenko beam (shear coefficient 5/6). Law: 0.75 "
    "(n-1)/n for springs alone, the count of bonds with cells that keep their volume, 1 with "
    "surface correction. One layer is a mechanism in bending and is refused.";

std::vector<int> layers_of(const PlateCase& c) {
  if (c.material.dimension == 3) return {2, 3, 4, 5, 6, 7, 8};
  std::vector<int> layers{2, 3, 4, 5, 6, 7, 8, 10, 12};
  if (c.angle_degrees == 0.0 && c.bend == 0.0) layers.insert(layers.end(), {16, 24, 32});
  return layers;
}

/// Plates of 2 and more layers, along the lattice, turned and bent, over the continuum. A case is
/// written as soon as it is measured; --resume keeps those of this very program.
int bending(const Arguments& a) {
  const PlateCase cases[] = {{{2, sph::Bonds::equal, 0.0}, false, 0.0, 0.0, "springs"},
                             {{2, sph::Bonds::isotropic, 300.0}, false, 0.0, 0.0, "cells"},
                             {{2, sph::Bonds::isotropic, 30.0}, true, 0.0, 0.0, "exact"},
                             {{2, sph::Bonds::isotropic, 300.0}, true, 0.0, 0.0, "exact"},
                             {{2, sph::Bonds::isotropic, 300.0}, true, 30.0, 0.0, "exact"},
                             {{2, sph::Bonds::isotropic, 300.0}, true, 0.0, 0.1, "exact"},
                             {{2, sph::Bonds::isotropic, 300.0}, true, 0.0, 0.4, "exact"},
                             {{3, sph::Bonds::isotropic, 300.0}, false, 0.0, 0.0, "cells"},
                             {{3, sph::Bonds::isotropic, 300.0}, true, 0.0, 0.0, "exact"},
                             {{3, sph::Bonds::isotropic, 300.0}, true, 30.0, 0.0, "exact"},
                             {{3, sph::Bonds::isotropic, 300.0}, true, 0.0, 0.2, "exact"}};
  const auto file = std::filesystem::path(a.out) / "bending.csv";
  const std::string header =
      "dimension,bonds,area_stiffness,surface_correction,angle_degrees,bend,width,layers,"
      "stretching,bending,frequency,law_bending";
  Sheet sheet = read_sheet(file, header);
  // A factorisation's work: of bands of width n in the plane, n^2 in space.
  const auto cost = [](const PlateCase& c, int n) {
    return std::pow(n, c.material.dimension == 2 ? 4 : 7);
  };
  double whole = 0.0, done = 0.0;
  for (const PlateCase& c : cases)
    for (const int n : layers_of(c)) whole += cost(c, n);
  Progress progress("bending", whole);
  for (const PlateCase& c : cases) {
    const std::string key = key_of(c);
    const double began = wall_seconds();
    const bool kept = a.resume && row_is_current(file, key);
    if (!kept)
      std::erase_if(sheet.rows, [&](const auto& row) { return row.starts_with(key + ","); });
    for (const int n : layers_of(c)) {
      if (!kept) sheet.rows.push_back(plate_row(c, n));
      progress.advance(done += cost(c, n), fmt::format("{} layers", n));
    }
    if (!kept) publish(file, sheet, {a.command, bending_definition, wall_seconds() - began, {key}});
  }
  return 0;
}

/// Stretches of the table: 0.7 to 1.3, of simple shear -0.3 to 0.3.
constexpr int stretches = 13, at_rest = stretches / 2;
double stretch_of(Deformation deformation, double k) {
  return (deformation == Deformation::simple_shear ? 0.0 : 1.0) + 0.05 * (k - at_rest);
}

/// Stresses over k_e at the table's stretches (linear between thirds of its steps, 1e-4) of a bar
/// of four corrected layers: pulled and pushed by the lattice's stresses, and further, until it has
/// come so far.
template <int dim>
std::array<double, stretches> bar_stresses(Material material) {
  constexpr int parts = 3, further = 8, layers = 4;
  const Material lattice = material;
  material.area_stiffness = 300.0;
  std::array<double, stretches> stress{};
  for (const int sign : {1, -1}) {
    std::vector<double> loads;
    for (int k = 1; k <= at_rest * parts + (sign > 0 ? further : 0); ++k) {
      const double place = at_rest + static_cast<double>(sign * k) / parts;
      loads.push_back(
          lattice_stress(lattice, Deformation::uniaxial, stretch_of(Deformation::uniaxial, place)) /
          spring_stiffness);
    }
    auto reached = pull_bar<dim>(material, layers, loads);
    reached.insert(reached.begin(), 1.0);
    loads.insert(loads.begin(), 0.0);
    for (int k = 1; k <= at_rest; ++k) {
      const double wanted = stretch_of(Deformation::uniaxial, at_rest + sign * k);
      std::size_t m = 1;
      while (m < reached.size() && sign * (reached[m] - wanted) < 0.0) ++m;
      if (m == reached.size())
        throw std::runtime_error(fmt::format("the bar was not stretched to {}", wanted));
      const double part = (wanted - reached[m - 1]) / (reached[m] - reached[m - 1]);
      stress[static_cast<std::size_t>(at_rest + sign * k)] =
          loads[m - 1] + part * (loads[m] - loads[m - 1]);
    }
  }
  return stress;
}

/// Nominal stress against stretch: lattice, neo-Hookean solid, and a bar pulled through the
/// network.
int stress_strain(const Arguments& a) {
  const double began = wall_seconds();
  Sheet sheet{"dimension,bonds,deformation,stretch,lattice_over_g,neo_hookean_over_g,bar_over_g",
              {}};
  struct Case {
    Material material;
    Deformation deformation;
    double shear_modulus;
  };
  const Material space{3, sph::Bonds::isotropic, 0.0}, plane{2, sph::Bonds::isotropic, 0.0};
  const Case cases[] = {{space, Deformation::uniaxial, spring_stiffness},
                        {space, Deformation::equibiaxial, spring_stiffness},
                        {space, Deformation::pure_shear, spring_stiffness},
                        {space, Deformation::simple_shear, spring_stiffness},
                        {plane, Deformation::uniaxial, 0.5 * spring_stiffness}};
  Progress progress("stress and stretch", 2.0);
  const auto in_space = bar_stresses<3>(space);
  progress.advance(1.0, "bar in space");
  const auto in_plane = bar_stresses<2>(plane);
  progress.advance(2.0, "in the plane");
  for (const Case& c : cases)
    for (int k = 0; k < stretches; ++k) {
      const double s = stretch_of(c.deformation, k);
      std::string bar;
      if (c.deformation == Deformation::uniaxial && k != at_rest) {
        const double stress =
            (c.material.dimension == 3 ? in_space : in_plane)[static_cast<std::size_t>(k)];
        bar = fmt::format("{:.5f}", stress * spring_stiffness / c.shear_modulus);
      }
      sheet.rows.push_back(
          fmt::format("{},{},{},{:.2f},{:.5f},{:.5f},{}", c.material.dimension,
                      to_string(c.material.bonds), to_string(c.deformation), s,
                      lattice_stress(c.material, c.deformation, s) / c.shear_modulus,
                      neo_hookean_stress(c.material.dimension, c.shear_modulus, c.deformation, s) /
                          c.shear_modulus,
                      bar));
    }
  publish(std::filesystem::path(a.out) / "stress_strain.csv", sheet,
          {a.command,
           "Nominal stress over G against stretch (of simple shear: shear) along the lattice's "
           "axes, volume kept. lattice: derivative of the energy of the springs of one particle in "
           "the bulk. neo_hookean: incompressible, W = G (I1 - 3)/2. bar: a bar of the corrected "
           "network with volume springs 300 G, 4 layers thick and 16 long, dead forces on its end "
           "layers, stretch of its middle half; its distance from lattice is what faces add.",
           wall_seconds() - began,
           {}});
  return 0;
}

constexpr const char* hold_definition =
    "Blocks of n layers along each axis pulled by the particle solver in vacuum (load: force on a "
    "particle of an end layer over k_e dx^(dimension-1)), brought to rest by damping and then "
    "held; k_e/density = 10 m2/s2. Without volume springs the pressure equation with density "
    "feedback keeps the volume, springs explicit; with them springs "
    "implicit, no feedback, bonds corrected at the surface. Poisson's ratio of the core (mean over "
    "its cells), -ln(lateral stretch)/ln(stretch), in the plane r/(1+r) of that. Volume: of the "
    "lattice cells.";

/// Poisson's ratio and volume of blocks held under their load for ten seconds. A row is written as
/// soon as it is measured; --resume keeps those of this very program.
int hold(const Arguments& a) {
  const auto file = std::filesystem::path(a.out) / "hold.csv";
  const std::string header =
      "dimension,bonds,area_stiffness,smoothing_length_ratio,load,layers,seconds,strain_before,"
      "strain_after,poisson_before,poisson_after,volume_drift_per_second";
  Sheet sheet = read_sheet(file, header);
  struct Case {
    Material material;
    double smoothing_length_ratio;
    int layers;
  };
  // Cores of 16 layers begin 4 below a face, where a tenth is left of the face's pressure layer
  // (surface_layer.csv); volume springs have none. What takes longest comes last.
  const Case cases[] = {{{3, sph::Bonds::equal, 0.0}, 1.0, 16},
                        {{3, sph::Bonds::equal, 0.0}, 1.3, 16},
                        {{2, sph::Bonds::equal, 0.0}, 1.3, 20},
                        {{2, sph::Bonds::isotropic, 300.0}, 1.3, 20},
                        {{3, sph::Bonds::isotropic, 300.0}, 1.0, 6}};
  Progress progress("hold", 2.0 * std::size(cases));
  double done = 0.0;
  for (const Case& c : cases)
    for (const double load : {1e-2, 1e-1}) {
      const std::string key =
          fmt::format("{},{:g},{:g}", key_of(c.material), c.smoothing_length_ratio, load);
      const double began = wall_seconds();
      if (!a.resume || !row_is_current(file, key)) {
        Pull pull;
        pull.surface_correction = c.material.area_stiffness > 0.0;
        pull.smoothing_length_ratio = c.smoothing_length_ratio;
        pull.layers = c.layers;
        pull.load = load;
        pull.tolerance = 1e-5;
        const HeldBlock held = c.material.dimension == 3
                                   ? hold_block<3>(c.material, pull, a.seconds)
                                   : hold_block<2>(c.material, pull, a.seconds);
        replace_row(
            sheet, key,
            fmt::format("{},{},{:g},{:.6f},{:.6f},{:.5f},{:.5f},{:.3e}", key, pull.layers,
                        held.seconds, held.strain_before, held.strain_after,
                        held.poisson_ratio_before, held.poisson_ratio_after, held.volume_drift));
        publish(file, sheet, {a.command, hold_definition, wall_seconds() - began, {key}});
      }
      progress.advance(++done, key);
    }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "Measures lambda = E/k_e of the spring lattices by tests that run through the particle "
      "solver\n\n"
      "Examples:\n"
      "  sprung-calibrate                          measure every row of the table (about 5 "
      "minutes)\n"
      "  sprung-calibrate --resume                 only rows this very program has not measured\n"
      "  sprung-calibrate --area-stiffness 50      measure and add one row\n"
      "  sprung-calibrate sweep                    the paper's cube, ten spring stiffnesses\n"
      "  sprung-calibrate cube --layers 8 --out results/cube   one cube, its strain\n"
      "  sprung-calibrate poisson                  Poisson's ratio through the sweep's strains\n"
      "  sprung-calibrate surface-layer            how deep a free face spoils Poisson's ratio\n"
      "  sprung-calibrate directions               lambda against the direction of the load\n"
      "  sprung-calibrate bending                  plates of 2 to 32 layers (some minutes)\n"
      "  sprung-calibrate stress-strain            stretches to 30 %, shear (minutes)\n"
      "  sprung-calibrate hold                     blocks held under load for 10 s (minutes)\n"
      "  sprung-calibrate --out results/calibration  leave the published table alone\n\n"
      "Exit codes: 0 done; 1 a test did not come to rest or a file cannot be written; 2 the "
      "command "
      "line is not understood."};
  Arguments a;
  a.command = "sprung-calibrate";
  // The folder says nothing about how a table came about.
  for (int k = 1; k < argc; ++k)
    if (std::string(argv[k]) == "--out")
      ++k;
    else if (!std::string(argv[k]).starts_with("--out="))
      a.command += std::string(" ") + argv[k];
  app.fallthrough();  // --out may stand behind a test's name
  app.add_option("--out", a.out, "folder of the tables")->capture_default_str();
  app.add_option("--area-stiffness", a.area_stiffness,
                 "measure only this row of the plane, isotropic bonds")
      ->check(CLI::Range(1.0, 1e4));
  app.add_option("--row", a.row, "measure only this row, such as 3,isotropic,300");
  app.add_flag("--resume", a.resume, "keep rows that this very program has measured already");
  app.add_option("--threads", a.threads, "threads; the bits do not depend on it")
      ->check(CLI::Range(1, 256));
  CLI::App& swept =
      *app.add_subcommand("sweep", "the paper's cube under +-0.01 MPa, k_e 0.05 to 3.1 MPa");
  swept.add_option("--layers", a.layers, "particles along an edge")->check(CLI::Range(8, 60));
  CLI::App& pulled = *app.add_subcommand("cube", "one corrected cube, for its error and its cost");
  pulled.add_option("--layers", a.layers, "particles along an edge")->check(CLI::Range(4, 60));
  pulled.add_option("--stress", a.stress, "nominal, over Young's modulus")
      ->check(CLI::Range(-0.1, 0.1));
  pulled.add_flag("--pressure", a.pressure, "volume by the pressure equation, not by springs");
  app.add_subcommand("poisson", "Poisson's ratio of the cube through the sweep's strains");
  app.add_subcommand("surface-layer", "volume and Poisson's ratio layer by layer below a face");
  app.add_subcommand("directions", "lambda against the direction of the load");
  app.add_subcommand("stress-strain", "springs against the neo-Hookean solid to 30 % and shear");
  CLI::App& held = *app.add_subcommand("hold", "Poisson's ratio and volume of blocks under load");
  held.add_flag("--resume", a.resume, "keep rows that this very program has measured already");
  held.add_option("--seconds", a.seconds, "how long")->check(CLI::Range(0.1, 100.0));
  CLI::App& plates =
      *app.add_subcommand("bending", "plates of few layers in stretching, bending and vibration");
  plates.add_flag("--resume", a.resume, "keep cases that this very program has measured already");
  return run_program(app, argc, argv, [&] {
    omp_set_num_threads(a.threads);
    if (app.got_subcommand("sweep")) return sweep(a);
    if (app.got_subcommand("cube")) return cube(a);
    if (app.got_subcommand("poisson")) return poisson(a);
    if (app.got_subcommand("surface-layer")) return surface_layer(a);
    if (app.got_subcommand("directions")) return directions(a);
    if (app.got_subcommand("bending")) return bending(a);
    if (app.got_subcommand("stress-strain")) return stress_strain(a);
    if (app.got_subcommand("hold")) return hold(a);
    return measure_table(a);
  });
}
