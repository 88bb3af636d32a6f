#include "calibration/tensile_test.hpp"

#include "calibration/equilibrium.hpp"
#include "calibration/surface_layer.hpp"
#include "sph/simulation.hpp"
#include "sph/time_step.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <Eigen/Dense>

namespace sprung::calibration {

namespace {

/// A dead force on each particle and a damping that is the same for all: brings a body to rest.
template <int dim>
class DampedLoad final : public sph::Acceleration<dim> {
 public:
  /// `acceleration` in m/s2, one per particle; `damping` in 1/s.
  DampedLoad(std::vector<Vector<dim>> acceleration, double damping)
      : load_(std::move(acceleration)), damping_(damping) {}
  void add_acceleration(const sph::State<dim>& state,
                        std::vector<Vector<dim>>& acceleration) override {
    for (std::size_t i = 0; i < load_.size(); ++i)
      acceleration[i] += load_[i] - damping_ * state.particles.velocity[i];
  }

 private:
  std::vector<Vector<dim>> load_;
  double damping_;
};

template <int dim>
std::array<int, dim> cube(int layers) {
  std::array<int, dim> count;
  count.fill(layers);
  return count;
}

/// Force on each particle, N (N/m in the plane): + load on the last layer, - load on the first.
template <int dim>
std::vector<Vector<dim>> end_forces(double load, const std::array<int, dim>& count,
                                    double spacing) {
  std::size_t particles = 1;
  for (const int n : count) particles *= static_cast<std::size_t>(n);
  std::vector<Vector<dim>> force(particles, Vector<dim>::Zero());
  const double size = load * spring_stiffness * std::pow(spacing, dim - 1);
  for (std::size_t i = 0; i < force.size(); ++i) {
    const int along = lattice_place<dim>(i, count)[0];
    if (along == 0) force[i][0] = -size;
    if (along == count[0] - 1) force[i][0] = size;
  }
  return force;
}

/// Makes the displacement from `rest` that of a body in even load: mirrored about each axis's
/// middle it is the same. A free body that is pushed by forces of fixed direction turns over if it
/// is let (a rotation gains work), from nothing but rounding.
template <int dim>
void make_even(const std::vector<Vector<dim>>& rest, const std::array<int, dim>& count,
               std::vector<Vector<dim>>& position) {
  std::size_t stride = 1;
  for (int axis = 0; axis < dim; ++axis) {
    const int n = count[axis];
    for (std::size_t i = 0; i < position.size(); ++i) {
      const int across = n - 1 - 2 * lattice_place<dim>(i, count)[axis];
      if (across < 0) continue;
      const std::size_t j = i + static_cast<std::size_t>(across) * stride;
      const Vector<dim> a = position[i] - rest[i], b = position[j] - rest[j];
      Vector<dim> even = 0.5 * (a + b);
      even[axis] = 0.5 * (a[axis] - b[axis]);
      position[i] = rest[i] + even;
      even[axis] = -even[axis];
      position[j] = rest[j] + even;
    }
    stride *= static_cast<std::size_t>(n);
  }
}

/// Change of the distance between two layers over the distance at rest.
template <int dim>
double strain_between(const std::vector<Vector<dim>>& rest, const std::vector<Vector<dim>>& now,
                      int layers, int margin) {
  const auto count = cube<dim>(layers);
  double sum = 0.0;
  int per_layer = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const int along = lattice_place<dim>(i, count)[0];
    const double u = now[i][0] - rest[i][0];
    if (along == margin) sum -= u;
    if (along == layers - 1 - margin) {
      sum += u;
      ++per_layer;
    }
  }
  const double spacing = side / layers;
  return sum / per_layer / ((layers - 1 - 2 * margin) * spacing);
}

/// Mean gradient du_d/dx_d over the cells of the core, from the displacement of its two faces
/// across `axis` (trapezoidal rule, exact for the lattice's cells).
template <int dim>
double mean_strain(const std::vector<Vector<dim>>& rest, const std::vector<Vector<dim>>& now,
                   int layers, int margin, int axis) {
  const auto count = cube<dim>(layers);
  const int last = layers - 1 - margin;
  double difference = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto place = lattice_place<dim>(i, count);
    if (place[axis] != margin && place[axis] != last) continue;
    double weight = 1.0;
    for (int d = 0; d < dim; ++d) {
      if (d == axis) continue;
      if (place[d] < margin || place[d] > last) weight = 0.0;
      if (place[d] == margin || place[d] == last) weight *= 0.5;
    }
    const double u = weight * (now[i][axis] - rest[i][axis]);
    difference += place[axis] == last ? u : -u;
    if (place[axis] == last) weights += weight;
  }
  return difference / weights / ((last - margin) * side / layers);
}

