#pragma once
/// A factor that depends on time: from a formula in t (s), or from a file of samples.

#include "scene/formula.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace sprung {

class Waveform {
 public:
  /// One at all times.
  Waveform() = default;
  /// Throws FormulaError when the formula cannot be read or is not finite at t = 0.
  static Waveform from_formula(const std::string& text);
  /// Two columns, time in s (ascending) and factor, under a header line; separated by commas or
  /// blanks. Linear between the samples, constant before the first and after the last. Throws
  /// std::runtime_error that names file and line.
  static Waveform from_file(const std::filesystem::path& file);

  /// Throws std::runtime_error where the formula is not finite.
  double value(double time) const;
  bool constant() const { return !formula_ && times_.empty(); }

 private:
  std::optional<Formula> formula_;
  std::vector<double> times_, factors_;
};

}  // namespace sprung
