#pragma once
/// Elastic bodies: the springs of Eq. 5 as an acceleration of the solid particles (ACTION 4).

#include "sph/effects/bond_law.hpp"
#include "sph/effects/contact.hpp"
#include "sph/effects/elastic_network.hpp"
#include "sph/effects/roles.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>

#include <memory>
#include <type_traits>

namespace sprung::sph {

template <int dim>
class ElasticSolid final : public Acceleration<dim>,
                           public Constraint<dim>,
                           public TimeStepLimit<dim> {
 public:
  /// With implicit springs an array is carried with the `particles`, so the body must outlive them.
  ElasticSolid(ElasticNetwork<dim> network, Particles<dim>& particles,
               SpringIntegration integration);

  /// Explicit: F(x)/m. Implicit: H F/m with H = (M + g dt^2 K)^-1 M, K the positive part of the
  /// tangent, and F taken at x + a dt u (g = 1/2, a = 1/10); and what constrain() withheld.
  void add_acceleration(const State<dim>& state, std::vector<Vector<dim>>& acceleration) override;

  /// Implicit springs: what pressure and viscosity did to the body passes through H too, so that
  /// the whole step is (M + g dt^2 K) du/dt = F + f. A lasting load is then carried by the true
  /// stiffness whatever the step, and the noise of the pressure does not shake the stiff modes,
  /// whose dt^2 f/m would otherwise be added to the positions unopposed. With the new-velocity
  /// update an undamped spring becomes the leapfrog of squared frequency w^2/(1 + g w^2 dt^2),
  /// stable for any step; `a` damps a mode by the ratio a w dt/2 and the stiffest by sqrt(1 - a/g)
  /// per step.
  ///
  /// The pressure equation takes the body for free fluid and learns nothing of (H - 1) f/m, by
  /// which the springs then hold the body back; the fluid beside it goes on as if it had not been.
  /// With a fluid of several times the body's mass moving along, that damps a body's vibrations by
  /// ratios of the order of w dt m_fluid/m_body. The next step's prediction therefore holds this
  /// step's (H - 1) f/m; only its change from step to step comes late then. For a mode that dt^2 K
  /// stiffens without limit, pressure and body settle by (m_fluid/(m_fluid + m_body))^(1/2) per
  /// step.
  void constrain(State<dim>& state, const std::vector<Vector<dim>>& old_velocity) override;

  /// omega_max of K/m at rest. Implicit springs set no limit and are not asked.
  FastestMode fastest_mode(const State<dim>&) const override { return {0.0, highest_frequency_}; }
  std::string_view limit_name() const override { return "springs"; }

  /// Bonds of a body do something beside their linear spring. Before the first step; explicit
  /// springs take shorter steps for it.
  void add(std::unique_ptr<BondLaw> law);
  /// Bodies meet others or walls: with implicit springs only. Backward Euler: the force is that
  /// where the step ends, k (overlap - dt^2 g . du/dt) g for each touch, g the gap's gradient, so
  /// that what meets loses energy and never gains any.
  void add(std::unique_ptr<Contact<dim>> contact) { contact_ = std::move(contact); }

  const ElasticNetwork<dim>& network() const { return network_; }
  /// Of solid i, kg (kg/m in the plane): what its cell holds. A body with fitted places has cells
  /// of another size than the fluid, and the pressure's gradient pushes the whole of them.
  double mass(std::size_t i) const { return mass_[i]; }
  /// Acceleration that all but the springs gave in the last step, m/s2, one per solid.
  std::vector<Vector<dim>> load(const State<dim>& state) const;
  /// Stored in the bodies, J (J/m in the plane), contact's layer not among it.
  double energy(const Particles<dim>& particles) const;
  bool meets_others() const { return contact_ != nullptr; }
  /// Stored in the layer between what touches; see Contact.
  double contact_energy(const State<dim>& state) const {
    return contact_ ? contact_->energy(state) : 0.0;
  }

 private:
  /// Forces of the network and of the bonds' laws on the nodes, into force_; tension_ and slope_
  /// go along.
  void find_forces(std::span<const Vector<dim>> position);
  void advance_laws(const State<dim>& state);
  void assemble_tangent(std::span<const Vector<dim>> position);
  void implicit_acceleration(const State<dim>& state);
  void add_contact(const State<dim>& state, Eigen::VectorXd& right);

  ElasticNetwork<dim> network_;
  double density_;
  std::vector<double> mass_;
  SpringIntegration integration_;
  double highest_frequency_;
  std::vector<Vector<dim>> force_;
  std::vector<Vector<dim>> spring_acceleration_;
  std::vector<Vector<dim>> load_;
  /// (1 - H) f/m of the last step, m/s2, of all particles (0 beyond the body's); empty with
  /// explicit springs.
  std::vector<Vector<dim>> withheld_;
  std::vector<double> tension_;
  std::vector<std::unique_ptr<BondLaw>> laws_;
  std::vector<double> slope_;  ///< that the laws add to the bonds' own; empty without laws
  Eigen::SparseMatrix<double> tangent_;  ///< lower triangle of K
  Eigen::SparseMatrix<double> system_;   ///< lower triangle of M + g dt^2 K
  /// In space the factors are dense enough for CHOLMOD's supernodes to be several times faster.
  std::conditional_t<dim == 3,
                     Eigen::CholmodSupernodalLLT<Eigen::SparseMatrix<double>, Eigen::Lower>,
                     Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>>
      factor_;
  bool analysed_ = false;
  std::unique_ptr<Contact<dim>> contact_;  ///< null where the scene does not call for it
  bool touching_ = false;                  ///< in the last step, by its system's pattern
};

/// Highest angular frequency (rad/s) of the network at rest, each node with its cell's mass at
/// `density` (kg/m3).
template <int dim>
double highest_frequency(const ElasticNetwork<dim>& network, double density);

}  // namespace sprung::sph
