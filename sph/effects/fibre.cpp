#include "sph/effects/fibre.hpp"

#include "scene/body_shape.hpp"

#include <Eigen/Dense>

#include <cmath>

namespace sprung::sph {

namespace {

/// Components of the symmetric tensor v v.
template <int dim>
Eigen::Vector<double, dim*(dim + 1) / 2> square(const Vector<dim>& v) {
  Eigen::Vector<double, dim*(dim + 1) / 2> components;
  int at = 0;
  for (int a = 0; a < dim; ++a)
    for (int b = a; b < dim; ++b) components[at++] = v[a] * v[b];
  return components;
}

template <int dim>
Vector<dim> fibre_direction(const Solid& solid, const Vector<dim>& x) {
  Point place{};
  for (int d = 0; d < dim; ++d) place[d] = x[d];
  const Point own = to_own(solid, place);
  const double flat = std::cos(solid.fibre->elevation);
  const std::array<double, 3> part{flat * std::cos(solid.fibre->angle),
                                   flat * std::sin(solid.fibre->angle),
                                   std::sin(solid.fibre->elevation)};
  Vector<dim> direction = Vector<dim>::Zero();
  for (int d = 0; d < dim; ++d) direction += part[d] * as_vector<dim>(own_direction(solid, own, d));
  return direction;
}

}  // namespace

template <int dim>
void add_fibres(ElasticNetwork<dim>& network, const Particles<dim>& particles, std::size_t first,
                std::size_t last, const Solid& solid) {
  const auto n = static_cast<std::int32_t>(network.movable);
  std::vector<std::vector<std::int32_t>> bonds_of(last - first);
  for (std::size_t k = 0; k < network.bonds.size(); ++k)
    for (const std::int32_t node : {network.bonds[k].a, network.bonds[k].b})
      if (node >= static_cast<std::int32_t>(first) && node < static_cast<std::int32_t>(last))
        bonds_of[node - first].push_back(static_cast<std::int32_t>(k));
  for (std::size_t i = first; i < last; ++i) {
    const auto& bonds = bonds_of[i - first];
    Eigen::MatrixXd squares(dim * (dim + 1) / 2, bonds.size());
    for (std::size_t b = 0; b < bonds.size(); ++b) {
      const Bond& bond = network.bonds[bonds[b]];
      const bool ghost = bond.a >= n || bond.b >= n;
      // The strain at a clamp is twice what a bond to a ghost shows.
      squares.col(static_cast<Eigen::Index>(b)) =
          (ghost ? 2.0 : 1.0) *
          square<dim>((network.reference[bond.a] - network.reference[bond.b]) / bond.rest_length);
    }
    const Eigen::VectorXd reading = squares.completeOrthogonalDecomposition().solve(
        square<dim>(fibre_direction<dim>(solid, network.reference[i])));
    const double scale = solid.fibre->modulus * particles.volume;
    for (std::size_t b = 0; b < bonds.size(); ++b) {
      Bond& bond = network.bonds[bonds[b]];
      const double own = reading[static_cast<Eigen::Index>(b)];
      bond.stiffness += scale * own * own / (bond.rest_length * bond.rest_length);
      for (std::size_t c = 0; c < b; ++c) {
        const double tie = scale * own * reading[static_cast<Eigen::Index>(c)];
        if (std::abs(tie) > 1e-12 * scale) network.ties.push_back({bonds[c], bonds[b], tie});
      }
    }
  }
}

template void add_fibres<2>(ElasticNetwork<2>&, const Particles<2>&, std::size_t, std::size_t,
                            const Solid&);
template void add_fibres<3>(ElasticNetwork<3>&, const Particles<3>&, std::size_t, std::size_t,
                            const Solid&);

}  // namespace sprung::sph
