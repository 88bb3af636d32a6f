#include "sph/boundary/open_sides.hpp"

#include "sph/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace sprung::sph {

namespace {

/// Calls `place(x)` for every lattice site of `columns` columns outside the plane.
template <int dim, typename Place>
void for_each_site(const OpenPlane<dim>& plane, const Vector<dim>& low, const Vector<dim>& high,
                   double spacing, int columns, Place&& place) {
  std::array<long, dim> count;
  for (int d = 0; d < dim; ++d)
    count[d] = d == plane.axis ? columns : std::lround((high[d] - low[d]) / spacing);
  for_each_index<dim>(count, [&](const std::array<long, dim>& at) {
    Vector<dim> x;
    for (int d = 0; d < dim; ++d)
      x[d] = d == plane.axis ? plane.place + plane.outward * (at[d] + 0.5) * spacing
                             : low[d] + (at[d] + 0.5) * spacing;
    place(x);
  });
}

}  // namespace

template <int dim>
OpenPlane<dim> open_plane(const Box& channel, Side side) {
  switch (side) {
    case Side::left:
      return {0, -1, channel.from[0]};
    case Side::right:
      return {0, 1, channel.to[0]};
    case Side::bottom:
      return {1, -1, channel.from[1]};
    case Side::top:
      return {1, 1, channel.to[1]};
    case Side::back:
      return {2, -1, channel.from[2]};
    case Side::front:
      return {2, 1, channel.to[2]};
  }
  throw std::logic_error("open_plane: unknown side");
}

template <int dim>
InflowSide<dim>::InflowSide(const Inflow& inflow, const Box& channel, double spacing, double reach)
    : inflow_(inflow),
      plane_(open_plane<dim>(channel, inflow.side)),
      low_(as_vector<dim>(channel.from)),
      high_(as_vector<dim>(channel.to)),
      spacing_(spacing),
      columns_(static_cast<int>(std::ceil(reach / spacing - 1e-9))) {}

template <int dim>
Vector<dim> InflowSide<dim>::velocity_at(const Vector<dim>& x, double time) const {
  const int across = plane_.axis == 0 ? 1 : 0;
  const double speed = inflow_.speed(x[across] - low_[across], high_[across] - low_[across], time);
  Vector<dim> u = Vector<dim>::Zero();
  u[plane_.axis] = -plane_.outward * speed;
  return u;
}

template <int dim>
void InflowSide<dim>::fill(Particles<dim>& particles) const {
  for_each_site<dim>(plane_, low_, high_, spacing_, columns_, [&](const Vector<dim>& x) {
    particles.add(x, velocity_at(x, 0.0), 0.0, Role::inflow);
  });
}

template <int dim>
void InflowSide<dim>::prescribe(std::span<const Role> role, std::span<const Vector<dim>> position,
                                std::span<Vector<dim>> velocity, double time) const {
  for (std::size_t i = 0; i < role.size(); ++i)
    if (role[i] == Role::inflow && owns(position[i])) velocity[i] = velocity_at(position[i], time);
}

namespace {

/// Places of the particles of one role that stand beside a plane, mirrored in it.
template <int dim>
struct Mirrored {
  std::vector<Vector<dim>> place;
  std::vector<std::size_t> particle;

  template <typename Owns>
  Mirrored(const Particles<dim>& particles, Role role, const OpenPlane<dim>& plane, Owns&& owns) {
    for (std::size_t i = particles.unknowns; i < particles.size(); ++i)
      if (particles.role[i] == role && owns(particles.position[i])) {
        Vector<dim> x = particles.position[i];
        x[plane.axis] = 2.0 * plane.place - x[plane.axis];
        place.push_back(x);
        particle.push_back(i);
      }
  }
};

/// Kernel averages at `places` of value(i), a vector, over the unknown particles i within `reach`
/// of the plane.
template <int dim, typename Value>
std::vector<Vector<dim>> averages_near_plane(const Particles<dim>& particles,
                                             const OpenPlane<dim>& plane, double reach,
                                             const std::vector<Vector<dim>>& places,
                                             const Kernel<dim>& kernel, Value&& value) {
  if (places.empty()) return {};
  std::vector<Vector<dim>> points;
  std::vector<std::int32_t> source;
  for (std::size_t i = 0; i < particles.unknowns; ++i)
    if (plane.depth(particles.position[i]) > -reach) {
      points.push_back(particles.position[i]);
      source.push_back(static_cast<std::int32_t>(i));
    }
  std::vector<Vector<dim>> average(places.size(), Vector<dim>::Zero());
  if (points.empty()) return average;
  Support<dim> support;
  support.build_around(kernel, places, points, particles.volume);
  for (std::size_t p = 0; p < places.size(); ++p) {
    double weight = 0.0;
    for (const std::int32_t j : support.of(p).index) {
      const double w = kernel.value((places[p] - points[j]).norm());
      weight += w;
      average[p] += w * value(source[j]);
    }
    if (weight > 0.0) average[p] /= weight;
  }
  return average;
}

}  // namespace

