#include "sph/effects/elastic_solid.hpp"

#include <Eigen/Dense>

#include <cmath>
#include <stdexcept>

namespace sprung::sph {

namespace {
/// g and a of the implicit step; see add_acceleration.
constexpr double implicit_weight = 0.5;
constexpr double implicit_damping = 0.1;

template <int dim>
using Block = Eigen::Matrix<double, dim, dim>;

template <int dim>
std::span<const Vector<dim>> solid_positions(const ElasticNetwork<dim>& network,
                                             const std::vector<Vector<dim>>& position) {
  return {position.data(), network.movable};
}

}  // namespace

namespace {

/// K x at rest, written out: by differences of the forces it would lose digits.
template <int dim>
Eigen::VectorXd stiffness_times(const ElasticNetwork<dim>& network, const Eigen::VectorXd& x) {
  const std::size_t n = network.movable;
  Eigen::VectorXd y = Eigen::VectorXd::Zero(x.size());
  const auto value = [&](std::int32_t node) -> Vector<dim> {
    return static_cast<std::size_t>(node) < n ? Vector<dim>(x.template segment<dim>(node * dim))
                                              : Vector<dim>(Vector<dim>::Zero());
  };
  const auto add = [&](std::int32_t node, const Vector<dim>& f) {
    if (static_cast<std::size_t>(node) < n) y.template segment<dim>(node * dim) += f;
  };
  const auto direction = [&](const Bond& bond) -> Vector<dim> {
    return (network.reference[bond.a] - network.reference[bond.b]) / bond.rest_length;
  };
  std::vector<double> extension(network.bonds.size()), tension(network.bonds.size());
  for (std::size_t k = 0; k < network.bonds.size(); ++k) {
    const Bond& bond = network.bonds[k];
    extension[k] = direction(bond).dot(value(bond.a) - value(bond.b));
    tension[k] = bond.stiffness * extension[k];
  }
  for (const BondTie& tie : network.ties) {
    const double scale = tie.stiffness / (network.bonds[tie.first].rest_length *
                                          network.bonds[tie.second].rest_length);
    tension[tie.first] += scale * extension[tie.second];
    tension[tie.second] += scale * extension[tie.first];
  }
  for (std::size_t k = 0; k < network.bonds.size(); ++k) {
    const Vector<dim> f = tension[k] * direction(network.bonds[k]);
    add(network.bonds[k].a, f);
    add(network.bonds[k].b, -f);
  }
  std::array<Vector<dim>, 1 << dim> corner, gradient;
  for (const auto& cell : network.cells) {
    for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = network.reference[cell.corner[c]];
    cell_volume(corner, gradient);
    double change = 0.0;
    for (std::size_t c = 0; c < corner.size(); ++c)
      change += gradient[c].dot(value(cell.corner[c]));
    for (std::size_t c = 0; c < corner.size(); ++c)
      add(cell.corner[c], cell.modulus / cell.rest_volume * change * gradient[c]);
  }
  return y;
}

}  // namespace

/// Lanczos' method with every vector kept orthogonal to all before it.
template <int dim>
double highest_frequency(const ElasticNetwork<dim>& network, double density) {
  const auto size = static_cast<Eigen::Index>(network.movable * dim);
  // Of M^-1/2 K M^-1/2.
  Eigen::VectorXd by_root_of_mass(size);
  for (Eigen::Index k = 0; k < size; ++k)
    by_root_of_mass[k] = 1.0 / std::sqrt(density * network.volume[k / dim]);
  const Eigen::Index most = std::min<Eigen::Index>(60, size);
  Eigen::MatrixXd basis(size, most), projected = Eigen::MatrixXd::Zero(most, most);
  // A start that holds every mode: fixed, uneven numbers.
  for (Eigen::Index k = 0; k < size; ++k) basis(k, 0) = std::sin(1.0 + 12.9898 * double(k));
  basis.col(0).normalize();
  Eigen::Index used = 0;
  for (Eigen::Index k = 0; k < most; ++k) {
    used = k + 1;
    Eigen::VectorXd y = by_root_of_mass.cwiseProduct(
        stiffness_times<dim>(network, by_root_of_mass.cwiseProduct(basis.col(k))));
    const double scale = y.norm();
    for (int again = 0; again < 2; ++again)
      for (Eigen::Index l = 0; l <= k; ++l) {
        const double part = basis.col(l).dot(y);
        if (l >= k - 1) projected(l, k) += part;
        y -= part * basis.col(l);
      }
    if (used == most || y.norm() < 1e-12 * scale) break;
    projected(k + 1, k) = y.norm();
    basis.col(k + 1) = y / y.norm();
  }
  const Eigen::MatrixXd square = projected.topLeftCorner(used, used);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (square + square.transpose()));
  return std::sqrt(eigen.eigenvalues().maxCoeff());
}

