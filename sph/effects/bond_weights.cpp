#include "sph/effects/bond_weights.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace sprung::sph {

namespace {

/// One number that a group reads off the bonds: the sum of factor x strain over one bond or two.
template <int dim>
struct Measure {
  std::array<std::int32_t, 2> bond{-1, -1};
  std::array<double, 2> factor{};
  Vector<dim> place;  ///< of the bonds' midpoint, from the particle, in places
  double weight = 0.0;  ///< that the particle gives it in the bulk
};

/// A kind of measure: bonds along one axis (`second` < 0), or the squares of two axes.
struct Kind {
  int first, second;
  double sign;      ///< of the bond along `first`, or of the diagonal along first + second
  double crossing;  ///< of the diagonal along first - second
  double weight;    ///< that a particle gives in the bulk
};

/// The groups of the energy; see the header.
template <int dim>
std::vector<std::vector<Kind>> groups() {
  if constexpr (dim == 2) {
    return {{{0, -1, 1.0, 0.0, 0.5}, {1, -1, -1.0, 0.0, 0.5}},
            {{0, 1, 1.0, -1.0, 0.125}},
            {{0, 1, 1.0, 1.0, 0.125}}};
  } else {
    std::vector<std::vector<Kind>> all;
    for (int a = 0; a < 3; ++a) {
      const int b = std::min((a + 1) % 3, (a + 2) % 3), c = std::max((a + 1) % 3, (a + 2) % 3);
      all.push_back({{a, -1, 1.0, 0.0, 0.5}, {b, c, -1.0, -1.0, 0.25}});
      all.push_back({{b, c, 1.0, -1.0, 0.25}});
    }
    return all;
  }
}

/// Strength of a kind's bulk rule (the sum of its weights) and its defect D.
template <int dim>
std::pair<double, Eigen::Matrix<double, dim, dim>> bulk_rule(const Kind& kind) {
  const int measures = kind.second < 0 ? 2 : 4;
  const double strength = measures * kind.weight;
  Eigen::Matrix<double, dim, dim> defect =
      -1.0 / 24.0 * Eigen::Matrix<double, dim, dim>::Identity();
  defect(kind.first, kind.first) += 0.125;
  if (kind.second >= 0) defect(kind.second, kind.second) += 0.125;
  return {strength, strength * defect};
}

template <int dim>
class BondWeighing {
 public:
  BondWeighing(ElasticNetwork<dim>& network, std::size_t first_bond,
               const BodyLattice<dim>& lattice, double k_e)
      : network_(network), lattice_(lattice), first_bond_(first_bond), k_e_(k_e) {
    for (std::size_t k = first_bond; k < network.bonds.size(); ++k) {
      const Bond& bond = network.bonds[k];
      bond_of_[std::minmax(bond.a, bond.b)] = static_cast<std::int32_t>(k);
    }
    diagonal_.assign(network.bonds.size() - first_bond, 0.0);
  }

  void weigh() {
    for (const auto& [place, node] : lattice_.node)
      if (static_cast<std::size_t>(node) < network_.movable)
        for (const auto& group : groups<dim>()) add_share(place, node, group);
    for (std::size_t k = 0; k < diagonal_.size(); ++k) {
      Bond& bond = network_.bonds[first_bond_ + k];
      bond.stiffness = diagonal_[k] / (bond.rest_length * bond.rest_length);
    }
    const double least = 1e-9 * k_e_ *
                         *std::max_element(lattice_.cell_volume.begin(), lattice_.cell_volume.end());
    for (const auto& [pair, stiffness] : tied_)
      if (std::abs(stiffness) > least)
        network_.ties.push_back({pair.first, pair.second, stiffness});
  }

 private:
  using Place = typename BodyLattice<dim>::Place;
  using Square = Eigen::Matrix<double, dim, dim>;
  static constexpr int terms = dim + 1;  ///< of a linear function: value and gradient
  using Form = Eigen::Matrix<double, terms, terms>;

  std::int32_t bond_between(const Place& a, const Place& b) const {
    const std::int32_t i = lattice_.find(a), j = lattice_.find(b);
    if (i < 0 || j < 0) return -1;
    const auto found = bond_of_.find(std::minmax(i, j));
    return found == bond_of_.end() ? -1 : found->second;
  }

