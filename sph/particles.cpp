#include "sph/particles.hpp"

namespace sprung::sph {

namespace {

template <typename Value>
void rearrange_array(std::vector<Value>& values, const std::vector<std::int32_t>& order) {
  std::vector<Value> sorted;
  sorted.reserve(values.capacity());
  for (const std::int32_t old : order) sorted.push_back(values[old]);
  values.swap(sorted);
}

}  // namespace

template <int dim>
void Particles<dim>::add(const Vector<dim>& x, const Vector<dim>& u, double psi, Role r) {
  position.push_back(x);
  velocity.push_back(u);
  predicted_velocity.push_back(u);
  pseudo_pressure.push_back(psi);
  role.push_back(r);
  identity.push_back(next_identity++);
  for (auto& array : carried) array.values->push_back(Vector<dim>::Zero());
}

template <int dim>
void Particles<dim>::rearrange(const std::vector<std::int32_t>& order) {
  rearrange_array(position, order);
  rearrange_array(velocity, order);
  rearrange_array(predicted_velocity, order);
  rearrange_array(pseudo_pressure, order);
  rearrange_array(role, order);
  rearrange_array(identity, order);
  for (auto& array : carried) rearrange_array(*array.values, order);
}

template struct Particles<2>;
template struct Particles<3>;

}  // namespace sprung::sph
