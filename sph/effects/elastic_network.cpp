#include "sph/effects/elastic_network.hpp"

#include "sph/effects/bond_weights.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace sprung::sph {

namespace {

/// Integer lattice coordinates relative to the body's first particle; ghosts included.
template <int dim>
using LatticePlaces = std::map<std::array<int, dim>, std::int32_t>;

template <int dim>
std::array<int, dim> lattice_place(const Vector<dim>& x, const Vector<dim>& origin,
                                   double spacing) {
  std::array<int, dim> place;
  for (int d = 0; d < dim; ++d)
    place[d] = static_cast<int>(std::lround((x[d] - origin[d]) / spacing));
  return place;
}

std::pair<int, int> axis_and_outward(Side side) {
  switch (side) {
    case Side::left:
      return {0, -1};
    case Side::right:
      return {0, 1};
    case Side::bottom:
      return {1, -1};
    case Side::top:
      return {1, 1};
    case Side::back:
      return {2, -1};
    case Side::front:
      return {2, 1};
  }
  return {0, 0};
}

}  // namespace

template <>
std::vector<BondShell<2>> bond_shells<2>(Bonds bonds) {
  const double diagonal = bonds == Bonds::equal ? 1.0 : 0.5;
  return {{{1, 0}, 1.0}, {{0, 1}, 1.0}, {{1, 1}, diagonal}, {{-1, 1}, diagonal}};
}

template <>
std::vector<BondShell<3>> bond_shells<3>(Bonds bonds) {
  std::vector<BondShell<3>> shells;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        const bool second_of_pair = k < 0 || (k == 0 && (j < 0 || (j == 0 && i <= 0)));
        const bool corner = i * i + j * j + k * k == 3;
        if (second_of_pair || (corner && bonds == Bonds::isotropic)) continue;
        shells.push_back({{i, j, k}, 1.0});
      }
  return shells;
}

template <int dim>
ElasticNetwork<dim> network_at_rest(const Particles<dim>& particles) {
  ElasticNetwork<dim> network;
  network.reference.assign(particles.position.begin(),
                           particles.position.begin() + particles.solids);
  network.movable = particles.solids;
  return network;
}

template <int dim>
void append_body(ElasticNetwork<dim>& network, const Particles<dim>& particles, std::size_t first,
                 std::size_t last, const Solid& solid, const Numerics& numerics,
                 const SpringStiffness& stiffness) {
  const double dx = particles.spacing;
  const Vector<dim> origin = particles.position[first];
  LatticePlaces<dim> places;
  for (std::size_t i = first; i < last; ++i) {
    places[lattice_place<dim>(particles.position[i], origin, dx)] = static_cast<std::int32_t>(i);
  }

  // ACTION 1: a solid particle closer than dx to its clamp is tied to ghosts beyond the wall.
  const LatticePlaces<dim> own = places;
  if (solid.clamped) {
    const auto [axis, outward] = axis_and_outward(*solid.clamped);
    const double plane = outward < 0 ? solid.body.from[axis] : solid.body.to[axis];
    for (const auto& [place, i] : own) {
      const double distance = std::abs(particles.position[i][axis] - plane);
      if (distance >= dx) continue;
      auto beyond = place;
      beyond[axis] += outward;
      if (places.contains(beyond)) continue;
      Vector<dim> x = particles.position[i];
      x[axis] += outward * dx;
      places[beyond] = static_cast<std::int32_t>(network.reference.size());
      network.reference.push_back(x);
    }
  }

  // ACTION 2: the springs, each pair once.
  const auto n = static_cast<std::int32_t>(network.movable);
  const double scale = stiffness.k_e * std::pow(dx, dim - 2);
  const std::size_t first_bond = network.bonds.size();
  std::vector<int> shell_of;
  const auto shells = bond_shells<dim>(numerics.bonds);
  for (const auto& [place, i] : places)
    for (std::size_t s = 0; s < shells.size(); ++s) {
      auto other = place;
      for (int d = 0; d < dim; ++d) other[d] += shells[s].offset[d];
      const auto j = places.find(other);
      if (j == places.end() || (i >= n && j->second >= n)) continue;
      const double length = (network.reference[i] - network.reference[j->second]).norm();
      network.bonds.push_back({i, j->second, length, scale * shells[s].weight});
      shell_of.push_back(static_cast<int>(s));
    }
  if (first_bond == network.bonds.size())
    throw std::invalid_argument("no springs: the body holds a single particle");

  if constexpr (dim == 2) {
    for (const auto& [place, i] : places) {
      const auto find = [&](int di, int dj) {
        const auto found = places.find({place[0] + di, place[1] + dj});
        return found == places.end() ? -1 : found->second;
      };
      const std::array<std::int32_t, 4> corner{i, find(1, 0), find(1, 1), find(0, 1)};
      if (*std::min_element(corner.begin(), corner.end()) < 0) continue;
      const auto ghosts =
          std::count_if(corner.begin(), corner.end(), [n](std::int32_t c) { return c >= n; });
      if (ghosts == 0) network.body_cells.push_back(corner);
      if (ghosts == 4 || numerics.area_stiffness == 0.0) continue;
      // Half of a cell at a clamp is material, and the same opening strains it twice as much.
      const double modulus = numerics.area_stiffness * stiffness.shear_modulus;
      network.cells.push_back({corner, dx * dx, ghosts > 0 ? 2.0 * modulus : modulus});
    }
    if (numerics.surface_correction) weigh_bonds(network, first_bond, first, last, solid, dx);
  }
}

