/// Materials: tangents against differences, homogeneous tension against closed forms.

#include "body_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sprung::reference {
namespace {

constexpr Matrix2 some_f = {1.21, -0.13, 0.27, 0.92};

Matrix2 stress(const Material& m, const Matrix2& f, double p) {
  Matrix2 result = m.shape_stress(f);
  const Matrix2 h = m.volume_gradient(f);
  for (std::size_t i = 0; i < 4; ++i) result[i] -= p * h[i];
  return result;
}

class EachLaw : public ::testing::TestWithParam<MaterialLaw> {};

TEST_P(EachLaw, StressIsTheDerivativeOfTheEnergy) {
  const Material m = Material::from_youngs(GetParam(), 0.7e6, 0.4, 1000.0);
  const Matrix2 shape = m.shape_stress(some_f), h = m.volume_gradient(some_f);
  // Central differences of step 1e-6: truncation 1e-12, rounding 1e-10 of the modulus.
  const double d = 1e-6;
  for (std::size_t i = 0; i < 4; ++i) {
    Matrix2 plus = some_f, minus = some_f;
    plus[i] += d, minus[i] -= d;
    EXPECT_NEAR((m.shape_energy(plus) - m.shape_energy(minus)) / (2 * d), shape[i], 1e-8 * 0.7e6);
    EXPECT_NEAR((m.volume_strain(plus) - m.volume_strain(minus)) / (2 * d), h[i], 1e-8);
  }
}

TEST_P(EachLaw, TangentIsTheDerivativeOfTheStress) {
  const Material m = Material::from_youngs(GetParam(), 0.7e6, 0.4, 1000.0);
  const double p = 3.1e4, d = 1e-6;
  const Tangent2 tangent = m.tangent(some_f, p);
  for (std::size_t jl = 0; jl < 4; ++jl) {
    Matrix2 plus = some_f, minus = some_f;
    plus[jl] += d, minus[jl] -= d;
    const Matrix2 a = stress(m, plus, p), b = stress(m, minus, p);
    for (std::size_t ik = 0; ik < 4; ++ik)
      EXPECT_NEAR((a[ik] - b[ik]) / (2 * d), tangent[ik * 4 + jl], 1e-8 * 0.7e6) << ik << " " << jl;
  }
}

INSTANTIATE_TEST_SUITE_P(Laws, EachLaw,
                         ::testing::Values(MaterialLaw::neo_hookean,
                                           MaterialLaw::st_venant_kirchhoff));

/// A square on rollers at its left and bottom sides, pulled at the right: homogeneous.
double stretch_under(const Material& material, double traction) {
  Problem problem = testing::body_problem(0.1, 0.1, 0.7e6);
  problem.walls = Walls{{}, {Side::left, Side::bottom}};
  testing::Body body(problem, testing::sizes_of(0.05, 0.05, 0.05, 0), material);
  const auto load = traction_load(*body.space, Side::right, {traction, 0.0});
  const StaticSolution solution = solve_static(*body.system, load, 4, 1e-12);
  return 1.0 + body.displacement_at(solution.fields, {0.1, 0.05})[0] / 0.1;
}

TEST(HomogeneousTension, IncompressibleNeoHookean) {
  // Plane strain, stretch s against 1/s: nominal stress G (s - s^-3), from W = G/2 (s^2 + s^-2 -
  // 2).
  const double shear = 0.7e6 / 3.0, s = 1.4;
  const Material m = Material::from_youngs(MaterialLaw::neo_hookean, 0.7e6, 0.5, 1000.0);
  EXPECT_TRUE(std::isinf(m.lame));
  // 1e-6 is issue 5's figure for tension against the closed form.
  EXPECT_NEAR(stretch_under(m, shear * (s - std::pow(s, -3))), s, 1e-6);
}

TEST(HomogeneousTension, CompressibleStVenantKirchhoff) {
  // Plane strain with a free transverse side: S_yy = 0 gives E_yy = -lambda/(lambda + 2G) E_xx, and
  // the nominal stress is s S_xx = s 4G(lambda + G)/(lambda + 2G) E_xx.
  const Material m = Material::from_youngs(MaterialLaw::st_venant_kirchhoff, 0.7e6, 0.4, 1000.0);
  const double g = m.shear_modulus, l = m.lame, s = 1.2, e = 0.5 * (s * s - 1.0);
  EXPECT_NEAR(stretch_under(m, s * 4.0 * g * (l + g) / (l + 2.0 * g) * e), s, 1e-6);
}

}  // namespace
}  // namespace sprung::reference
