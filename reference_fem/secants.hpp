#pragma once
/// Anderson's acceleration of an iteration x <- x + d(x): from the last corrections it learns how d
/// answers to x in the few directions that converge slowly. Here these are the bodies' motions,
/// whose effect on the moving mesh Newton's matrix leaves out. What was learned in one stage serves
/// in the next ones, as long as the matrix is the same (quasi-Newton with reuse: Degroote, Bathe
/// and Vierendeels 2009).

#include "scene/record.hpp"

#include <vector>

namespace sprung::reference {

class Secants {
 public:
  /// Replaces the correction d at x (both given as velocity and pressure parts) by the accelerated
  /// one. Norms are taken of the velocity part.
  void accelerate(const std::vector<double>& velocity, const std::vector<double>& pressure,
                  std::vector<double>& velocity_step, std::vector<double>& pressure_step);
  /// Another equation begins: keeps what was learned, but takes no difference to the last x.
  void begin_stage() { has_last_ = false; }
  /// Forgets everything: the matrix, and with it d, is another one.
  void clear();
  /// What was learned, oldest first, as arrays "secants/..." of a checkpoint.
  void save(Archive& archive) const;
  void restore(const Archive& archive);

 private:
  static constexpr std::size_t most = 12;
  struct Pair {
    std::vector<double> velocity, pressure;
  };
  void learn(const Pair& x, const Pair& d);
  void append_gram_row();
  std::vector<double> coefficients(const std::vector<double>& target) const;

  bool has_last_ = false;
  Pair last_x_, last_d_;
  std::vector<Pair> dx_, dd_;  ///< differences of x and of d between iterations, oldest first
  std::vector<std::vector<double>> gram_;  ///< inner products of dd_'s velocities, lower triangle
};

}  // namespace sprung::reference
