#include "calibration/published.hpp"

#include "scene/atomic_file.hpp"
#include "scene/build.hpp"
#include "scene/manifest.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace sprung::calibration {

namespace {

using Json = nlohmann::ordered_json;

Json read_manifest(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) return Json::object();
  try {
    return Json::parse(in);
  } catch (const Json::exception&) {
    throw std::runtime_error(file.string() + ": is not JSON; remove it and calibrate again");
  }
}

}  // namespace

Sheet read_sheet(const std::filesystem::path& file) {
  Sheet sheet;
  std::ifstream in(file);
  std::getline(in, sheet.header);
  for (std::string line; std::getline(in, line);)
    if (!line.empty()) sheet.rows.push_back(line);
  return sheet;
}

Sheet read_sheet(const std::filesystem::path& file, const std::string& header) {
  Sheet sheet = read_sheet(file);
  return sheet.header == header ? sheet : Sheet{header, {}};
}

void publish(const std::filesystem::path& file, const Sheet& sheet, const Provenance& provenance) {
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  auto manifest_file = file;
  manifest_file.replace_extension(".json");
  const Json earlier = read_manifest(manifest_file);
  Json run;
  run["command"] = provenance.command;
  run["date_utc"] = utc_now();
  run["version"] = build::project_version;
  run["commit"] = build::commit;
  run["clean"] = build::clean;
  run["compiler"] = build::compiler;
  run["compiler_flags"] = build::compiler_flags;
  run["wall_seconds"] = provenance.seconds;
  run["peak_memory_bytes"] = peak_memory_bytes();
  Json manifest;
  manifest["format"] = "sprung calibration 1";
  manifest["table"] = file.filename().string();
  manifest["definition"] = provenance.definition;
  if (provenance.measured_rows.empty()) {
    manifest["run"] = run;
  } else {
    manifest["rows"] = earlier.value("rows", Json::object());
    for (const auto& key : provenance.measured_rows) manifest["rows"][key] = run;
    // A row that is no longer in the table has no provenance to keep.
    Json kept = Json::object();
    for (const auto& [key, value] : manifest["rows"].items())
      if (std::any_of(sheet.rows.begin(), sheet.rows.end(),
                      [&](const std::string& row) { return row.starts_with(key + ","); }))
        kept[key] = value;
    manifest["rows"] = kept;
  }
  std::string text = sheet.header + "\n";
  for (const auto& row : sheet.rows) text += row + "\n";
  write_text_file(file, text);
  write_text_file(manifest_file, manifest.dump(2) + "\n");
}

std::string key_of(const Material& material) {
  return fmt::format("{},{},{:g}", material.dimension, to_string(material.bonds),
                     material.area_stiffness);
}

bool row_is_current(const std::filesystem::path& file, const std::string& key) {
  auto manifest_file = file;
  manifest_file.replace_extension(".json");
  const Json rows = read_manifest(manifest_file).value("rows", Json::object());
  if (!rows.contains(key)) return false;
  const Json& row = rows[key];
  return row.value("clean", "no") == "yes" && row.value("commit", "") == build::commit &&
         row.value("compiler_flags", "") == build::compiler_flags;
}

std::string modulus_header() {
  return "dimension,bonds,area_stiffness,modulus_per_stiffness,uncertainty,fit_residual,"
         "lambda_inner_gauge,lambda_core_gauge,theory,poisson_ratio,strain,layers_from,layers_to,"
         "gauge,area,incompressibility";
}

std::string modulus_row(const BulkModulus& bulk) {
  return fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.5f},{:.3g},{},{},{},{},{}",
                     key_of(bulk.material), bulk.lambda, bulk.interval, bulk.residual,
                     bulk.lambda_inner, bulk.lambda_core, theoretical_lambda(bulk.material),
                     bulk.poisson_ratio, bulk.strain, bulk.fewest_layers, bulk.most_layers,
                     "end layers extrapolated in 1/n", "(n dx)^(dimension-1)",
                     bulk.material.area_stiffness > 0.0 ? "area springs" : "pressure equation");
}

std::string modulus_definition() {
  return "lambda = E/k_e for a pull along a lattice axis. Load: the same dead force on every "
         "particle of the "
         "two end layers. Stress: total load over (n dx)^(dimension-1). Strain: change of the "
         "distance between "
         "the centres of the end layers over (n-1) dx. Value: at 1/n = 0 of the quadratic in 1/n "
         "through "
         "blocks of n layers along each axis. In the plane E is the modulus of the incompressible "
         "solid in "
         "plane strain, stress/strain = 4E/3. uncertainty: half width of the fit's 95 % interval, "
         "or the "
         "distance to the value by another gauge (between the layers n/4 from the ends; gradient "
         "in the core) "
         "if that is larger. poisson_ratio: of the core of the largest block, as that of the "
         "isotropic solid "
         "(in the plane r/(1+r) of the ratio r of the strains). Without area springs: particle "
         "solver in "
         "vacuum, pressure equation with density feedback, damped to rest; with: network of "
         "springs alone.";
}

void replace_row(Sheet& sheet, const std::string& key, const std::string& row) {
  for (auto& present : sheet.rows)
    if (present.starts_with(key + ",")) {
      present = row;
      return;
    }
  sheet.rows.push_back(row);
}

std::string pull_header() {
  return "dimension,bonds,area_stiffness,layers,load,strain_ends,strain_inner,core_axial,core_"
         "lateral,"
         "lambda_ends,lambda_inner,lambda_core,unbalanced,steps";
}

std::string pull_row(const SizedPull& pull) {
  const PulledBlock& b = pull.block;
  return fmt::format("{},{},{:.6g},{:.8g},{:.8g},{:.8g},{:.8g},{:.6f},{:.6f},{:.6f},{:.2g},{}",
                     key_of(pull.material), pull.layers, pull.load, b.strain_ends, b.strain_inner,
                     b.core_axial, b.core_lateral, pull.lambda_ends, pull.lambda_inner,
                     pull.lambda_core, b.unbalanced, b.steps);
}

}  // namespace sprung::calibration
