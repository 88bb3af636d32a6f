#pragma once
/// Hyperelastic materials in plane strain, split into a part that only the deformation gradient F
/// determines and a volumetric part that the pressure p carries:
///
///   W(F) = W_shape(F) + lambda/2 theta(F)^2,    P = dW_shape/dF - p dtheta/dF,    theta + p/lambda
///   = 0.
///
/// Both have the Lame constants G = E/(2(1+nu)) and lambda = 2 G nu/(1-2nu) of the
/// three-dimensional solid at small strain; neither locks, because theta is constrained only
/// against the pressure's few modes.

#include <array>
#include <cmath>

namespace sprung::reference {

/// 2 x 2 matrix, row by row.
using Matrix2 = std::array<double, 4>;
/// dP_iK / dF_jL at index ((i*2 + K)*2 + j)*2 + L.
using Tangent2 = std::array<double, 16>;

inline double determinant(const Matrix2& f) {
  return f[0] * f[3] - f[1] * f[2];
}
/// det(F) F^-T, linear in F in two dimensions.
inline Matrix2 cofactor(const Matrix2& f) {
  return {f[3], -f[2], -f[1], f[0]};
}

enum class MaterialLaw { neo_hookean, st_venant_kirchhoff };

struct Material {
  MaterialLaw law = MaterialLaw::neo_hookean;
  double shear_modulus = 0.0;  ///< Pa
  double lame = 0.0;           ///< Pa, infinity if incompressible
  double density = 0.0;        ///< kg/m3

  static Material from_youngs(MaterialLaw law, double youngs_modulus, double poisson_ratio,
                              double density) {
    const double shear = youngs_modulus / (2.0 * (1.0 + poisson_ratio));
    return {law, shear, 2.0 * shear * poisson_ratio / (1.0 - 2.0 * poisson_ratio), density};
  }

  /// theta(F): J - 1 (neo-Hookean) or tr E (St. Venant-Kirchhoff).
  double volume_strain(const Matrix2& f) const {
    if (law == MaterialLaw::neo_hookean) return determinant(f) - 1.0;
    return 0.5 * (f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3]) - 1.0;
  }
  /// dtheta/dF: cof F or F.
  Matrix2 volume_gradient(const Matrix2& f) const {
    return law == MaterialLaw::neo_hookean ? cofactor(f) : f;
  }
  /// W_shape (Pa): G/2 (tr C - 3 - 2 ln J), or G E:E.
  double shape_energy(const Matrix2& f) const;
  /// dW_shape/dF (Pa): G (F - F^-T), or 2 G F E.
  Matrix2 shape_stress(const Matrix2& f) const;
  /// d(shape_stress - p volume_gradient)/dF (Pa).
  Tangent2 tangent(const Matrix2& f, double pressure) const;
};

inline Matrix2 green_strain(const Matrix2& f) {
  return {0.5 * (f[0] * f[0] + f[2] * f[2] - 1.0), 0.5 * (f[0] * f[1] + f[2] * f[3]),
          0.5 * (f[0] * f[1] + f[2] * f[3]), 0.5 * (f[1] * f[1] + f[3] * f[3] - 1.0)};
}

inline double Material::shape_energy(const Matrix2& f) const {
  if (law == MaterialLaw::neo_hookean) {
    const double trace = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3];
    return 0.5 * shear_modulus * (trace - 2.0 - 2.0 * std::log(determinant(f)));
  }
  const Matrix2 e = green_strain(f);
  return shear_modulus * (e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3]);
}

inline Matrix2 Material::shape_stress(const Matrix2& f) const {
  Matrix2 p{};
  if (law == MaterialLaw::neo_hookean) {
    const Matrix2 cof = cofactor(f);
    const double inverse_j = 1.0 / determinant(f);
    for (std::size_t i = 0; i < 4; ++i) p[i] = shear_modulus * (f[i] - inverse_j * cof[i]);
    return p;
  }
  const Matrix2 e = green_strain(f);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 2; ++k)
      p[2 * i + k] = 2.0 * shear_modulus * (f[2 * i] * e[k] + f[2 * i + 1] * e[2 + k]);
  return p;
}

inline Tangent2 Material::tangent(const Matrix2& f, double pressure) const {
  Tangent2 t{};
  const auto at = [&t](std::size_t i, std::size_t k, std::size_t j, std::size_t l) -> double& {
    return t[((i * 2 + k) * 2 + j) * 2 + l];
  };
  if (law == MaterialLaw::neo_hookean) {
    const Matrix2 cof = cofactor(f);
    const double inverse_j = 1.0 / determinant(f);
    // d(F^-T)_iK/dF_jL = -F^-T_iL F^-T_jK, and d(cof F)_iK/dF_jL = eps_ij eps_KL.
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t j = 0; j < 2; ++j)
          for (std::size_t l = 0; l < 2; ++l) {
            const double identity = (i == j && k == l) ? 1.0 : 0.0;
            const double volume = (i != j && k != l) ? ((i == k) ? 1.0 : -1.0) : 0.0;
            at(i, k, j, l) = shear_modulus * (identity + inverse_j * inverse_j * cof[2 * i + l] *
                                                             cof[2 * j + k]) -
                             pressure * volume;
          }
    return t;
  }
  const Matrix2 e = green_strain(f);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t j = 0; j < 2; ++j)
        for (std::size_t l = 0; l < 2; ++l) {
          // F_iM E_MK: dF gives delta_ij E_LK, dE_MK = (delta_ML F_jK + F_jM delta_KL)/2.
          double value = (i == j) ? e[2 * l + k] : 0.0;
          value += 0.5 * f[2 * i + l] * f[2 * j + k];
          if (k == l) value += 0.5 * (f[2 * i] * f[2 * j] + f[2 * i + 1] * f[2 * j + 1]);
          at(i, k, j, l) = 2.0 * shear_modulus * value;
          if (i == j && k == l) at(i, k, j, l) -= pressure;
        }
  return t;
}

}  // namespace sprung::reference