  double strain_factor(std::int32_t bond) const {
    const auto n = static_cast<std::int32_t>(network_.movable);
    return network_.bonds[bond].a >= n || network_.bonds[bond].b >= n ? 2.0 : 1.0;
  }

  /// Measures of one kind that the particle at `owner` has a part in, seen from `from`.
  void append_measures(const Kind& kind, const Place& owner, const Place& from, double weight,
                       std::vector<Measure<dim>>& measures) const {
    for (const int i : {-1, 1}) {
      for (const int j : {-1, 1}) {
        Measure<dim> m;
        m.weight = weight;
        for (int d = 0; d < dim; ++d) m.place[d] = owner[d] - from[d];
        m.place[kind.first] += 0.5 * i;
        Place far = owner;
        far[kind.first] += i;
        if (kind.second < 0) {
          if (j > 0) continue;
          m.bond[0] = bond_between(owner, far);
          m.factor[0] = kind.sign;
        } else {
          m.place[kind.second] += 0.5 * j;
          Place side = owner, across = far;
          side[kind.second] += j;
          across[kind.second] += j;
          // owner - across runs along first + second when i = j.
          m.bond = {bond_between(owner, across), bond_between(far, side)};
          m.factor = {i == j ? kind.sign : kind.crossing, i == j ? kind.crossing : kind.sign};
          if (m.bond[1] < 0) continue;
          m.factor[1] *= strain_factor(m.bond[1]);
        }
        if (m.bond[0] < 0) continue;
        m.factor[0] *= strain_factor(m.bond[0]);
        const bool known = std::any_of(measures.begin(), measures.end(), [&](const auto& other) {
          return std::minmax(other.bond[0], other.bond[1]) == std::minmax(m.bond[0], m.bond[1]);
        });
        if (!known) measures.push_back(m);
      }
    }
  }

  /// What a linear function stores in the particle's share of the body; Q of the header.
  Form share_form(const Place& place, double strength, const Square& defect) const {
    Vector<dim> low, high;
    for (int d = 0; d < dim; ++d) {
      low[d] = place[d] == lattice_.lowest[d] ? lattice_.low_face[d] - place[d] : -0.5;
      high[d] = place[d] == lattice_.highest[d] ? lattice_.high_face[d] - place[d] : 0.5;
    }
    const Vector<dim> extent = high - low, middle = 0.5 * (low + high);
    const double volume = extent.prod();
    Form q;
    Square second = volume * middle * middle.transpose();
    for (int d = 0; d < dim; ++d) second(d, d) += volume * extent[d] * extent[d] / 12.0;
    q(0, 0) = strength * volume;
    q.template block<dim, 1>(1, 0) = strength * volume * middle;
    q.template block<dim, dim>(1, 1) = strength * second + 2.0 * volume * defect;
    for (int d = 0; d < dim; ++d)
      for (const bool upper : {false, true}) {
        if (place[d] != (upper ? lattice_.highest[d] : lattice_.lowest[d]) ||
            !lattice_.free[2 * d + upper])
          continue;
        const double area = volume / extent[d];
        const Vector<dim> normal_defect = (upper ? 1.0 : -1.0) * defect.row(d).transpose();
        Vector<dim> centre = middle;
        centre[d] = upper ? high[d] : low[d];
        q.template block<dim, 1>(1, 0) -= area * normal_defect;
        q.template block<dim, dim>(1, 1) -= area * (normal_defect * centre.transpose() +
                                                    centre * normal_defect.transpose());
      }
    q.template block<1, dim>(0, 1) = q.template block<dim, 1>(1, 0).transpose();
    return q;
  }

  void add_share(const Place& place, std::int32_t node, const std::vector<Kind>& group) {
    std::vector<Measure<dim>> measures;
    double strength = 0.0;
    Square defect = Square::Zero();
    for (const Kind& kind : group) {
      append_measures(kind, place, place, kind.weight, measures);
      const auto [kind_strength, kind_defect] = bulk_rule<dim>(kind);
      strength += kind_strength;
      defect += kind_defect;
    }
    std::vector<Place> inwards;
    for (int d = 0; d < dim; ++d)
      for (const bool upper : {false, true})
        if (place[d] == (upper ? lattice_.highest[d] : lattice_.lowest[d]) &&
            lattice_.free[2 * d + upper]) {
          inwards.push_back(place);
          inwards.back()[d] += upper ? -1 : 1;
        }
    for (const Place& inner : inwards)
      for (const Kind& kind : group) append_measures(kind, inner, place, 0.0, measures);
    const auto n = static_cast<Eigen::Index>(measures.size());
    if (n == 0) return;
    Eigen::VectorXd bulk(n);
    for (Eigen::Index k = 0; k < n; ++k) bulk[k] = measures[k].weight;
    const double scale = k_e_ * lattice_.cell_volume[node];
    if (inwards.empty()) {
      add_energy(measures, scale * Eigen::MatrixXd(bulk.asDiagonal()));
      return;
    }
    const Form form = share_form(place, strength, defect);
    add_energy(measures, scale * share_energy(measures, bulk, form));
  }

