#include "calibration/specimen.hpp"

#include <cmath>

namespace sprung::calibration {

const char* to_string(sph::Bonds bonds) {
  return bonds == sph::Bonds::equal ? "equal" : "isotropic";
}

namespace {

template <int dim>
sph::Particles<dim> at_rest(const std::vector<Vector<dim>>& places, double spacing) {
  sph::Particles<dim> particles;
  particles.spacing = spacing;
  particles.volume = std::pow(spacing, dim);
  particles.density = density;
  for (const auto& x : places) particles.add(x, Vector<dim>::Zero(), 0.0, sph::Role::solid);
  particles.solids = particles.unknowns = places.size();
  return particles;
}

}  // namespace

template <int dim>
sph::Particles<dim> fitted(const Solid& shape, double spacing) {
  return at_rest<dim>(sph::fitted_places<dim>(shape, spacing), spacing);
}

template <int dim>
sph::Particles<dim> block(const std::array<int, dim>& count, double spacing) {
  std::size_t total = 1;
  for (const int n : count) total *= static_cast<std::size_t>(n);
  std::vector<Vector<dim>> places(total);
  for (std::size_t i = 0; i < total; ++i) {
    const auto place = lattice_place<dim>(i, count);
    for (int d = 0; d < dim; ++d) places[i][d] = (place[d] + 0.5) * spacing;
  }
  return at_rest<dim>(places, spacing);
}

template <int dim>
Solid shape_of(const std::array<int, dim>& count, double spacing) {
  Solid shape;
  shape.name = "specimen";
  for (int d = 0; d < dim; ++d) shape.body.to[d] = count[d] * spacing;
  return shape;
}

template <int dim>
sph::ElasticNetwork<dim> network_of(const sph::Particles<dim>& particles, const Solid& shape,
                                    const Material& material, bool surface_correction) {
  sph::Numerics numerics;
  numerics.bonds = material.bonds;
  numerics.area_stiffness = material.area_stiffness;
  numerics.surface_correction = surface_correction;
  numerics.fitted_bodies = true;
  auto network = sph::network_at_rest(particles);
  const double shear = sph::network_shear_modulus<dim>(spring_stiffness, material.bonds);
  sph::append_body(network, particles, 0, particles.solids, shape, numerics,
                   {spring_stiffness, shear});
  return network;
}

template sph::Particles<2> block<2>(const std::array<int, 2>&, double);
template sph::Particles<3> block<3>(const std::array<int, 3>&, double);
template sph::Particles<2> fitted<2>(const Solid&, double);
template sph::Particles<3> fitted<3>(const Solid&, double);
template Solid shape_of<2>(const std::array<int, 2>&, double);
template Solid shape_of<3>(const std::array<int, 3>&, double);
template sph::ElasticNetwork<2> network_of<2>(const sph::Particles<2>&, const Solid&,
                                              const Material&, bool);
template sph::ElasticNetwork<3> network_of<3>(const sph::Particles<3>&, const Solid&,
                                              const Material&, bool);

}  // namespace sprung::calibration
