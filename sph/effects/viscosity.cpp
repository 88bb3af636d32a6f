#include "sph/effects/viscosity.hpp"

#include <algorithm>
#include <cmath>

namespace sprung::sph {

template <int dim, class Law>
ViscosityEffect<dim, Law>::ViscosityEffect(double kinematic_viscosity, Particles<dim>& particles,
                                           std::shared_ptr<SolidSurface<dim>> surface, Law law)
    : nu_(kinematic_viscosity),
      law_(std::move(law)),
      surface_(std::move(surface)),
      previous_diffusion_(particles.size(), Vector<dim>::Zero()) {
  particles.carried.push_back({"previous_diffusion", &previous_diffusion_});
}

template <int dim, class Law>
void ViscosityEffect<dim, Law>::add_acceleration(const State<dim>& state,
                                                 std::vector<Vector<dim>>& acceleration) {
  const auto& particles = state.particles;
  auto& extended = state.extended_velocity;
  if constexpr (requires { Law::diffusion_is_laplacian; })
    state.images.extend_for_viscosity(particles.velocity, previous_diffusion_, -1.0 / nu_,
                                      extended);
  else
    state.images.extend_for_viscosity(particles.velocity, extended);
  // Adams-Bashforth for a step that may differ from the one before; 3/2 and 1/2 for equal steps.
  // The first step has no past and is taken forward in time.
  const Clock& clock = state.clock;
  const double ratio =
      clock.previous_time_step > 0.0 ? clock.time_step / clock.previous_time_step : 0.0;
  const double now = 1.0 + 0.5 * ratio, before = 0.5 * ratio;
  // (x_i - x_j) . grad W / d^2 = F, so Eq. 2's D_i = -sum V 2 nu F (u_i - u_j); equal densities.
  const double scale = -2.0 * nu_ * particles.volume;
  const std::size_t n = particles.unknowns;
  if (surface_) {
    surface_->update(state);
    diffusion_before_ = previous_diffusion_;
    moment_.assign(particles.solids, Eigen::Matrix<double, dim, dim>::Zero());
  }
  law_.update(state, extended);
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    const auto neighbours = state.support.of(i);
    const Vector<dim> u_i = extended[i];
    Vector<dim> sum = Vector<dim>::Zero();
    if (state.laplacian_correction.empty())
      for (std::size_t k = 0; k < neighbours.index.size(); ++k)
        sum += law_.of_pair(state, i, neighbours.index[k]) * neighbours.gradient_factor[k] *
               (u_i - extended[neighbours.index[k]]);
    else
      sum = corrected_sum(state, i, neighbours);
    if (surface_)
      sum += beyond_surface(state, i, neighbours, i < particles.solids ? &moment_[i] : nullptr);
    Vector<dim> diffusion = scale * sum;
    if constexpr (requires { law_.beside(i); }) diffusion -= nu_ * law_.beside(i);
    acceleration[i] -= now * diffusion - before * previous_diffusion_[i];
    previous_diffusion_[i] = diffusion;
  }
  if (!surface_) return;
  surface_->carry_out(moment_, carried_);
  for (std::size_t i = 0; i < particles.solids; ++i) {
    acceleration[i] -= now * scale * carried_[i];
    previous_diffusion_[i] += scale * carried_[i];
  }
}

/// Each pair's term times e . (A_i + A_j)/2 e: symmetric, so momentum is kept, and of the right
/// size on any distribution.
template <int dim, class Law>
Vector<dim> ViscosityEffect<dim, Law>::corrected_sum(
    const State<dim>& state, std::size_t i, const typename Support<dim>::Neighbours& near) const {
  const auto& points = state.images.points();
  const auto& correction = state.laplacian_correction;
  const auto& extended = state.extended_velocity;
  const SymmetricMatrix<dim> own = correction[i];
  const Vector<dim> x = points[i], u = extended[i];
  TwoVectors<dim> both{};
  for_each_two<dim>(near, [&](Two f, const auto& j) {
    const TwoVectors<dim> r = difference(x, points, j);
    const auto form =
        sums(own, correction, {state.images.source(j[0]), state.images.source(j[1])}).form(r);
    const Two viscosity{law_.of_pair(state, i, j[0]), law_.of_pair(state, i, j[1])};
    Two square = r[0] * r[0];
    for (int d = 1; d < dim; ++d) square += r[d] * r[d];
    const Two weight = 0.5 * viscosity * f * form / square;
    const TwoVectors<dim> du = difference(u, extended, j);
    for (int d = 0; d < dim; ++d) both[d] += weight * du[d];
  });
  return sum_of<dim>(both);
}

