#pragma once
/// Physical quantities as a scene file writes them: a number and a unit ("3.75 mm", "0.7 MPa").

#include <stdexcept>
#include <string>
#include <string_view>

namespace sprung {

/// Exponents of kilogram, metre and second; every unit that a scene may use reduces to these three.
struct Dimension {
  int mass = 0;
  int length = 0;
  int time = 0;
  friend bool operator==(const Dimension&, const Dimension&) = default;
};

namespace dimension {
inline constexpr Dimension none{0, 0, 0};
inline constexpr Dimension length{0, 1, 0};
inline constexpr Dimension time{0, 0, 1};
inline constexpr Dimension frequency{0, 0, -1};
inline constexpr Dimension velocity{0, 1, -1};
inline constexpr Dimension acceleration{0, 1, -2};
inline constexpr Dimension density{1, -3, 0};
inline constexpr Dimension pressure{1, -1, -2};
inline constexpr Dimension dynamic_viscosity{1, -1, -1};
}  // namespace dimension

/// What a quantity looks like in words, for error messages: "a length, such as \"3.75 mm\"".
std::string describe(const Dimension& dimension);

/// A text that is not the quantity asked for. what() names the value; reason() is the same without
/// it, for messages that have named it already.
class QuantityError : public std::invalid_argument {
 public:
  QuantityError(const std::string& value, const std::string& reason)
      : std::invalid_argument("\"" + value + "\": " + reason), reason_(reason) {}
  const std::string& reason() const { return reason_; }

 private:
  std::string reason_;
};

/// SI value of `text` ("0.7 MPa" gives 7e5). Units are products and quotients of prefixed symbols
/// with integer exponents: "kg/m3", "Pa s", "mm/s", "m/s2", "1/s", "mmHg". A decimal prefix moves
/// the decimal point before the number is rounded, so "3.75 mm" is exactly 0.00375 and "300 mm"
/// exactly "0.3 m". Throws QuantityError, whose text names the value and the remedy, when the
/// number or the unit cannot be read, the number is not finite, or the dimension is not `expected`.
double parse_quantity(std::string_view text, const Dimension& expected);

}  // namespace sprung
