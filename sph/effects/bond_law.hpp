#pragma once
/// What a bond does beside its linear spring. A body that names none has none.

#include <cstddef>
#include <span>

namespace sprung::sph {

/// Acts on the bonds `first` to `last` (exclusive) of the network, all those of one body. Spans run
/// over all bonds of the network; extensions are lengths less rest lengths, m.
class BondLaw {
 public:
  BondLaw(std::size_t first, std::size_t last) : first_(first), last_(last) {}
  virtual ~BondLaw() = default;
  /// Adds to the tensions (N; N/m in the plane) and to their slopes over the extension (N/m, not
  /// negative).
  virtual void add_tension(std::span<const double> extension, std::span<double> tension,
                           std::span<double> slope) const = 0;
  /// The largest slope that bond `bond` can come to, N/m.
  virtual double steepest(std::size_t bond) const = 0;
  /// Stored energy, J (J/m in the plane).
  virtual double energy(std::span<const double> extension) const = 0;
  /// The bonds have come from one extension to the next within `time_step` (s).
  virtual void advance(std::span<const double> /*before*/, std::span<const double> /*now*/,
                       double /*time_step*/) {}

 protected:
  std::size_t first_, last_;
};

}  // namespace sprung::sph
