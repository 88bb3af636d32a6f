#pragma once
/// Diagonally implicit Runge-Kutta schemes, stiffly accurate: the last stage is the new state, so
/// the incompressibility constraint holds exactly at the end of every step.

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace sprung::reference {

/// Stage i sits at time t + c[i] dt; row i of `a` weighs the slopes. A scheme whose first stage is
/// explicit takes its first slope from the end of the step before.
struct TimeScheme {
  std::string name;
  bool explicit_first = false;
  std::vector<std::vector<double>> a;
  std::vector<double> c;
  std::vector<double> embedded;  ///< weights of the embedded formula, empty if there is none
  double gamma = 0.0;            ///< the diagonal, the same in all implicit stages
  int order = 2;
};

/// TR-BDF2 (Bank et al. 1985, in the form of Hosea and Shampine 1996): a trapezoidal stage to t +
/// (2-sqrt 2) dt, then BDF2. Second order, L-stable, stage order 2, so the pressure keeps second
/// order too.
inline TimeScheme tr_bdf2() {
  const double d = 1.0 - std::sqrt(0.5), w = std::sqrt(2.0) / 4.0;
  return {"tr_bdf2",
          true,
          {{0.0, 0.0, 0.0}, {d, d, 0.0}, {w, w, d}},
          {0.0, 2.0 * d, 1.0},
          {(1.0 - w) / 3.0, (3.0 * w + 1.0) / 3.0, d / 3.0},
          d,
          2};
}

/// Alexander's two-stage SDIRK (1977): second order, L-stable, and needs no slope at the start, so
/// it is the step to take after a kink. Its diagonal is that of TR-BDF2: the same matrix serves
/// both.
inline TimeScheme sdirk2() {
  const double d = 1.0 - std::sqrt(0.5);
  return {"sdirk2", false, {{d, 0.0}, {1.0 - d, d}}, {d, 1.0}, {}, d, 2};
}

/// ARK3(2)4L[2]SA, implicit part (Kennedy and Carpenter 2003): third order, L-stable, stage
/// order 2.
inline TimeScheme esdirk3() {
  const double g = 1767732205903.0 / 4055673282236.0;
  return {"esdirk3",
          true,
          {{0.0, 0.0, 0.0, 0.0},
           {g, g, 0.0, 0.0},
           {2746238789719.0 / 10658868560708.0, -640167445237.0 / 6845629431997.0, g, 0.0},
           {1471266399579.0 / 7840856788654.0, -4482444167858.0 / 7529755066697.0,
            11266239266428.0 / 11593286722821.0, g}},
          {0.0, 2.0 * g, 0.6, 1.0},
          {2756255671327.0 / 12835298489170.0, -10771552573575.0 / 22201958757719.0,
           9247589265047.0 / 10645013368117.0, 2193209047091.0 / 5459859503100.0},
          g,
          3};
}

/// Alexander's three-stage SDIRK (1977): third order, L-stable, diagonal of esdirk3.
inline TimeScheme sdirk3() {
  const double g = 1767732205903.0 / 4055673282236.0;
  const double b1 = -(6.0 * g * g - 16.0 * g + 1.0) / 4.0,
               b2 = (6.0 * g * g - 20.0 * g + 5.0) / 4.0;
  return {"sdirk3",
          false,
          {{g, 0.0, 0.0}, {(1.0 - g) / 2.0, g, 0.0}, {b1, b2, g}},
          {g, (1.0 + g) / 2.0, 1.0},
          {},
          g,
          3};
}

/// Backward Euler: first order, strongly damped; for steady states.
inline TimeScheme backward_euler() {
  return {"backward_euler", false, {{1.0}}, {1.0}, {}, 1.0, 1};
}

}  // namespace sprung::reference
