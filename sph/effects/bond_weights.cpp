#include "sph/effects/bond_weights.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace sprung::sph {

namespace {

/// What a particle's weights must integrate: twice the integrals of 1, m_k and m_k m_l over the
/// part of the body nearest to it, less what the bulk rule leaves at a free surface (see
/// bond_weights.hpp). Lengths in units of dx, places from the particle.
struct Share {
  double area = 0.0;
  Vector<2> first = Vector<2>::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  double surface = 0.0;                                      ///< length of free surface
  Vector<2> surface_first = Vector<2>::Zero();               ///< integral of n
  Eigen::Matrix2d surface_second = Eigen::Matrix2d::Zero();  ///< integral of n m + m n
};

/// The bulk rule of the bonds along the axes integrates 2 f + bulk_defect lap f.
constexpr double bulk_defect = 1.0 / 24.0;

/// Samples the body and its free sides and gives each sample to the nearest particle.
class BodySampling {
 public:
  BodySampling(const ElasticNetwork<2>& network, std::size_t first, std::size_t last,
               const Solid& solid, double dx)
      : network_(network), first_(first), last_(last), dx_(dx), shares_(last - first) {
    std::array<int, 2> count;
    Vector<2> step;
    for (int d = 0; d < 2; ++d) {
      const double extent = solid.body.to[d] - solid.body.from[d];
      count[d] = std::max(1, static_cast<int>(std::ceil(extent / dx * samples_per_spacing - 1e-6)));
      step[d] = extent / count[d];
    }
    const auto place = [&](double i, double j) {
      return Vector<2>(solid.body.from[0] + i * step[0], solid.body.from[1] + j * step[1]);
    };
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) add_area(place(i + 0.5, j + 0.5), step);
    const auto free = [&](Side side) { return !solid.clamped || *solid.clamped != side; };
    for (int j = 0; j < count[1]; ++j) {
      if (free(Side::left)) add_surface(place(0, j + 0.5), {-1, 0}, step[1]);
      if (free(Side::right)) add_surface(place(count[0], j + 0.5), {1, 0}, step[1]);
    }
    for (int i = 0; i < count[0]; ++i) {
      if (free(Side::bottom)) add_surface(place(i + 0.5, 0), {0, -1}, step[0]);
      if (free(Side::top)) add_surface(place(i + 0.5, count[1]), {0, 1}, step[0]);
    }
  }
  const Share& of(std::size_t particle) const { return shares_[particle - first_]; }

 private:
  static constexpr int samples_per_spacing = 24;

  std::size_t nearest(const Vector<2>& x) const {
    std::size_t best = first_;
    double least = (x - network_.reference[first_]).squaredNorm();
    for (std::size_t p = first_ + 1; p < last_; ++p) {
      const double d2 = (x - network_.reference[p]).squaredNorm();
      if (d2 < least) {
        least = d2;
        best = p;
      }
    }
    return best;
  }

  void add_area(const Vector<2>& x, const Vector<2>& step) {
    const std::size_t p = nearest(x);
    const Vector<2> m = (x - network_.reference[p]) / dx_;
    const double area = step[0] * step[1] / (dx_ * dx_);
    Share& share = shares_[p - first_];
    share.area += area;
    share.first += area * m;
    share.second += area * m * m.transpose();
    for (int d = 0; d < 2; ++d)  // the sample's own extent
      share.second(d, d) += area * step[d] * step[d] / (12.0 * dx_ * dx_);
  }

  void add_surface(const Vector<2>& x, const Vector<2>& normal, double length) {
    const std::size_t p = nearest(x);
    const Vector<2> m = (x - network_.reference[p]) / dx_;
    const double l = length / dx_;
    Share& share = shares_[p - first_];
    share.surface += l;
    share.surface_first += l * normal;
    share.surface_second += l * (normal * m.transpose() + m * normal.transpose());
  }

  const ElasticNetwork<2>& network_;
  std::size_t first_, last_;
  double dx_;
  std::vector<Share> shares_;
};