/// What the pairs across a body's surface lack when the solid particle's own velocity is taken at
/// its place: the fluid's velocity is carried on beyond the surface, a straight line through the
/// body's and bent as the fluid's last Laplacian says (the walls' images do the same). `moment`: of
/// the fluid's pull at a solid particle, force times the arm from the particle to the surface.
template <int dim, class Law>
Vector<dim> ViscosityEffect<dim, Law>::beyond_surface(
    const State<dim>& state, std::size_t i, const typename Support<dim>::Neighbours& near,
    Eigen::Matrix<double, dim, dim>* moment) const {
  const auto& particles = state.particles;
  const auto& points = state.images.points();
  const bool solid = i < particles.solids;
  Vector<dim> sum = Vector<dim>::Zero();
  for (std::size_t k = 0; k < near.index.size(); ++k) {
    const auto j = static_cast<std::size_t>(near.index[k]);
    if (j >= particles.unknowns || (j < particles.solids) == solid) continue;
    const std::size_t f = solid ? j : i, s = solid ? i : j;
    const Vector<dim> r = points[f] - points[s];
    const Vector<dim> own = state.extended_velocity[i] - state.extended_velocity[j];
    Vector<dim> across = surface_->reach(f, r) * own;
    if constexpr (requires { Law::diffusion_is_laplacian; })
      across += (solid ? -1.0 : 1.0) / nu_ * surface_->bend(f, r) * diffusion_before_[f];
    double weight = law_.of_pair(state, i, near.index[k]) * near.gradient_factor[k];
    if (!state.laplacian_correction.empty())
      weight *= 0.5 *
                (state.laplacian_correction[i].form(r) + state.laplacian_correction[j].form(r)) /
                r.squaredNorm();
    const Vector<dim> pull = weight * across, counted = weight * own;
    sum += pull - counted;
    if (moment) *moment += pull * surface_->arm(f, s).transpose();
  }
  return sum;
}

/// What the pairs across bodies' surfaces add to the fastest decay (1/s), at most: the largest sum
/// of both particles' rates over these pairs (Anderson & Morley 1985, Linear Multilinear Algebra
/// 18, for a graph's Laplacian). A fluid particle a quarter of a spacing from a face feels pairs up
/// to five times as strong as elsewhere.
template <int dim, class Law>
double ViscosityEffect<dim, Law>::rate_beyond_surface(const State<dim>& state) const {
  surface_->update(state);
  const auto& particles = state.particles;
  const auto& points = state.images.points();
  rate_.assign(particles.unknowns, 0.0);
  const double scale = -2.0 * nu_ * law_.largest_ratio() * particles.volume;
  const auto for_each_pair = [&](const auto& use) {
    for (std::size_t s = 0; s < particles.solids; ++s) {
      const auto near = state.support.of(s);
      for (std::size_t k = 0; k < near.index.size(); ++k) {
        const auto f = static_cast<std::size_t>(near.index[k]);
        if (f < particles.solids || f >= particles.unknowns) continue;
        const double more = surface_->reach(f, points[f] - points[s]) - 1.0;
        if (more > 0.0) use(s, f, scale * near.gradient_factor[k] * more);
      }
    }
  };
  for_each_pair([&](std::size_t s, std::size_t f, double pair) {
    rate_[s] += pair;
    rate_[f] += pair;
  });
  double most = 0.0;
  for_each_pair(
      [&](std::size_t s, std::size_t f, double) { most = std::max(most, rate_[s] + rate_[f]); });
  return most;
}

template <int dim, class Law>
FastestMode ViscosityEffect<dim, Law>::fastest_mode(const State<dim>& state) const {
  const auto sums = lattice_sums(state.kernel, state.particles.spacing);
  const double on_lattice = 2.0 * nu_ * law_.largest_ratio() * sums.fastest_decay;
  return {on_lattice + (surface_ ? rate_beyond_surface(state) : 0.0), 0.0};
}

template class ViscosityEffect<2, Newtonian<2>>;
template class ViscosityEffect<3, Newtonian<3>>;
template class ViscosityEffect<2, CarreauYasudaLaw<2>>;
template class ViscosityEffect<3, CarreauYasudaLaw<3>>;

}  // namespace sprung::sph
