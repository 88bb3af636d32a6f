#pragma once
/// Anderson's acceleration of an iteration x <- x + d(x): from the last corrections it learns how d
/// answers to x in the few directions that converge slowly. Here these are the bodies' motions,
/// whose effect on the moving mesh Newton's matrix leaves out.

#include <vector>

namespace sprung::reference {

class Secants {
 public:
  /// Replaces the correction d at x (both given as velocity and pressure parts) by the accelerated
  /// one. Norms are taken of the velocity part.
  void accelerate(const std::vector<double>& velocity, const std::vector<double>& pressure,
                  std::vector<double>& velocity_step, std::vector<double>& pressure_step);
  void clear();

 private:
  static constexpr std::size_t most = 6;
  struct Pair {
    std::vector<double> velocity, pressure;
  };
  bool has_last_ = false;
  Pair last_x_, last_d_;
  std::vector<Pair> dx_, dd_;  ///< differences of x and of d between iterations, oldest first
};

}  // namespace sprung::reference
