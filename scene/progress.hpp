#pragma once
/// Progress with the time left, on standard error: one line that renews itself on a terminal, a
/// line every ten seconds elsewhere. Runs of less than three seconds say nothing.

#include <chrono>
#include <string>

namespace sprung {

class Progress {
 public:
  /// `what` stands at the line's start; `total` is where `advance` will end (simulated seconds,
  /// say), `start` where it begins (not 0 after a resume).
  Progress(std::string what, double total, double start = 0.0);
  ~Progress();
  /// Tells how far the run is, with an optional remark ("dt 1.0 ms, 14 iterations").
  void advance(double done, const std::string& remark = "");

 private:
  void print(double done, const std::string& remark, bool last);
  std::string what_;
  double total_;
  double start_;
  double done_;
  std::chrono::steady_clock::time_point began_;
  std::chrono::steady_clock::time_point printed_;
  bool terminal_;
};

/// Processor seconds of this process so far, all threads.
double processor_seconds();
/// Wall seconds of this process so far.
double wall_seconds();

}  // namespace sprung
