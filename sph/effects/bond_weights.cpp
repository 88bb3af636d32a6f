#include "sph/effects/bond_weights.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace sprung::sph {

namespace {

struct Share {
  double area = 0.0;                    ///< in units of dx^2
  Vector<2> centroid = Vector<2>::Zero();  ///< from the particle, in units of dx
};

/// Area and centroid of the part of the body that is nearer to each particle than to any other, by
/// midpoint sampling of the body.
std::vector<Share> shares_of_body(const ElasticNetwork<2>& network, std::size_t first,
                                  std::size_t last, const Box& body, double dx) {
  constexpr int samples_per_spacing = 24;
  std::vector<Share> shares(last - first);
  std::array<int, 2> count;
  Vector<2> step;
  for (int d = 0; d < 2; ++d) {
    const double extent = body.to[d] - body.from[d];
    count[d] = std::max(1, static_cast<int>(std::ceil(extent / dx * samples_per_spacing)));
    step[d] = extent / count[d];
  }
  const double sample_area = step[0] * step[1] / (dx * dx);
  for (int j = 0; j < count[1]; ++j)
    for (int i = 0; i < count[0]; ++i) {
      const Vector<2> x{body.from[0] + (i + 0.5) * step[0], body.from[1] + (j + 0.5) * step[1]};
      std::size_t nearest = first;
      double least = (x - network.reference[first]).squaredNorm();
      for (std::size_t p = first + 1; p < last; ++p) {
        const double d2 = (x - network.reference[p]).squaredNorm();
        if (d2 < least) {
          least = d2;
          nearest = p;
        }
      }
      Share& share = shares[nearest - first];
      share.area += sample_area;
      share.centroid += sample_area * (x - network.reference[nearest]) / dx;
    }
  for (Share& share : shares)
    if (share.area > 0.0) share.centroid /= share.area;
  return shares;
}

/// Weights >= 0 closest to `nominal` with sum = 2A exactly and sum w m = 2A c as nearly as can be.
Eigen::VectorXd quadrature_weights(const Eigen::MatrixXd& midpoint, const Eigen::VectorXd& nominal,
                                   const Share& share) {
  const Eigen::Index n = nominal.size();
  std::vector<Eigen::Index> active(n);
  for (Eigen::Index k = 0; k < n; ++k) active[k] = k;
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(n);
  // Least change is asked far less strongly than the moments, and those less than the sum.
  constexpr double for_change = 1e-4, for_moment = 1.0, for_sum = 1e4;
  while (!active.empty()) {
    const auto m = static_cast<Eigen::Index>(active.size());
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(m + 3, m);
    Eigen::VectorXd right(m + 3);
    for (Eigen::Index k = 0; k < m; ++k) {
      rows(k, k) = for_change;
      right[k] = for_change * nominal[active[k]];
      rows(m, k) = for_sum;
      rows(m + 1, k) = for_moment * midpoint(active[k], 0);
      rows(m + 2, k) = for_moment * midpoint(active[k], 1);
    }
    right[m] = for_sum * 2.0 * share.area;
    right[m + 1] = for_moment * 2.0 * share.area * share.centroid[0];
    right[m + 2] = for_moment * 2.0 * share.area * share.centroid[1];
    const Eigen::VectorXd solution = rows.colPivHouseholderQr().solve(right);
    Eigen::Index lowest = 0;
    if (solution.minCoeff(&lowest) >= -1e-9) {
      for (Eigen::Index k = 0; k < m; ++k) weight[active[k]] = std::max(solution[k], 0.0);
      break;
    }
    // Drop every negative weight and solve again for the rest.
    std::vector<Eigen::Index> left;
    for (Eigen::Index k = 0; k < m; ++k)
      if (solution[k] > 0.0) left.push_back(active[k]);
    active.swap(left);
  }
  return weight;
}

}  // namespace

void weigh_bonds(ElasticNetwork<2>& network, std::size_t first_bond, std::size_t first,
                 std::size_t last, const Solid& solid, double dx) {
  const auto shares = shares_of_body(network, first, last, solid.body, dx);
  const auto movable = static_cast<std::int32_t>(network.movable);
  const std::size_t bonds = network.bonds.size() - first_bond;
  std::vector<double> weight(bonds, 0.0);
  auto bond_at = [&](std::size_t k) -> Bond& { return network.bonds[first_bond + k]; };
  auto is_ghost = [&](const Bond& b) { return b.a >= movable || b.b >= movable; };

  for (const bool diagonal : {false, true}) {
    std::vector<std::size_t> group;
    for (std::size_t k = 0; k < bonds; ++k)
      if ((bond_at(k).rest_length > 1.2 * dx) == diagonal) group.push_back(k);
    for (std::size_t p = first; p < last; ++p) {
      const auto self = static_cast<std::int32_t>(p);
      const Share& share = shares[p - first];
      std::vector<std::size_t> near;
      std::vector<Vector<2>> middle;
      int own = 0;
      for (const std::size_t k : group) {
        const Bond& b = bond_at(k);
        const Vector<2> m = (0.5 * (network.reference[b.a] + network.reference[b.b]) -
                             network.reference[p]) / dx;
        const bool mine = b.a == self || b.b == self;
        own += mine;
        if (m.norm() < 1.3) {
          near.push_back(k);
          middle.push_back(m);
        }
      }
      const bool bulk = own == 4 && std::abs(share.area - 1.0) < 0.02;
      Eigen::MatrixXd midpoint(near.size(), 2);
      Eigen::VectorXd nominal(near.size());
      for (std::size_t k = 0; k < near.size(); ++k) {
        const Bond& b = bond_at(near[k]);
        midpoint.row(k) = middle[k].transpose();
        nominal[k] = b.a == self || b.b == self ? 0.5 : 0.0;
      }
      const Eigen::VectorXd given = bulk ? nominal : quadrature_weights(midpoint, nominal, share);
      for (std::size_t k = 0; k < near.size(); ++k) weight[near[k]] += given[k];
    }
  }
  for (std::size_t k = 0; k < bonds; ++k) {
    // A ghost has no share of its own, so its bonds have half the weight of others so far.
    const double w = is_ghost(bond_at(k)) ? 2.0 * (weight[k] + 0.5) : weight[k];
    bond_at(k).stiffness *= std::max(w, 0.3);
  }
}

}  // namespace sprung::sph
