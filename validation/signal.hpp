#pragma once
/// Quantities over time and how two of them differ: error norm, lag, amplitude, means over a
/// window.

#include <optional>
#include <span>
#include <vector>

namespace sprung {

/// Samples of one quantity at strictly ascending times.
class Signal {
 public:
  /// `time` in s, `value` in any unit, as many as times. Throws std::invalid_argument if there are
  /// fewer than two, if a time does not exceed the one before, or if a number is not finite.
  Signal(std::vector<double> time, std::vector<double> value);

  double begin() const { return time_.front(); }
  double end() const { return time_.back(); }
  std::span<const double> time() const { return time_; }
  std::span<const double> value() const { return value_; }
  /// Shortest step between samples (s).
  double shortest_step() const;
  /// Whether `t` lies within the samples, up to round-off of a time that was summed step by step.
  bool covers(double t) const;
  /// Value at `t` by cubic Hermite interpolation with three-point slopes (exact for parabolas).
  /// Throws std::out_of_range outside the samples.
  double at(double t) const;

 private:
  std::size_t interval_of(double t) const;
  std::vector<double> time_, value_, slope_;
};

/// Time mean and standard deviation over a window.
struct WindowMean {
  double mean = 0.0;
  double deviation = 0.0;
};

/// Time mean and standard deviation of `signal`, taken as straight between its samples, over [from,
/// to] (s). Throws std::out_of_range if the samples do not cover the window, std::invalid_argument
/// if it is empty.
WindowMean window_mean(const Signal& signal, double from, double to);

/// sqrt(integral |candidate - reference|^2 dt / integral |reference|^2 dt) over the common time,
/// with components summed; trapezoidal rule on the reference's samples. Both spans hold one signal
/// per component. Throws std::invalid_argument if there is no common time or the reference
/// vanishes.
double relative_l2(std::span<const Signal> reference, std::span<const Signal> candidate);

/// How to shift and scale the reference so that it lies on the candidate.
struct Alignment {
  double lag = 0.0;              ///< s; positive: the candidate is late
  double amplitude_ratio = 0.0;  ///< least-squares factor once the lag is taken out
  double correlation = 0.0;      ///< Pearson's, at that lag
};

/// Finds the lag that maximises Pearson's correlation of reference(t) and candidate(t + lag),
/// between the samples too (cubic interpolation, golden section), with |lag| <= `search` (s). The
/// window is the reference's, less `search` at either end, so that it is the same for every lag.
/// Nothing if the best lag stands at the edge of the search, or the common time or the reference's
/// variation is too small to tell.
std::optional<Alignment> align(const Signal& reference, const Signal& candidate, double search);

}  // namespace sprung