/// Weights closest to `nominal` whose sum is twice the area and, for the bonds along the axes,
/// whose first and second moments are those of `share`. The sum is asked far more strongly than the
/// first moments, those more than the second, and the least change last.
Eigen::VectorXd quadrature_weights(const Eigen::MatrixXd& midpoint, const Eigen::VectorXd& nominal,
                                   const Share& share, bool diagonal) {
  const Vector<2> first = 2.0 * share.first - bulk_defect * share.surface_first;
  const Eigen::Matrix2d second = 2.0 * share.second +
                                 2.0 * bulk_defect * share.area * Eigen::Matrix2d::Identity() -
                                 bulk_defect * share.surface_second;
  const Eigen::Index n = nominal.size();
  const double for_sum = 1e4, for_change = 1e-4;
  const double for_first = diagonal ? 0.0 : 1e2, for_second = diagonal ? 0.0 : 1.0;
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(n + 6, n);
  Eigen::VectorXd right(n + 6);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::RowVector2d m = midpoint.row(k);
    rows(k, k) = for_change;
    right[k] = for_change * nominal[k];
    rows(n, k) = for_sum;
    rows(n + 1, k) = for_first * m[0];
    rows(n + 2, k) = for_first * m[1];
    rows(n + 3, k) = for_second * m[0] * m[0];
    rows(n + 4, k) = for_second * m[0] * m[1];
    rows(n + 5, k) = for_second * m[1] * m[1];
  }
  right.tail(6) << for_sum * 2.0 * share.area, for_first * first[0], for_first * first[1],
      for_second * second(0, 0), for_second * second(0, 1), for_second * second(1, 1);
  return rows.colPivHouseholderQr().solve(right);
}

}  // namespace

void weigh_bonds(ElasticNetwork<2>& network, std::size_t first_bond, std::size_t first,
                 std::size_t last, const Solid& solid, double dx) {
  const BodySampling sampling(network, first, last, solid, dx);
  const auto movable = static_cast<std::int32_t>(network.movable);
  const std::size_t bonds = network.bonds.size() - first_bond;
  std::vector<double> weight(bonds, 0.0);
  auto bond_at = [&](std::size_t k) -> Bond& { return network.bonds[first_bond + k]; };
  auto is_ghost = [&](const Bond& b) { return b.a >= movable || b.b >= movable; };

  for (const bool diagonal : {false, true}) {
    const double reach = diagonal ? 1.3 : 1.6;
    std::vector<std::size_t> group;
    for (std::size_t k = 0; k < bonds; ++k)
      if ((bond_at(k).rest_length > 1.2 * dx) == diagonal) group.push_back(k);
    for (std::size_t p = first; p < last; ++p) {
      const auto self = static_cast<std::int32_t>(p);
      const Share& share = sampling.of(p);
      std::vector<std::size_t> near;
      std::vector<Vector<2>> middle;
      int own = 0;
      for (const std::size_t k : group) {
        const Bond& b = bond_at(k);
        const Vector<2> m =
            (0.5 * (network.reference[b.a] + network.reference[b.b]) - network.reference[p]) / dx;
        const bool mine = b.a == self || b.b == self;
        own += mine;
        if (m.norm() < reach) {
          near.push_back(k);
          middle.push_back(m);
        }
      }
      const bool bulk = own == 4 && std::abs(share.area - 1.0) < 0.02 && share.surface == 0.0;
      Eigen::MatrixXd midpoint(near.size(), 2);
      Eigen::VectorXd nominal(near.size());
      for (std::size_t k = 0; k < near.size(); ++k) {
        const Bond& b = bond_at(near[k]);
        midpoint.row(k) = middle[k].transpose();
        nominal[k] = b.a == self || b.b == self ? 0.5 : 0.0;
      }
      const Eigen::VectorXd given =
          bulk ? nominal : quadrature_weights(midpoint, nominal, share, diagonal);
      for (std::size_t k = 0; k < near.size(); ++k) weight[near[k]] += given[k];
    }
  }
  for (std::size_t k = 0; k < bonds; ++k) {
    // The ghost's own share is the mirror image of what was given here, and the same movement of
    // the particle strains the half of the bond that is material twice as much.
    const double w = is_ghost(bond_at(k)) ? 4.0 * weight[k] : weight[k];
    bond_at(k).stiffness *= std::max(w, 0.3);
  }
}

}  // namespace sprung::sph