template <int dim>
void InflowSide<dim>::meet_at_plane(Particles<dim>& particles, double time,
                                    const Kernel<dim>& kernel) const {
  const Mirrored<dim> columns(particles, Role::inflow, plane_,
                              [&](const Vector<dim>& x) { return owns(x); });
  const double reach = (columns_ + 1) * spacing_ + kernel.support_radius();
  const auto lacking = averages_near_plane(
      particles, plane_, reach, columns.place, kernel, [&](std::int32_t i) -> Vector<dim> {
        return velocity_at(particles.position[i], time) - particles.predicted_velocity[i];
      });
  for (std::size_t k = 0; k < lacking.size(); ++k)
    particles.predicted_velocity[columns.particle[k]][plane_.axis] += lacking[k][plane_.axis];
}

template <int dim>
void InflowSide<dim>::exchange(Particles<dim>& particles, double time, ParticleBooks& books) const {
  const std::size_t n = particles.size();
  for (std::size_t i = particles.unknowns; i < n; ++i) {
    if (particles.role[i] != Role::inflow || !owns(particles.position[i]) ||
        plane_.depth(particles.position[i]) > 0.0)
      continue;
    particles.role[i] = Role::fluid;
    ++books.entered;
    Vector<dim> x = particles.position[i];
    x[plane_.axis] += plane_.outward * columns_ * spacing_;
    particles.add(x, velocity_at(x, time), 0.0, Role::inflow);
  }
}

template <int dim>
double InflowSide<dim>::flux(double time) const {
  double sum = 0.0;
  for_each_site<dim>(plane_, low_, high_, spacing_, 1, [&](const Vector<dim>& x) {
    sum -= plane_.outward * velocity_at(x, time)[plane_.axis];
  });
  return sum * std::pow(spacing_, dim - 1);
}

template <int dim>
PressureColumns<dim>::PressureColumns(const PressureSide& side, const Box& channel, double spacing,
                                      double reach)
    : side_(side),
      plane_(open_plane<dim>(channel, side.side)),
      low_(as_vector<dim>(channel.from)),
      high_(as_vector<dim>(channel.to)),
      spacing_(spacing),
      columns_(static_cast<int>(std::ceil(reach / spacing - 1e-9))) {}

template <int dim>
void PressureColumns<dim>::fill(Particles<dim>& particles) const {
  for_each_site<dim>(plane_, low_, high_, spacing_, columns_, [&](const Vector<dim>& x) {
    particles.add(x, Vector<dim>::Zero(), 0.0, Role::outflow);
  });
}

template <int dim>
void PressureColumns<dim>::exchange(Particles<dim>& particles, ParticleBooks& books) const {
  std::vector<Vector<dim>> outermost;
  std::vector<Vector<dim>> wanted;
  const std::size_t n = particles.size();
  for (std::size_t i = particles.solids; i < n; ++i) {
    const Vector<dim>& x = particles.position[i];
    if (!owns(x)) continue;
    const bool outside = plane_.depth(x) > 0.0;
    if (particles.role[i] == Role::fluid && outside) {
      particles.role[i] = Role::outflow;
      ++books.left;
    } else if (particles.role[i] == Role::outflow && !outside) {
      particles.role[i] = Role::fluid;
      ++books.returned;
      wanted.push_back(x);
      wanted.back()[plane_.axis] += plane_.outward * depth();
    }
    if (particles.role[i] == Role::outflow && plane_.depth(x) > depth() - 1.5 * spacing_)
      outermost.push_back(x);
  }
  // One that shifting had pushed out for a moment left no gap behind.
  const double room = 0.6 * spacing_;
  for (const auto& x : wanted) {
    const bool taken = std::any_of(outermost.begin(), outermost.end(), [&](const Vector<dim>& y) {
      return (x - y).squaredNorm() < room * room;
    });
    if (!taken) particles.add(x, Vector<dim>::Zero(), 0.0, Role::outflow);
  }
}