double quadrilateral_area(const std::array<Vector<2>, 4>& x, std::array<Vector<2>, 4>& gradient) {
  // Shoelace formula: A = 1/2 (x2 - x0) x (x3 - x1).
  const Vector<2> p = x[2] - x[0], q = x[3] - x[1];
  gradient[0] = {-0.5 * q[1], 0.5 * q[0]};
  gradient[2] = {0.5 * q[1], -0.5 * q[0]};
  gradient[1] = {0.5 * p[1], -0.5 * p[0]};
  gradient[3] = {-0.5 * p[1], 0.5 * p[0]};
  return 0.5 * (p[0] * q[1] - p[1] * q[0]);
}

template <int dim>
void elastic_forces(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position,
                    std::vector<Vector<dim>>& force) {
  force.assign(network.reference.size(), Vector<dim>::Zero());
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network.movable ? position[node]
                                                            : network.reference[node];
  };
  for (const Bond& bond : network.bonds) {
    const Vector<dim> r = place(bond.a) - place(bond.b);
    const double length = r.norm();
    const Vector<dim> f = bond.stiffness * (bond.rest_length - length) / length * r;
    force[bond.a] += f;
    force[bond.b] -= f;
  }
  if constexpr (dim == 2)
    for (const AreaCell& cell : network.cells) {
      std::array<Vector<2>, 4> corner, gradient;
      for (int c = 0; c < 4; ++c) corner[c] = place(cell.corner[c]);
      const double area = quadrilateral_area(corner, gradient);
      const double pressure = -cell.modulus * (area / cell.rest_area - 1.0);
      for (int c = 0; c < 4; ++c) force[cell.corner[c]] += pressure * gradient[c];
    }
}

template <int dim>
double elastic_energy(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position) {
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network.movable ? position[node]
                                                            : network.reference[node];
  };
  double energy = 0.0;
  for (const Bond& bond : network.bonds) {
    const double extension = (place(bond.a) - place(bond.b)).norm() - bond.rest_length;
    energy += 0.5 * bond.stiffness * extension * extension;
  }
  if constexpr (dim == 2)
    for (const AreaCell& cell : network.cells) {
      std::array<Vector<2>, 4> corner, gradient;
      for (int c = 0; c < 4; ++c) corner[c] = place(cell.corner[c]);
      const double dilation = quadrilateral_area(corner, gradient) / cell.rest_area - 1.0;
      energy += 0.5 * cell.modulus * cell.rest_area * dilation * dilation;
    }
  return energy;
}

template <int dim>
std::pair<double, double> stretch_range(const ElasticNetwork<dim>& network,
                                        std::span<const Vector<dim>> position) {
  std::pair<double, double> range{1.0, 1.0};
  for (const Bond& bond : network.bonds) {
    const auto place = [&](std::int32_t node) -> const Vector<dim>& {
      return static_cast<std::size_t>(node) < network.movable ? position[node]
                                                              : network.reference[node];
    };
    const double stretch = (place(bond.a) - place(bond.b)).norm() / bond.rest_length;
    range.first = std::min(range.first, stretch);
    range.second = std::max(range.second, stretch);
  }
  return range;
}

template ElasticNetwork<2> network_at_rest<2>(const Particles<2>&);
template ElasticNetwork<3> network_at_rest<3>(const Particles<3>&);
template void append_body<2>(ElasticNetwork<2>&, const Particles<2>&, std::size_t, std::size_t,
                             const Solid&, const Numerics&, const SpringStiffness&);
template void append_body<3>(ElasticNetwork<3>&, const Particles<3>&, std::size_t, std::size_t,
                             const Solid&, const Numerics&, const SpringStiffness&);
template void elastic_forces<2>(const ElasticNetwork<2>&, std::span<const Vector<2>>,
                                std::vector<Vector<2>>&);
template void elastic_forces<3>(const ElasticNetwork<3>&, std::span<const Vector<3>>,
                                std::vector<Vector<3>>&);
template double elastic_energy<2>(const ElasticNetwork<2>&, std::span<const Vector<2>>);
template double elastic_energy<3>(const ElasticNetwork<3>&, std::span<const Vector<3>>);
template std::pair<double, double> stretch_range<2>(const ElasticNetwork<2>&,
                                                    std::span<const Vector<2>>);
template std::pair<double, double> stretch_range<3>(const ElasticNetwork<3>&,
                                                    std::span<const Vector<3>>);

}  // namespace sprung::sph
