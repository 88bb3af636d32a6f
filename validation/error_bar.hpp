#pragma once
/// The reference's own error, as its convergence run left it in error_bar.json beside its record.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sprung {

/// What one quantity of the reference is worth. A quantity is named "<series or table>.<column>":
/// "tip.displacement_x", "profile.velocity_x" (largest error along the line), "force.force_x".
struct ReferenceError {
  std::string quantity;
  double time = 0.0;                     ///< s
  double error = 0.0;                    ///< in the column's unit: half-width of the error bar
  std::optional<double> extrapolated;    ///< value at vanishing mesh size and step
  std::optional<double> observed_order;  ///< in mesh size
};

/// error_bar.json: { "quantities": [ { "name": "tip.displacement_x", "time": 0.2, "error": 1e-5,
/// "extrapolated": 0.0123, "observed_order": 2.1, ... }, ... ] }; further keys are left alone.
class ErrorBar {
 public:
  ErrorBar() = default;
  /// Throws std::runtime_error naming the file if it cannot be read, an entry lacks name, time or
  /// error, or an error is negative or not finite.
  explicit ErrorBar(const std::filesystem::path& file);

  bool empty() const { return entries_.empty(); }
  const std::vector<ReferenceError>& entries() const { return entries_; }
  /// Half-width at `time` (s, within 1 us), if it was measured.
  std::optional<double> at(const std::string& quantity, double time) const;

 private:
  std::vector<ReferenceError> entries_;
};

}  // namespace sprung
