#pragma once
/// What the calibration publishes: tables as CSV, each with a manifest of the same name in JSON.

#include "calibration/bulk_modulus.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace sprung::calibration {

/// How a table came about; written beside it as <name>.json with commit, compiler, date and cost.
struct Provenance {
  std::string command;     ///< as typed, program name without folder
  std::string definition;  ///< what load, gauge and area are
  double seconds = 0.0;    ///< wall time of the measurement
  std::vector<std::string>
      measured_rows;  ///< keys of the rows of this run; others were there before
};

/// Rows of text below a header, as they stand in the file.
struct Sheet {
  std::string header;
  std::vector<std::string> rows;
};

/// Reads a CSV written by publish(); an absent file is an empty sheet.
Sheet read_sheet(const std::filesystem::path& file);
/// The same where its columns are those of `header`; else no row under that header.
Sheet read_sheet(const std::filesystem::path& file, const std::string& header);

/// Writes `file` and its manifest, each beside its place and then renamed. The manifest keeps the
/// provenance of the rows that it already knew. Throws std::runtime_error naming the file.
void publish(const std::filesystem::path& file, const Sheet& sheet, const Provenance& provenance);

/// "2,isotropic,300": the first three columns, by which a row is known.
std::string key_of(const Material& material);

/// Whether the manifest of the table `file` says that this very program, from a clean commit,
/// measured the row.
bool row_is_current(const std::filesystem::path& file, const std::string& key);

/// Header and row of modulus_per_stiffness.csv, the only table that other folders read.
std::string modulus_header();
std::string modulus_row(const BulkModulus& bulk);
/// Load, gauge and area of that table in words.
std::string modulus_definition();

/// Puts `row` in the place of the row of the same key, or at the end.
void replace_row(Sheet& sheet, const std::string& key, const std::string& row);

/// Header and row of pulls.csv: every block behind the table.
std::string pull_header();
std::string pull_row(const SizedPull& pull);

}  // namespace sprung::calibration