template <int dim>
ElasticSolid<dim>::ElasticSolid(ElasticNetwork<dim> network, Particles<dim>& particles,
                                SpringIntegration integration)
    : network_(std::move(network)),
      density_(particles.density),
      integration_(integration),
      highest_frequency_(highest_frequency(network_, particles.density)),
      spring_acceleration_(network_.movable, Vector<dim>::Zero()),
      load_(network_.movable, Vector<dim>::Zero()) {
  for (const double volume : network_.volume) mass_.push_back(particles.density * volume);
  if (integration_ != SpringIntegration::implicit_force) return;
  withheld_.assign(particles.size(), Vector<dim>::Zero());
  particles.carried.push_back({"withheld_acceleration", &withheld_});
}

template <int dim>
void ElasticSolid<dim>::add_acceleration(const State<dim>& state,
                                         std::vector<Vector<dim>>& acceleration) {
  if (integration_ == SpringIntegration::implicit_force) {
    implicit_acceleration(state);
    for (std::size_t i = 0; i < network_.movable; ++i) acceleration[i] -= withheld_[i];
  } else {
    find_forces(solid_positions(network_, state.particles.position));
    for (std::size_t i = 0; i < network_.movable; ++i)
      spring_acceleration_[i] = force_[i] / mass_[i];
  }
  for (std::size_t i = 0; i < network_.movable; ++i) acceleration[i] += spring_acceleration_[i];
}

namespace {

template <int dim>
std::vector<double> extensions(const ElasticNetwork<dim>& network,
                               std::span<const Vector<dim>> position) {
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network.movable ? position[node]
                                                            : network.reference[node];
  };
  std::vector<double> extension(network.bonds.size());
  for (std::size_t k = 0; k < extension.size(); ++k) {
    const Bond& bond = network.bonds[k];
    extension[k] = (place(bond.a) - place(bond.b)).norm() - bond.rest_length;
  }
  return extension;
}

}  // namespace

template <int dim>
void ElasticSolid<dim>::add(std::unique_ptr<BondLaw> law) {
  laws_.push_back(std::move(law));
  ElasticNetwork<dim> steepest = network_;
  for (std::size_t k = 0; k < steepest.bonds.size(); ++k)
    for (const auto& each : laws_) steepest.bonds[k].stiffness += each->steepest(k);
  highest_frequency_ = highest_frequency(steepest, density_);
}

template <int dim>
void ElasticSolid<dim>::find_forces(std::span<const Vector<dim>> position) {
  elastic_forces(network_, position, force_);
  bond_tensions(network_, position, tension_);
  if (laws_.empty()) return;
  const auto extension = extensions(network_, position);
  std::vector<double> more(network_.bonds.size(), 0.0);
  slope_.assign(network_.bonds.size(), 0.0);
  for (const auto& law : laws_) law->add_tension(extension, more, slope_);
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < network_.movable ? position[node]
                                                             : network_.reference[node];
  };
  for (std::size_t k = 0; k < more.size(); ++k) {
    if (more[k] == 0.0) continue;
    const Bond& bond = network_.bonds[k];
    const Vector<dim> f = -more[k] * (place(bond.a) - place(bond.b)).normalized();
    force_[bond.a] += f;
    force_[bond.b] -= f;
    tension_[k] += more[k];
  }
}