template <int dim>
void PressureColumns<dim>::prescribe(Particles<dim>& particles, double time,
                                     const Vector<dim>& balanced) const {
  const double psi = -side_.pressure_at(time) / particles.density;
  for (std::size_t i = particles.unknowns; i < particles.size(); ++i)
    if (particles.role[i] == Role::outflow && owns(particles.position[i])) {
      Vector<dim> x = particles.position[i];
      x[plane_.axis] = plane_.place;
      particles.pseudo_pressure[i] = psi + balanced.dot(x);
    }
}

template <int dim>
void PressureColumns<dim>::copy_velocity(Particles<dim>& particles,
                                         const Kernel<dim>& kernel) const {
  const Mirrored<dim> columns(particles, Role::outflow, plane_,
                              [&](const Vector<dim>& x) { return owns(x); });
  const double reach = depth() + spacing_ + kernel.support_radius();
  const auto velocity = averages_near_plane(particles, plane_, reach, columns.place, kernel,
                                            [&](std::int32_t i) { return particles.velocity[i]; });
  for (std::size_t k = 0; k < velocity.size(); ++k)
    particles.velocity[columns.particle[k]] = velocity[k];
}

template <int dim>
void PressureColumns<dim>::keep_volume(const Particles<dim>& particles,
                                       std::vector<Vector<dim>>& displacement) const {
  for (std::size_t i = particles.unknowns; i < particles.size(); ++i) {
    if (particles.role[i] != Role::outflow || !owns(particles.position[i])) continue;
    const double normal = displacement[i][plane_.axis];
    if (plane_.outward * normal <= 0.0) continue;
    displacement[i] = -displacement[i];
    displacement[i][plane_.axis] = normal;
  }
}

template <int dim>
void sort_by_role(Particles<dim>& particles, const std::vector<bool>& dropped, double cell) {
  const std::size_t n = particles.size();
  std::size_t kept = 0, fluid = 0;
  bool in_order = cell <= 0.0;
  for (std::size_t i = particles.solids; i < n; ++i) {
    if (dropped[i]) {
      in_order = false;
      continue;
    }
    if (particles.role[i] == Role::fluid) {
      in_order = in_order && fluid == kept;
      ++fluid;
    }
    ++kept;
  }
  particles.unknowns = particles.solids + fluid;
  if (in_order) return;  // most steps of a closed domain
  std::vector<std::int32_t> order(particles.solids + kept);
  std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(particles.solids), 0);
  std::size_t next_fluid = particles.solids, next_prescribed = particles.unknowns;
  const auto place = [&](std::int32_t i) {
    if (!dropped[i]) order[particles.role[i] == Role::fluid ? next_fluid++ : next_prescribed++] = i;
  };
  if (cell > 0.0) {
    for (const std::int32_t i :
         Support<dim>::cell_order(particles.position, particles.solids, n, cell))
      place(i);
  } else {
    for (std::size_t i = particles.solids; i < n; ++i) place(static_cast<std::int32_t>(i));
  }
  particles.rearrange(order);
}

template class InflowSide<2>;
template class InflowSide<3>;
template class PressureColumns<2>;
template class PressureColumns<3>;
template OpenPlane<2> open_plane<2>(const Box&, Side);
template OpenPlane<3> open_plane<3>(const Box&, Side);
template void sort_by_role<2>(Particles<2>&, const std::vector<bool>&, double);
template void sort_by_role<3>(Particles<3>&, const std::vector<bool>&, double);

}  // namespace sprung::sph