/// Poisson's ratio of the core that begins `margin` layers from every face: mean over its cells.
template <int dim>
double core_poisson_ratio(const std::vector<Vector<dim>>& rest, const std::vector<Vector<dim>>& now,
                          int layers, int margin) {
  double lateral = 0.0;
  for (int axis = 1; axis < dim; ++axis)
    lateral += mean_strain<dim>(rest, now, layers, margin, axis) / (dim - 1);
  return poisson_ratio(dim, mean_strain<dim>(rest, now, layers, margin, 0), lateral);
}

template <int dim>
PulledBlock measure(const std::vector<Vector<dim>>& rest, const std::vector<Vector<dim>>& now,
                    int layers) {
  const int margin = layers / 4;
  PulledBlock result;
  result.strain_ends = strain_between<dim>(rest, now, layers, 0);
  result.strain_inner = strain_between<dim>(rest, now, layers, margin);
  using Square = Eigen::Matrix<double, dim, dim>;
  const auto count = cube<dim>(layers);
  const Vector<dim> centre = Vector<dim>::Constant(0.5 * side);
  Square moment = Square::Zero(), product = Square::Zero();
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const auto place = lattice_place<dim>(i, count);
    bool core = true;
    for (const int p : place) core = core && p >= margin && p <= layers - 1 - margin;
    if (!core) continue;
    const Vector<dim> x = rest[i] - centre;
    moment += x * x.transpose();
    product += (now[i] - rest[i]) * x.transpose();
  }
  const Square gradient = product * moment.inverse();
  result.core_axial = gradient(0, 0);
  result.core_lateral = (gradient.trace() - gradient(0, 0)) / (dim - 1);
  result.mean_axial = mean_strain<dim>(rest, now, layers, margin, 0);
  for (int axis = 1; axis < dim; ++axis)
    result.mean_lateral += mean_strain<dim>(rest, now, layers, margin, axis) / (dim - 1);
  return result;
}

/// A block in vacuum under a dead load, with damping that brings it to rest.
template <int dim>
class LoadedBlock {
 public:
  LoadedBlock(const Material& material, const Pull& pull, double block_density) : pull_(pull) {
    const double spacing = side / pull.layers;
    auto particles = block<dim>(cube<dim>(pull.layers), spacing);
    particles.density = block_density;
    rest_ = particles.position;
    mass_ = particles.mass();
    auto network = network_of<dim>(particles, shape_of<dim>(cube<dim>(pull.layers), spacing),
                                   material, pull.surface_correction);
    const double wave_speed = std::sqrt(spring_stiffness / block_density);
    const bool implicit = material.area_stiffness > 0.0;
    auto springs = std::make_unique<sph::ElasticSolid<dim>>(
        std::move(network), particles,
        implicit ? sph::SpringIntegration::implicit_force : sph::SpringIntegration::explicit_force);
    springs_ = springs.get();
    auto load = end_forces<dim>(pull.load, cube<dim>(pull.layers), spacing);
    for (auto& f : load) f /= mass_;
    // Half of critical for the slowest stretching mode, omega = pi c / L, c = sqrt(3 k_e/rho) or
    // more slowly.
    damping_ = 1.5 * std::numbers::pi * wave_speed * std::sqrt(dim == 2 ? 2.0 : 3.0) / side;
    simulation_ = std::make_unique<sph::Simulation<dim>>(
        numerics(material, pull), std::move(particles), sph::Images<dim>({}));
    auto& effects = simulation_->effects();
    if (implicit)
      effects.constraints.push_back(springs_);
    else
      effects.limits.push_back(springs_);
    effects.body_forces.push_back(std::move(springs));
    effects.body_forces.push_back(std::make_unique<DampedLoad<dim>>(std::move(load), damping_));
    simulation_->stand_in_vacuum();
    simulation_->start(wave_speed, implicit ? 0.7 * spacing / wave_speed : 0.0);
    partition_ = simulation_->state().support.partition();
  }