/// The bonds' laws learn where the step leads: solids move with the new velocity and nothing else.
template <int dim>
void ElasticSolid<dim>::advance_laws(const State<dim>& state) {
  if (laws_.empty()) return;
  const auto& particles = state.particles;
  const double dt = state.clock.time_step;
  std::vector<Vector<dim>> next(network_.movable);
  for (std::size_t i = 0; i < next.size(); ++i)
    next[i] = particles.position[i] + dt * particles.velocity[i];
  const auto before = extensions(network_, solid_positions(network_, particles.position));
  const auto now = extensions<dim>(network_, next);
  for (const auto& law : laws_) law->advance(before, now, dt);
}

template <int dim>
void ElasticSolid<dim>::assemble_tangent(std::span<const Vector<dim>> position) {
  const std::size_t n = network_.movable;
  constexpr std::size_t corners = 1 << dim;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve((network_.bonds.size() * 3 + network_.ties.size() * 4 +
                   network_.cells.size() * corners * corners / 2) *
                  dim * dim);
  const auto place = [&](std::int32_t node) -> const Vector<dim>& {
    return static_cast<std::size_t>(node) < n ? position[node] : network_.reference[node];
  };
  const auto add = [&](std::int32_t row, std::int32_t column, const Block<dim>& block) {
    if (static_cast<std::size_t>(std::max(row, column)) >= n || row < column) return;
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        if (row > column || a >= b)
          entries.emplace_back(row * dim + a, column * dim + b, block(a, b));
  };
  const auto add_symmetric = [&](const Bond& first, const Bond& second, const Block<dim>& block) {
    add(first.a, second.a, block);
    add(first.b, second.b, block);
    add(first.a, second.b, -block);
    add(first.b, second.a, -block);
  };
  std::vector<Vector<dim>> direction(network_.bonds.size());
  for (std::size_t k = 0; k < network_.bonds.size(); ++k) {
    const Bond& bond = network_.bonds[k];
    const Vector<dim> r = place(bond.a) - place(bond.b);
    const double length = r.norm();
    direction[k] = r / length;
    const Vector<dim>& e = direction[k];
    // The transverse part of a bond that pushes is negative; without it K stays positive definite,
    // and F, which decides the motion, is exact.
    const double transverse = std::max(0.0, tension_[k] / length);
    const Block<dim> along = e * e.transpose();
    const double stiffness = bond.stiffness + (slope_.empty() ? 0.0 : slope_[k]);
    add_symmetric(bond, bond, stiffness * along + transverse * (Block<dim>::Identity() - along));
  }
  for (const BondTie& tie : network_.ties) {
    const Bond &first = network_.bonds[tie.first], &second = network_.bonds[tie.second];
    const double scale = tie.stiffness / (first.rest_length * second.rest_length);
    const Block<dim> block = scale * direction[tie.first] * direction[tie.second].transpose();
    add_symmetric(first, second, block);
    add_symmetric(second, first, block.transpose());
  }
  std::array<Vector<dim>, 1 << dim> corner, gradient;
  for (const auto& cell : network_.cells) {
    for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = place(cell.corner[c]);
    cell_volume(corner, gradient);
    for (std::size_t a = 0; a < corner.size(); ++a)
      for (std::size_t b = 0; b < corner.size(); ++b)
        add(cell.corner[a], cell.corner[b],
            cell.modulus / cell.rest_volume * gradient[a] * gradient[b].transpose());
  }
  tangent_.resize(n * dim, n * dim);
  tangent_.setFromTriplets(entries.begin(), entries.end());
}

/// Its forces into `right`, and dt^2 k g g^T of every touch into the system.
template <int dim>
void ElasticSolid<dim>::add_contact(const State<dim>& state, Eigen::VectorXd& right) {
  const double dt = state.clock.time_step;
  const auto touches = contact_->find(state);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& touch : touches)
    for (const auto& a : touch.nodes) {
      right.template segment<dim>(a.node * dim) += touch.stiffness * touch.overlap * a.gradient;
      for (const auto& b : touch.nodes) {
        const Block<dim> block = dt * dt * touch.stiffness * a.gradient * b.gradient.transpose();
        for (int c = 0; c < dim; ++c)
          for (int d = 0; d < dim; ++d)
            if (const auto row = a.node * dim + c, column = b.node * dim + d; row >= column)
              entries.emplace_back(row, column, block(c, d));
      }
    }
  // Who touches whom changes the pattern of the matrix, with every touch that comes or goes.
  if (!touches.empty() || touching_) analysed_ = false;
  touching_ = !touches.empty();
  if (!touching_) return;
  Eigen::SparseMatrix<double> contact(system_.rows(), system_.cols());
  contact.setFromTriplets(entries.begin(), entries.end());
  system_ += contact;
}

