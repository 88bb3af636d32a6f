#include "sph/effects/elastic_network.hpp"

#include "scene/body_shape.hpp"
#include "sph/effects/bond_weights.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sprung::sph {

namespace {

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
  network.volume.assign(particles.solids, particles.volume);
  return network;
}

namespace {

template <int dim>
Point as_point(const Vector<dim>& x) {
  Point point{};
  for (int d = 0; d < dim; ++d) point[d] = x[d];
  return point;
}

/// Number of cells that fit along each own axis of a body, and their size.
template <int dim>
std::array<long, dim> fitted_count(const Solid& solid, double spacing) {
  const Point extent = own_extent(solid);
  std::array<long, dim> count;
  for (int d = 0; d < dim; ++d) count[d] = std::max(1L, std::lround(extent[d] / spacing));
  return count;
}

template <int dim>
Vector<dim> pitch_of(const Solid& solid, double spacing, bool fitted) {
  Vector<dim> pitch = Vector<dim>::Constant(spacing);
  if (!fitted && !is_oblique(solid)) return pitch;
  const auto count = fitted_count<dim>(solid, spacing);
  for (int d = 0; d < dim; ++d) {
    const double fit = own_extent(solid)[d] / static_cast<double>(count[d]);
    if (std::abs(fit - spacing) > 1e-9 * spacing) pitch[d] = fit;
  }
  return pitch;
}

/// Places of the particles `first` to `last`, from their own coordinates.
template <int dim>
BodyLattice<dim> lay_out(const Particles<dim>& particles, std::size_t first, std::size_t last,
                         const Solid& solid, const Vector<dim>& pitch) {
  BodyLattice<dim> lattice;
  const Point extent = own_extent(solid);
  const auto own = [&](std::size_t i) {
    return as_vector<dim>(to_own(solid, as_point<dim>(particles.position[i])));
  };
  const Vector<dim> origin = own(first);
  lattice.cell_volume.assign(particles.solids, 0.0);
  for (std::size_t i = first; i < last; ++i) {
    const Vector<dim> x = own(i);
    typename BodyLattice<dim>::Place place;
    for (int d = 0; d < dim; ++d) {
      place[d] = static_cast<int>(std::lround((x[d] - origin[d]) / pitch[d]));
      lattice.lowest[d] = i == first ? place[d] : std::min(lattice.lowest[d], place[d]);
      lattice.highest[d] = i == first ? place[d] : std::max(lattice.highest[d], place[d]);
    }
    lattice.node[place] = static_cast<std::int32_t>(i);
    lattice.cell_volume[i] = pitch.prod() * own_stretch(solid, as_point<dim>(x));
  }
  for (int d = 0; d < dim; ++d) {
    lattice.low_face[d] = -origin[d] / pitch[d];
    lattice.high_face[d] = (extent[d] - origin[d]) / pitch[d];
    lattice.free[2 * d] = lattice.free[2 * d + 1] = true;
  }
  if (solid.clamped) lattice.free[static_cast<int>(*solid.clamped)] = false;
  return lattice;
}

/// ACTION 1: a solid particle closer than a pitch to its clamp is tied to a ghost beyond it.
template <int dim>
void add_ghosts(ElasticNetwork<dim>& network, BodyLattice<dim>& lattice, const Solid& solid,
                const Vector<dim>& pitch) {
  if (!solid.clamped) return;
  const auto [axis, outward] = axis_and_outward(*solid.clamped);
  const Point extent = own_extent(solid);
  const double plane = outward < 0 ? 0.0 : extent[axis];
  const auto own_nodes = lattice.node;
  for (const auto& [place, i] : own_nodes) {
    Point own = to_own(solid, as_point<dim>(network.reference[i]));
    if (std::abs(own[axis] - plane) >= pitch[axis]) continue;
    auto beyond = place;
    beyond[axis] += outward;
    if (lattice.node.contains(beyond)) continue;
    own[axis] += outward * pitch[axis];
    lattice.node[beyond] = static_cast<std::int32_t>(network.reference.size());
    network.reference.push_back(as_vector<dim>(from_own(solid, own)));
  }
}

/// ACTION 2: the springs, each pair once. Stored energy per strain squared is that of the bond on
/// the cubic lattice, k_e V (length in places)^2, whatever the cell has been fitted to.
template <int dim>
void add_bonds(ElasticNetwork<dim>& network, const BodyLattice<dim>& lattice, Bonds bonds,
               double k_e, double spacing) {
  const auto n = static_cast<std::int32_t>(network.movable);
  const auto shells = bond_shells<dim>(bonds);
  for (const auto& [place, i] : lattice.node)
    for (const auto& shell : shells) {
      auto other = place;
      double places2 = 0.0;
      for (int d = 0; d < dim; ++d) {
        other[d] += shell.offset[d];
        places2 += shell.offset[d] * shell.offset[d];
      }
      const std::int32_t j = lattice.find(other);
      if (j < 0 || (i >= n && j >= n)) continue;
      double volume = 0.0;
      for (const std::int32_t node : {i, j})
        volume += 0.5 * lattice.cell_volume[node < n ? node : std::min(i, j)];
      const double length = (network.reference[i] - network.reference[j]).norm();
      const double cubic = std::pow(spacing, dim - 2);
      double fitted = volume * places2 / (length * length * cubic);
      if (std::abs(fitted - 1.0) < 1e-9) fitted = 1.0;  // rounding of places on the cubic lattice
      network.bonds.push_back({i, j, length, k_e * cubic * shell.weight * fitted});
      network.bulk_stiffness.push_back(network.bonds.back().stiffness);
    }
}

/// The place on the clamp below each ghost, as a fixed node of its own: a cell at the clamp ends
/// there. With the ghosts as corners a section that narrows above the clamp would have to lengthen
/// twice as much as the half cell does, and the body would turn in its clamp.
template <int dim>
std::map<std::int32_t, std::int32_t> add_clamp_nodes(ElasticNetwork<dim>& network,
                                                     const BodyLattice<dim>& lattice,
                                                     const Solid& solid) {
  std::map<std::int32_t, std::int32_t> below;
  if (!solid.clamped) return below;
  const auto [axis, outward] = axis_and_outward(*solid.clamped);
  const auto n = static_cast<std::int32_t>(network.movable);
  for (const auto& [place, node] : lattice.node) {
    if (node < n) continue;
    Point own = to_own(solid, as_point<dim>(network.reference[node]));
    own[axis] = outward < 0 ? 0.0 : own_extent(solid)[axis];
    below[node] = static_cast<std::int32_t>(network.reference.size());
    network.reference.push_back(as_vector<dim>(from_own(solid, own)));
  }
  return below;
}

template <int dim>
void add_cells(ElasticNetwork<dim>& network, const BodyLattice<dim>& lattice, const Solid& solid,
               double modulus) {
  const auto n = static_cast<std::int32_t>(network.movable);
  const auto on_clamp = modulus > 0.0 ? add_clamp_nodes(network, lattice, solid)
                                      : std::map<std::int32_t, std::int32_t>();
  constexpr int corners = 1 << dim;
  for (const auto& [place, i] : lattice.node) {
    std::array<std::int32_t, corners> corner;
    for (int c = 0; c < corners; ++c) {
      auto at = place;  // round the lower face, then the upper one
      at[0] += (c % 4 == 1 || c % 4 == 2) ? 1 : 0;
      at[1] += c % 4 >= 2 ? 1 : 0;
      if constexpr (dim == 3) at[2] += c / 4;
      corner[c] = lattice.find(at);
    }
    if (*std::min_element(corner.begin(), corner.end()) < 0) continue;
    const auto ghosts =
        std::count_if(corner.begin(), corner.end(), [n](std::int32_t c) { return c >= n; });
    if (ghosts == 0) network.body_cells.push_back(corner);
    if (ghosts == corners || modulus == 0.0) continue;
    std::array<Vector<dim>, corners> at, gradient;
    for (int c = 0; c < corners; ++c) {
      if (corner[c] >= n) corner[c] = on_clamp.at(corner[c]);
      at[c] = network.reference[corner[c]];
    }
    network.cells.push_back({corner, cell_volume(at, gradient), modulus});
  }
}

}  // namespace