  /// Steps until the strain changes by less than the tolerance over a decay time.
  PulledBlock come_to_rest() {
    const int window =
        static_cast<int>(2.0 / (damping_ * simulation_->chosen_time_step().value)) + 1;
    double before = 0.0;
    for (int steps = 1; steps <= 200 * window; ++steps) {
      sph::advance(*simulation_);
      if (steps % window != 0) continue;
      PulledBlock result = measured();
      if (!std::isfinite(result.strain_ends)) break;
      if (std::abs(result.strain_ends - before) < pull_.tolerance * std::abs(result.strain_ends)) {
        result.steps = steps;
        double fastest = 0.0;
        for (const auto& u : simulation_->state().particles.velocity)
          fastest = std::max(fastest, u.norm());
        result.unbalanced =
            fastest * damping_ * mass_ /
            (std::abs(pull_.load) * spring_stiffness * std::pow(side / pull_.layers, dim - 1));
        return result;
      }
      before = result.strain_ends;
    }
    throw std::runtime_error(fmt::format("tensile test, {}D, {} layers, load {}: not at rest", dim,
                                         pull_.layers, pull_.load));
  }

  void hold(double seconds) {
    const double end = simulation_->state().clock.time + seconds;
    while (simulation_->state().clock.time < end) sph::advance(*simulation_);
  }

  PulledBlock measured() const {
    return measure<dim>(rest_, simulation_->state().particles.position, pull_.layers);
  }
  SurfaceLayer layer_by_layer(const PulledBlock& block) const {
    const auto& position = simulation_->state().particles.position;
    const int n = pull_.layers;
    SurfaceLayer result;
    result.block = block;
    result.courant =
        simulation_->chosen_time_step().value * simulation_->velocity_scale() * n / side;
    // Index of the particle `m` layers below the face y = 0, in the middle of the other axes.
    const auto below = [&](int m) {
      const int middle = n / 2;
      return static_cast<std::size_t>(dim == 3 ? middle + n * (m + n * middle) : middle + n * m);
    };
    for (int m = 0; m < n / 2; ++m) {
      const double now = simulation_->state().support.partition()[below(m)];
      result.density_error.push_back((now / partition_[below(m)] - 1.0) / block.mean_axial);
      if (2 * m < n - 2)
        result.poisson_ratio.push_back(core_poisson_ratio<dim>(rest_, position, n, m));
    }
    return result;
  }
  double volume() const {
    const auto& position = simulation_->state().particles.position;
    double volume = 0.0;
    std::array<Vector<dim>, 1 << dim> corner, gradient;
    for (const auto& cell : springs_->network().body_cells) {
      for (std::size_t c = 0; c < corner.size(); ++c) corner[c] = position[cell[c]];
      volume += sph::cell_volume(corner, gradient);
    }
    return volume;
  }

 private:
  static sph::Numerics numerics(const Material& material, const Pull& pull) {
    sph::Numerics numerics;
    numerics.smoothing_length_ratio = pull.smoothing_length_ratio;
    numerics.normalised_gradient = true;
    numerics.position_update = sph::PositionUpdate::new_velocity;
    // A wrong volume is corrected at the rate c/(2 dx), within a few steps; volume springs do so
    // themselves.
    numerics.density_feedback = material.area_stiffness > 0.0 ? 0.0 : pull.density_feedback;
    numerics.pressure_tolerance = 1e-8;
    numerics.pressure_solver = sph::PressureSolverKind::two_level;
    numerics.bonds = material.bonds;
    numerics.area_stiffness = material.area_stiffness;
    numerics.courant = 1.0;
    return numerics;
  }

  Pull pull_;
  std::vector<Vector<dim>> rest_;
  std::vector<double> partition_;  ///< kernel sums at rest
  double mass_ = 0.0, damping_ = 0.0;
  sph::ElasticSolid<dim>* springs_ = nullptr;
  std::unique_ptr<sph::Simulation<dim>> simulation_;
};

}  // namespace

double poisson_ratio(int dimension, double axial, double lateral) {
  const double r = -std::log1p(lateral) / std::log1p(axial);
  return dimension == 2 ? r / (1.0 + r) : r;
}

template <int dim>
double kernel_sum_poisson_ratio(double smoothing_length_ratio, double axial) {
  const sph::Kernel<dim> kernel(smoothing_length_ratio);
  const int reach = static_cast<int>(std::ceil(4.0 * smoothing_length_ratio));
  const auto sum = [&](double stretch, double lateral) {
    double total = 0.0;
    std::array<int, dim> count;
    count.fill(2 * reach + 1);
    const auto sites = static_cast<std::size_t>(std::lround(std::pow(2 * reach + 1, dim)));
    for (std::size_t i = 0; i < sites; ++i) {
      const auto place = lattice_place<dim>(i, count);
      double square = std::pow(stretch * (place[0] - reach), 2);
      for (int d = 1; d < dim; ++d) square += std::pow(lateral * (place[d] - reach), 2);
      const double r = std::sqrt(square);
      if (r < kernel.support_radius()) total += kernel.value(r);
    }
    return total;
  };
  const double at_rest = sum(1.0, 1.0);
  double low = 0.5, high = 2.0;  // of the lateral stretch; the sum falls with it
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (sum(1.0 + axial, middle) > at_rest ? low : high) = middle;
  }
  return poisson_ratio(dim, axial, 0.5 * (low + high) - 1.0);
}

