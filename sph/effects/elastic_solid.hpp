#pragma once
/// Elastic bodies: the springs of Eq. 5 as an acceleration of the solid particles (ACTION 4).

#include "sph/effects/elastic_network.hpp"
#include "sph/effects/roles.hpp"

#include <Eigen/SparseCholesky>

#include <memory>

namespace sprung::sph {

template <int dim>
class ElasticSolid final : public Acceleration<dim>, public TimeStepLimit<dim>, public Remembers {
 public:
  ElasticSolid(ElasticNetwork<dim> network, const Particles<dim>& particles,
               SpringIntegration integration);

  /// Explicit: F(x)/m. Implicit: a = (M + 1/2 dt^2 K)^-1 (F(x) - 1/2 dt^2 K a_e), where K is the positive
  /// part of the tangent and a_e what everything but the springs did to the particle in the step before.
  /// With the new-velocity update this is the leapfrog of a spring whose squared frequency is
  /// w^2/(1 + w^2 dt^2/2), so it is stable for any step and damps nothing; and since a = -a_e solves it
  /// at rest, a lasting load is carried by the true stiffness whatever the step.
  void add_acceleration(const State<dim>& state, std::vector<Vector<dim>>& acceleration) override;

  /// Explicit springs: 0.8 of the limit 2/w_max of the new-velocity update, w_max by power iteration on
  /// K/m at rest. Implicit springs set no limit.
  double largest_time_step(const State<dim>& state) const override;
  std::string limit_name() const override { return "springs, 0.8 x 2/omega_max"; }

  void save(Archive& archive) const override;
  void restore(const Archive& archive) override;

  const ElasticNetwork<dim>& network() const { return network_; }
  /// Acceleration that the springs gave in the last step, m/s2, one per solid.
  const std::vector<Vector<dim>>& spring_acceleration() const { return spring_acceleration_; }
  double energy(const Particles<dim>& particles) const;

 private:
  void assemble_tangent(std::span<const Vector<dim>> position);
  void implicit_acceleration(const State<dim>& state);

  ElasticNetwork<dim> network_;
  double mass_;
  SpringIntegration integration_;
  double highest_frequency_;
  std::vector<Vector<dim>> force_;
  std::vector<Vector<dim>> spring_acceleration_;
  std::vector<Vector<dim>> previous_velocity_;
  Eigen::SparseMatrix<double> tangent_;  ///< lower triangle of K
  Eigen::SparseMatrix<double> system_;   ///< lower triangle of M + 1/2 dt^2 K
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
  bool analysed_ = false;
};

/// Highest angular frequency (rad/s) of the network at rest with `mass` (kg) at each node.
template <int dim>
double highest_frequency(const ElasticNetwork<dim>& network, double mass);

}  // namespace sprung::sph