template <int dim>
std::vector<Vector<dim>> fitted_places(const Solid& solid, double spacing) {
  const Vector<dim> pitch = pitch_of<dim>(solid, spacing, true);
  std::vector<Vector<dim>> places;
  for_each_index<dim>(fitted_count<dim>(solid, spacing), [&](const std::array<long, dim>& at) {
    Point own{};
    for (int d = 0; d < dim; ++d) own[d] = (static_cast<double>(at[d]) + 0.5) * pitch[d];
    places.push_back(as_vector<dim>(from_own(solid, own)));
  });
  return places;
}

template <int dim>
std::vector<double> cell_volumes(const Solid& solid, std::span<const Vector<dim>> places,
                                 double spacing, bool fitted) {
  const double cell = pitch_of<dim>(solid, spacing, fitted).prod();
  std::vector<double> volumes;
  for (const auto& x : places)
    volumes.push_back(cell * own_stretch(solid, to_own(solid, as_point<dim>(x))));
  return volumes;
}

template <int dim>
void append_body(ElasticNetwork<dim>& network, const Particles<dim>& particles, std::size_t first,
                 std::size_t last, const Solid& solid, const Numerics& numerics,
                 const SpringStiffness& stiffness) {
  const Vector<dim> pitch = pitch_of<dim>(solid, particles.spacing, numerics.fitted_bodies);
  auto lattice = lay_out<dim>(particles, first, last, solid, pitch);
  std::copy(lattice.cell_volume.begin() + first, lattice.cell_volume.begin() + last,
            network.volume.begin() + first);
  add_ghosts<dim>(network, lattice, solid, pitch);
  const std::size_t first_bond = network.bonds.size();
  add_bonds(network, lattice, numerics.bonds, stiffness.k_e, particles.spacing);
  if (first_bond == network.bonds.size())
    throw std::invalid_argument("no springs: the body holds a single particle");
  add_cells(network, lattice, solid, numerics.area_stiffness * stiffness.shear_modulus);
  if (numerics.surface_correction) {
    if (dim == 3 && numerics.bonds != Bonds::isotropic)
      throw std::invalid_argument(
          "in space the surface correction is for numerics.bonds = \"isotropic\"");
    weigh_bonds(network, first_bond, lattice, stiffness.k_e);
  }
}