template <int dim>
void ElasticSolid<dim>::implicit_acceleration(const State<dim>& state) {
  const auto& particles = state.particles;
  const std::size_t n = network_.movable;
  const auto position = solid_positions(network_, particles.position);
  find_forces(position);
  assemble_tangent(position);
  const double dt = state.clock.time_step;
  system_ = implicit_weight * dt * dt * tangent_;
  for (std::size_t i = 0; i < n * dim; ++i) system_.coeffRef(i, i) += mass_[i / dim];
  Eigen::VectorXd velocity(n * dim), right(n * dim);
  for (std::size_t i = 0; i < n; ++i) {
    velocity.template segment<dim>(i * dim) = particles.velocity[i];
    right.template segment<dim>(i * dim) = force_[i];
  }
  const Eigen::VectorXd ahead = tangent_.template selfadjointView<Eigen::Lower>() * velocity;
  right -= implicit_damping * dt * ahead;
  if (contact_) add_contact(state, right);
  if (!analysed_) {
    factor_.analyzePattern(system_);
    analysed_ = true;
  }
  factor_.factorize(system_);
  if (factor_.info() != Eigen::Success)
    throw std::runtime_error(
        "the implicit spring system cannot be factorised: a spring has collapsed "
        "or a position is not a number");
  const Eigen::VectorXd a = factor_.solve(right);
  for (std::size_t i = 0; i < n; ++i) spring_acceleration_[i] = a.template segment<dim>(i * dim);
}

template <int dim>
std::vector<Vector<dim>> ElasticSolid<dim>::load(const State<dim>& state) const {
  if (integration_ == SpringIntegration::implicit_force) return load_;
  const auto& particles = state.particles;
  std::vector<Vector<dim>> load(network_.movable, Vector<dim>::Zero());
  if (state.clock.step == 0) return load;
  // After the corrector `predicted_velocity` holds the velocity before the step.
  for (std::size_t i = 0; i < network_.movable; ++i)
    load[i] = (particles.velocity[i] - particles.predicted_velocity[i]) / state.clock.time_step -
              spring_acceleration_[i];
  return load;
}

template <int dim>
void ElasticSolid<dim>::constrain(State<dim>& state, const std::vector<Vector<dim>>& old_velocity) {
  auto& particles = state.particles;
  const std::size_t n = network_.movable;
  const double dt = state.clock.time_step;
  Eigen::VectorXd force(n * dim);
  for (std::size_t i = 0; i < n; ++i) {
    load_[i] =
        (particles.velocity[i] - old_velocity[i]) / dt - spring_acceleration_[i] + withheld_[i];
    force.template segment<dim>(i * dim) = mass_[i] * load_[i];
  }
  const Eigen::VectorXd a = factor_.solve(force);
  for (std::size_t i = 0; i < n; ++i) {
    const Vector<dim> carried = a.template segment<dim>(i * dim);
    particles.velocity[i] = old_velocity[i] + dt * (spring_acceleration_[i] + carried);
    withheld_[i] = load_[i] - carried;
  }
  advance_laws(state);
}

template <int dim>
double ElasticSolid<dim>::energy(const Particles<dim>& particles) const {
  const auto position = solid_positions(network_, particles.position);
  double energy = elastic_energy(network_, position);
  if (laws_.empty()) return energy;
  const auto extension = extensions(network_, position);
  for (const auto& law : laws_) energy += law->energy(extension);
  return energy;
}

template class ElasticSolid<2>;
template class ElasticSolid<3>;
template double highest_frequency<2>(const ElasticNetwork<2>&, double);
template double highest_frequency<3>(const ElasticNetwork<3>&, double);

}  // namespace sprung::sph