  /// The quadratic form of the measures that stores `form` in their line and keeps the bulk's
  /// weights on what the line does not hold.
  static Eigen::MatrixXd share_energy(const std::vector<Measure<dim>>& measures,
                                      const Eigen::VectorXd& bulk, const Form& form) {
    const auto n = bulk.size();
    // A neighbour's measures settle only what the particle's own leave open.
    constexpr double neighbours_say = 0.02;
    Eigen::VectorXd say(n);
    Vector<dim> centre = Vector<dim>::Zero();
    for (Eigen::Index k = 0; k < n; ++k) {
      say[k] = std::sqrt(bulk[k] > 0.0 ? bulk[k] : neighbours_say);
      centre += say[k] * say[k] * measures[k].place;
    }
    centre /= say.squaredNorm();
    // From the measures' centre, so that a gradient that none of them tells is 0 and leaves the
    // value alone.
    Eigen::MatrixXd line(n, terms);
    for (Eigen::Index k = 0; k < n; ++k) {
      line(k, 0) = 1.0;
      line.row(k).tail(dim) = (measures[k].place - centre).transpose();
    }
    Form from_centre = Form::Identity();
    from_centre.template block<1, dim>(0, 1) = -centre.transpose();
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> fit(n, terms);
    fit.setThreshold(1e-8);
    fit.compute(say.asDiagonal() * line);
    const Eigen::MatrixXd reading = fit.pseudoInverse() * say.asDiagonal();
    // A form that is no sum of squares could only come from a body cut to slivers.
    Eigen::SelfAdjointEigenSolver<Form> parts(from_centre.transpose() * form * from_centre);
    const Form positive = parts.eigenvectors() *
                          parts.eigenvalues().cwiseMax(0.0).asDiagonal() *
                          parts.eigenvectors().transpose();
    const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(n, n) - line * reading;
    return reading.transpose() * positive * reading +
           rest.transpose() * bulk.asDiagonal() * rest;
  }

  /// Adds 1/2 measures . form . measures to the stored energy.
  void add_energy(const std::vector<Measure<dim>>& measures, const Eigen::MatrixXd& form) {
    for (std::size_t k = 0; k < measures.size(); ++k)
      for (std::size_t l = 0; l < measures.size(); ++l)
        for (int s = 0; s < 2; ++s)
          for (int t = 0; t < 2; ++t) {
            const std::int32_t a = measures[k].bond[s], b = measures[l].bond[t];
            if (a < 0 || b < 0) continue;
            const double value = form(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) *
                                 measures[k].factor[s] * measures[l].factor[t];
            if (a == b)
              diagonal_[a - first_bond_] += value;
            else if (a < b)
              tied_[{a, b}] += value;
          }
  }

  ElasticNetwork<dim>& network_;
  const BodyLattice<dim>& lattice_;
  std::size_t first_bond_;
  double k_e_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> bond_of_;
  std::vector<double> diagonal_;  ///< J per strain squared, by bond
  std::map<std::pair<std::int32_t, std::int32_t>, double> tied_;
};

}  // namespace

template <int dim>
void weigh_bonds(ElasticNetwork<dim>& network, std::size_t first_bond,
                 const BodyLattice<dim>& lattice, double k_e) {
  BondWeighing<dim>(network, first_bond, lattice, k_e).weigh();
}

template void weigh_bonds<2>(ElasticNetwork<2>&, std::size_t, const BodyLattice<2>&, double);
template void weigh_bonds<3>(ElasticNetwork<3>&, std::size_t, const BodyLattice<3>&, double);

}  // namespace sprung::sph
