#pragma once
/// Blocks of particles and networks that the tests of the particle solver share.

#include "sph/boundary/images.hpp"
#include "sph/effects/elastic_network.hpp"
#include "sph/numerics.hpp"

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

namespace sprung::sph::test {

inline Numerics preset(const std::string& name) {
  Document document = Document::from_text("[numerics]\npreset = \"" + name + "\"\n");
  return read_numerics(document);
}

/// Cell centres of a lattice of `count` cells, moved at random by up to `jitter` x spacing each
/// way.
template <int dim>
std::vector<Vector<dim>> lattice(const std::array<int, dim>& count, double spacing,
                                 double jitter = 0.0, unsigned seed = 1) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> offset(-jitter, jitter);
  std::vector<Vector<dim>> points;
  std::array<int, dim> at{};
  while (true) {
    Vector<dim> x;
    for (int d = 0; d < dim; ++d) x[d] = (at[d] + 0.5 + offset(generator)) * spacing;
    points.push_back(x);
    int d = 0;
    while (d < dim && ++at[d] == count[d]) at[d++] = 0;
    if (d == dim) return points;
  }
}

/// Particles of one role at `points`, at rest.
template <int dim>
Particles<dim> particles_at(const std::vector<Vector<dim>>& points, double spacing,
                            Role role = Role::fluid, double density = 1000.0) {
  Particles<dim> particles;
  particles.spacing = spacing;
  particles.volume = std::pow(spacing, dim);
  particles.density = density;
  for (const auto& x : points) particles.add(x, Vector<dim>::Zero(), 0.0, role);
  particles.unknowns = points.size();
  particles.solids = role == Role::solid ? points.size() : 0;
  return particles;
}

/// A body that fills `count` cells from the origin.
template <int dim>
Solid solid_block(const std::array<int, dim>& count, double spacing,
                  std::optional<Side> clamped = {}) {
  Solid solid;
  solid.name = "block";
  for (int d = 0; d < dim; ++d) solid.body.to[d] = count[d] * spacing;
  solid.clamped = clamped;
  return solid;
}

/// The network of a block on the lattice, at rest.
template <int dim>
ElasticNetwork<dim> network_of(const Particles<dim>& particles, const std::array<int, dim>& count,
                               const Numerics& numerics, double k_e,
                               std::optional<Side> clamped = {}) {
  auto network = network_at_rest(particles);
  append_body<dim>(network, particles, 0, particles.solids,
                   solid_block<dim>(count, particles.spacing, clamped), numerics,
                   {k_e, network_shear_modulus<dim>(k_e, numerics.bonds)});
  return network;
}

/// The walls of a box from the origin, all of one kind.
template <int dim>
std::vector<Wall<dim>> walls_of_box(const Vector<dim>& extent, bool no_slip) {
  std::vector<Wall<dim>> walls;
  for (int d = 0; d < dim; ++d) {
    walls.push_back({d, 0.0, 1, no_slip, Vector<dim>::Zero()});
    walls.push_back({d, extent[d], -1, no_slip, Vector<dim>::Zero()});
  }
  return walls;
}

}  // namespace sprung::sph::test
