#include "calibration/finite_strain.hpp"

#include "calibration/lattice_modulus.hpp"

#include <cmath>

namespace sprung::calibration {

namespace {

template <int dim>
Eigen::Matrix<double, dim, dim> gradient(Deformation deformation, double s) {
  Eigen::Matrix<double, dim, dim> f = Eigen::Matrix<double, dim, dim>::Identity();
  if (deformation == Deformation::simple_shear) {
    f(0, 1) = s;
  } else if (dim == 2) {
    f.diagonal() << s, 1.0 / s;
  } else if constexpr (dim == 3) {
    switch (deformation) {
      case Deformation::uniaxial:
        f.diagonal() << s, 1.0 / std::sqrt(s), 1.0 / std::sqrt(s);
        break;
      case Deformation::equibiaxial:
        f.diagonal() << s, s, 1.0 / (s * s);
        break;
      default:
        f.diagonal() << s, 1.0, 1.0 / s;
    }
  }
  return f - Eigen::Matrix<double, dim, dim>::Identity();
}

template <int dim>
double slope_of_energy(const Material& material, Deformation deformation, double s) {
  const BulkLattice<dim> lattice(material);
  constexpr double step = 1e-5;
  return (lattice.energy_density(gradient<dim>(deformation, s + step)) -
          lattice.energy_density(gradient<dim>(deformation, s - step))) /
         (2.0 * step);
}

}  // namespace

const char* to_string(Deformation deformation) {
  switch (deformation) {
    case Deformation::uniaxial:
      return "uniaxial";
    case Deformation::equibiaxial:
      return "equibiaxial";
    case Deformation::pure_shear:
      return "pure_shear";
    case Deformation::simple_shear:
      return "simple_shear";
  }
  return "";
}

double lattice_stress(const Material& material, Deformation deformation, double s) {
  const double slope = material.dimension == 2 ? slope_of_energy<2>(material, deformation, s)
                                               : slope_of_energy<3>(material, deformation, s);
  // Two axes are loaded alike.
  return deformation == Deformation::equibiaxial ? 0.5 * slope : slope;
}

double neo_hookean_stress(int dimension, double g, Deformation deformation, double s) {
  if (deformation == Deformation::simple_shear) return g * s;
  if (dimension == 2 || deformation == Deformation::pure_shear) return g * (s - std::pow(s, -3));
  return deformation == Deformation::uniaxial ? g * (s - std::pow(s, -2))
                                              : g * (s - std::pow(s, -5));
}

}  // namespace sprung::calibration