double cell_volume(const std::array<Vector<2>, 4>& x, std::array<Vector<2>, 4>& gradient) {
  // Shoelace formula: A = 1/2 (x2 - x0) x (x3 - x1).
  const Vector<2> p = x[2] - x[0], q = x[3] - x[1];
  gradient[0] = {-0.5 * q[1], 0.5 * q[0]};
  gradient[2] = {0.5 * q[1], -0.5 * q[0]};
  gradient[1] = {0.5 * p[1], -0.5 * p[0]};
  gradient[3] = {-0.5 * p[1], 0.5 * p[0]};
  return 0.5 * (p[0] * q[1] - p[1] * q[0]);
}

double cell_volume(const std::array<Vector<3>, 8>& x, std::array<Vector<3>, 8>& gradient) {
  // The flux of x/3 through a face of the trilinear map is the mean over its two divisions into
  // triangles; a triangle's is a . (b x c)/6. Faces counter-clockwise from outside.
  static constexpr int face[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                     {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  gradient.fill(Vector<3>::Zero());
  double volume = 0.0;
  const auto add = [&](int a, int b, int c) {
    // From the first corner, lest the cell's distance from the origin cost digits.
    const Vector<3> u = x[a] - x[0], v = x[b] - x[0], w = x[c] - x[0];
    const Vector<3> vw = v.cross(w) / 12.0, wu = w.cross(u) / 12.0, uv = u.cross(v) / 12.0;
    volume += u.dot(vw);
    gradient[a] += vw;
    gradient[b] += wu;
    gradient[c] += uv;
    gradient[0] -= vw + wu + uv;
  };
  for (const auto& f : face)
    for (int k = 0; k < 4; ++k) add(f[k], f[(k + 1) % 4], f[(k + 2) % 4]);
  return volume;
}

template <int dim>
void bond_tensions(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position,
                   std::vector<double>& tension) {
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network.movable ? position[node]
                                                            : network.reference[node];
  };
  const auto extension = [&](const Bond& bond) {
    return (place(bond.a) - place(bond.b)).norm() - bond.rest_length;
  };
  tension.resize(network.bonds.size());
  for (std::size_t k = 0; k < tension.size(); ++k)
    tension[k] = network.bonds[k].stiffness * extension(network.bonds[k]);
  for (const BondTie& tie : network.ties) {
    const Bond &first = network.bonds[tie.first], &second = network.bonds[tie.second];
    const double scale = tie.stiffness / (first.rest_length * second.rest_length);
    tension[tie.first] += scale * extension(second);
    tension[tie.second] += scale * extension(first);
  }
}

template <int dim>
void elastic_forces(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position,
                    std::vector<Vector<dim>>& force) {
  force.assign(network.reference.size(), Vector<dim>::Zero());
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network.movable ? position[node]
                                                            : network.reference[node];
  };
  std::vector<double> tension;
  bond_tensions(network, position, tension);
  for (std::size_t k = 0; k < network.bonds.size(); ++k) {
    const Bond& bond = network.bonds[k];
    const Vector<dim> r = place(bond.a) - place(bond.b);
    const Vector<dim> f = -tension[k] / r.norm() * r;
    force[bond.a] += f;
    force[bond.b] -= f;
  }
  std::array<Vector<dim>, 1 << dim> corner, gradient;
  for (const auto& cell : network.cells) {
    for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = place(cell.corner[c]);
    const double volume = cell_volume(corner, gradient);
    const double pressure = -cell.modulus * (volume / cell.rest_volume - 1.0);
    for (std::size_t c = 0; c < corner.size(); ++c) force[cell.corner[c]] += pressure * gradient[c];
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
  const auto strain = [&](std::int32_t k) {
    const Bond& bond = network.bonds[k];
    return (place(bond.a) - place(bond.b)).norm() / bond.rest_length - 1.0;
  };
  for (const BondTie& tie : network.ties)
    energy += tie.stiffness * strain(tie.first) * strain(tie.second);
  std::array<Vector<dim>, 1 << dim> corner, gradient;
  for (const auto& cell : network.cells) {
    for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = place(cell.corner[c]);
    const double dilation = cell_volume(corner, gradient) / cell.rest_volume - 1.0;
    energy += 0.5 * cell.modulus * cell.rest_volume * dilation * dilation;
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

template <int dim>
double volume_ratio(const ElasticNetwork<dim>& network, std::span<const Vector<dim>> position) {
  double now = 0.0, rest = 0.0;
  std::array<Vector<dim>, 1 << dim> corner, gradient;
  for (const auto& cell : network.body_cells) {
    for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = position[cell[c]];
    now += cell_volume(corner, gradient);
    for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = network.reference[cell[c]];
    rest += cell_volume(corner, gradient);
  }
  return rest > 0.0 ? now / rest : 1.0;
}

template double volume_ratio<2>(const ElasticNetwork<2>&, std::span<const Vector<2>>);
template double volume_ratio<3>(const ElasticNetwork<3>&, std::span<const Vector<3>>);
template ElasticNetwork<2> network_at_rest<2>(const Particles<2>&);
template ElasticNetwork<3> network_at_rest<3>(const Particles<3>&);
template std::vector<Vector<2>> fitted_places<2>(const Solid&, double);
template std::vector<Vector<3>> fitted_places<3>(const Solid&, double);
template std::vector<double> cell_volumes<2>(const Solid&, std::span<const Vector<2>>, double,
                                             bool);
template std::vector<double> cell_volumes<3>(const Solid&, std::span<const Vector<3>>, double,
                                             bool);
template void append_body<2>(ElasticNetwork<2>&, const Particles<2>&, std::size_t, std::size_t,
                             const Solid&, const Numerics&, const SpringStiffness&);
template void append_body<3>(ElasticNetwork<3>&, const Particles<3>&, std::size_t, std::size_t,
                             const Solid&, const Numerics&, const SpringStiffness&);
template void bond_tensions<2>(const ElasticNetwork<2>&, std::span<const Vector<2>>,
                               std::vector<double>&);
template void bond_tensions<3>(const ElasticNetwork<3>&, std::span<const Vector<3>>,
                               std::vector<double>&);
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