template <int dim>
PulledBlock pull_by_particle_solver(const Material& material, const Pull& pull) {
  return LoadedBlock<dim>(material, pull, density).come_to_rest();
}

template <int dim>
SurfaceLayer measure_surface_layer(const Material& material, const Pull& pull) {
  LoadedBlock<dim> loaded(material, pull, density);
  return loaded.layer_by_layer(loaded.come_to_rest());
}

template <int dim>
HeldBlock hold_block(const Material& material, const Pull& pull, double seconds) {
  LoadedBlock<dim> loaded(material, pull, 0.1 * spring_stiffness);
  HeldBlock result;
  const PulledBlock before = loaded.come_to_rest();
  const double volume = loaded.volume();
  loaded.hold(seconds);
  const PulledBlock after = loaded.measured();
  result.poisson_ratio_before = poisson_ratio(dim, before.mean_axial, before.mean_lateral);
  result.poisson_ratio_after = poisson_ratio(dim, after.mean_axial, after.mean_lateral);
  result.strain_before = before.mean_axial;
  result.strain_after = after.mean_axial;
  result.volume_drift = (loaded.volume() / volume - 1.0) / seconds;
  result.seconds = seconds;
  return result;
}

template <int dim>
PulledBlock pull_network(const Material& material, const Pull& pull) {
  const double spacing = side / pull.layers;
  const auto count = cube<dim>(pull.layers);
  auto particles = block<dim>(count, spacing);
  const auto rest = particles.position;
  const auto network =
      network_of<dim>(particles, shape_of<dim>(count, spacing), material, pull.surface_correction);
  double unbalanced = 0.0;
  for (int step = 1; step <= pull.load_steps; ++step)
    unbalanced = find_equilibrium<dim>(
        network, particles, end_forces<dim>(pull.load * step / pull.load_steps, count, spacing),
        1e-8, [&](std::vector<Vector<dim>>& position) { make_even<dim>(rest, count, position); });
  PulledBlock result = measure<dim>(rest, particles.position, pull.layers);
  result.unbalanced = unbalanced;
  return result;
}

template <int dim>
std::vector<double> pull_bar(const Material& material, int layers,
                             const std::vector<double>& loads) {
  std::array<int, dim> count = cube<dim>(layers);
  count[0] = 4 * layers;
  const double spacing = side / count[0];
  auto particles = block<dim>(count, spacing);
  const auto rest = particles.position;
  const auto network = network_of<dim>(particles, shape_of<dim>(count, spacing), material, true);
  const auto mean_place = [&](int along) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i)
      if (lattice_place<dim>(i, count)[0] == along) sum += particles.position[i][0];
    return sum * count[0] / static_cast<double>(rest.size());
  };
  std::vector<double> stretches;
  for (const double load : loads) {
    // Bonds that push lose part of their tangent, so the last digits would come slowly.
    find_equilibrium<dim>(
        network, particles, end_forces<dim>(load, count, spacing), 1e-5,
        [&](std::vector<Vector<dim>>& position) { make_even<dim>(rest, count, position); });
    stretches.push_back((mean_place(3 * layers - 1) - mean_place(layers)) /
                        ((2 * layers - 1) * spacing));
  }
  return stretches;
}

template double kernel_sum_poisson_ratio<2>(double, double);
template double kernel_sum_poisson_ratio<3>(double, double);
template PulledBlock pull_by_particle_solver<2>(const Material&, const Pull&);
template PulledBlock pull_by_particle_solver<3>(const Material&, const Pull&);
template SurfaceLayer measure_surface_layer<2>(const Material&, const Pull&);
template SurfaceLayer measure_surface_layer<3>(const Material&, const Pull&);
template HeldBlock hold_block<2>(const Material&, const Pull&, double);
template HeldBlock hold_block<3>(const Material&, const Pull&, double);
template std::vector<double> pull_bar<2>(const Material&, int, const std::vector<double>&);
template std::vector<double> pull_bar<3>(const Material&, int, const std::vector<double>&);
template PulledBlock pull_network<2>(const Material&, const Pull&);
template PulledBlock pull_network<3>(const Material&, const Pull&);

}  // namespace sprung::calibration
