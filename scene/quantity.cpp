#include "scene/quantity.hpp"

#include "scene/spelling.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

namespace sprung {
namespace {

struct KnownDimension {
  Dimension dimension;
  const char* name = nullptr;     // with its article
  const char* example = nullptr;  // as a scene file writes it
};

constexpr std::array known_dimensions{
    KnownDimension{dimension::length, "a length", "3.75 mm"},
    KnownDimension{dimension::time, "a time", "0.2 s"},
    KnownDimension{dimension::frequency, "a frequency", "5 Hz"},
    KnownDimension{dimension::velocity, "a velocity", "0.5 m/s"},
    KnownDimension{dimension::acceleration, "an acceleration", "9.81 m/s2"},
    KnownDimension{dimension::density, "a density", "1000 kg/m3"},
    KnownDimension{dimension::pressure, "a pressure", "0.7 MPa"},
    KnownDimension{dimension::dynamic_viscosity, "a dynamic viscosity", "1 Pa s"},
    KnownDimension{{1, 0, 0}, "a mass", "1 kg"},
    KnownDimension{{0, 2, 0}, "an area", "1 m2"},
    KnownDimension{{0, 3, 0}, "a volume", "1 m3"},
    KnownDimension{{0, 2, -1}, "a kinematic viscosity", "1 mm2/s"},
    KnownDimension{{0, 3, -1}, "a volume flow", "1 m3/s"},
    KnownDimension{{1, 1, -2}, "a force", "1 N"},
    KnownDimension{{1, 0, -2}, "a force per length", "1 N/m"},
    KnownDimension{{1, 2, -2}, "an energy", "1 J"},
    KnownDimension{{1, 2, -3}, "a power", "1 W"},
};

const KnownDimension* find(const Dimension& dimension) {
  for (const auto& known : known_dimensions)
    if (known.dimension == dimension) return &known;
  return nullptr;
}

std::string name_of(const Dimension& dimension) {
  if (dimension == dimension::none) return "a plain number";
  if (const auto* known = find(dimension)) return known->name;
  std::string text = "a quantity in";
  const auto factor = [&](const char* symbol, int exponent) {
    if (exponent == 0) return;
    text += std::string(" ") + symbol;
    if (exponent != 1) text += std::to_string(exponent);
  };
  factor("kg", dimension.mass);
  factor("m", dimension.length);
  factor("s", dimension.time);
  return text;
}

/// One unit is `factor` x 10^`power_of_ten` in kg, m and s. The power is kept apart so that it can
/// be joined to the decimal number before rounding.
struct Unit {
  Dimension dimension;
  int power_of_ten = 0;
  double factor = 1.0;
};

struct Symbol {
  const char* text = nullptr;
  Unit unit;
  bool takes_prefix = false;
};

constexpr std::array symbols{
    Symbol{"m", {{0, 1, 0}}, true},
    Symbol{"g", {{1, 0, 0}, -3}, true},
    Symbol{"s", {{0, 0, 1}}, true},
    Symbol{"min", {{0, 0, 1}, 0, 60.0}, false},
    Symbol{"Hz", {{0, 0, -1}}, true},
    Symbol{"N", {{1, 1, -2}}, true},
    Symbol{"dyn", {{1, 1, -2}, -5}, false},
    Symbol{"Pa", {{1, -1, -2}}, true},
    Symbol{"bar", {{1, -1, -2}, 5}, true},
    // 13.5951 g/cm3 x 9.80665 m/s2 x 1 mm, the conventional millimetre of mercury (ISO 80000-4).
    Symbol{"mmHg", {{1, -1, -2}, 0, 133.322387415}, false},
    Symbol{"P", {{1, -1, -1}, -1}, true},
    Symbol{"J", {{1, 2, -2}}, true},
    Symbol{"W", {{1, 2, -3}}, true},
    Symbol{"L", {{0, 3, 0}, -3}, true},
    Symbol{"l", {{0, 3, 0}, -3}, true},
};

struct Prefix {
  const char* text;
  int power_of_ten;
};

constexpr std::array prefixes{
    Prefix{"n", -9}, Prefix{"u", -6}, Prefix{"\u00b5", -6}, Prefix{"\u03bc", -6}, Prefix{"m", -3},
    Prefix{"c", -2}, Prefix{"d", -1}, Prefix{"k", 3},       Prefix{"M", 6},       Prefix{"G", 9}};

std::optional<Unit> find_symbol(std::string_view text) {
  for (const auto& symbol : symbols)
    if (text == symbol.text) return symbol.unit;
  for (const auto& prefix : prefixes) {
    if (!text.starts_with(prefix.text)) continue;
    const auto rest = text.substr(std::string_view(prefix.text).size());
    for (const auto& symbol : symbols) {
      if (!symbol.takes_prefix || rest != symbol.text) continue;
      Unit unit = symbol.unit;
      unit.power_of_ten += prefix.power_of_ten;
      return unit;
    }
  }
  return std::nullopt;
}

/// "; capitals count: MPa or mPa", if the symbol is a unit but for its capitals.
std::string differing_in_case(std::string_view text) {
  const auto lower = [](std::string word) {
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return word;
  };
  const auto wanted = lower(std::string(text));
  std::vector<std::string> found;
  for (const auto& symbol : symbols) {
    if (lower(symbol.text) == wanted) found.emplace_back(symbol.text);
    for (const auto& prefix : prefixes) {
      const auto word = std::string(prefix.text) + symbol.text;
      if (symbol.takes_prefix && lower(word) == wanted) found.push_back(word);
    }
  }
  return found.empty() ? "" : "; capitals count: " + list_words(found, false);
}

constexpr int largest_exponent = 9;

/// "m", "mm2", "s-1", "m^3": a symbol and an integer exponent.
Unit parse_factor(std::string_view text, const std::string& value) {
  const auto digits = text.find_first_of("0123456789+-^");
  std::string_view symbol = text.substr(0, digits);
  int exponent = 1;
  if (digits != std::string_view::npos) {
    auto number = text.substr(digits);
    if (number.starts_with('^')) number.remove_prefix(1);
    if (number.starts_with('+')) number.remove_prefix(1);
    const auto end = number.data() + number.size();
    const auto [stop, error] = std::from_chars(number.data(), end, exponent);
    if (error != std::errc{} || stop != end || exponent == 0 ||
        std::abs(exponent) > largest_exponent)
      throw QuantityError(value, "the exponent in the unit \"" + std::string(text) +
                                     "\" cannot be read; write it as in \"kg/m3\" or \"m/s2\"");
  }
  const auto unit = find_symbol(symbol);
  if (!unit)
    throw QuantityError(
        value, "the unit \"" + std::string(symbol) + "\" is not known" + differing_in_case(symbol) +
                   "; units are m, g, s, min, Hz, N, dyn, Pa, bar, mmHg, P, J, W and L "
                   "with the prefixes n, u, m, c, d, k, M and G, as in \"mm/s\" or \"kg/m3\"");
  return {{unit->dimension.mass * exponent, unit->dimension.length * exponent,
           unit->dimension.time * exponent},
          unit->power_of_ten * exponent,
          std::pow(unit->factor, exponent)};
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

void multiply(Unit& product, const Unit& factor, int sign) {
  product.dimension.mass += sign * factor.dimension.mass;
  product.dimension.length += sign * factor.dimension.length;
  product.dimension.time += sign * factor.dimension.time;
  product.power_of_ten += sign * factor.power_of_ten;
  product.factor *= sign > 0 ? factor.factor : 1.0 / factor.factor;
}

Unit parse_unit(std::string_view text, const std::string& value) {
  Unit product;
  bool divide = false;
  bool divided = false;
  bool expect_factor = true;
  std::size_t at = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == ' ' || c == '\t') {
      ++at;
      continue;
    }
    if (c == '/' || c == '*') {
      if (expect_factor)
        throw QuantityError(value, "the unit \"" + std::string(text) +
                                       "\" cannot be read; write it as in \"kg/m3\" or \"Pa s\"");
      divide = c == '/';
      expect_factor = true;
      ++at;
      continue;
    }
    const auto end = std::min(text.find_first_of(" \t/*", at), text.size());
    const auto factor = text.substr(at, end - at);
    at = end;
    if (divided && !divide)
      throw QuantityError(value,
                          "the unit \"" + std::string(text) +
                              "\" multiplies after a division, which can be read in two ways; "
                              "write every divisor behind a / of its own, as in \"kg/m/s\"");
    if (factor != "1")  // the 1 of "1/s"
      multiply(product, parse_factor(factor, value), divide ? -1 : 1);
    divided = divided || divide;
    divide = false;
    expect_factor = false;
  }
  if (expect_factor && !text.empty())
    throw QuantityError(value,
                        "the unit \"" + std::string(text) + "\" ends with a sign; complete it");
  return product;
}

/// Splits "2.5e-3 mm" into its number and its unit. An "e" belongs to the number only before
/// digits.
std::size_t number_length(std::string_view text) {
  const auto digit = [&](std::size_t i) {
    return i < text.size() && text[i] >= '0' && text[i] <= '9';
  };
  std::size_t at = 0;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) ++at;
  const std::size_t first = at;
  std::size_t digits = 0;
  while (digit(at)) ++at, ++digits;
  if (at < text.size() && text[at] == '.') {
    ++at;
    while (digit(at)) ++at, ++digits;
  }
  if (digits == 0) return 0;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E') && at > first) {
    std::size_t exponent = at + 1;
    if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
    if (digit(exponent)) {
      at = exponent;
      while (digit(at)) ++at;
    }
  }
  return at;
}

/// The decimal number `digits` ("2.5e-3") x 10^`power_of_ten`, rounded once.
double scaled_decimal(std::string_view digits, int power_of_ten, const std::string& value) {
  const auto refuse = [&](const char* reason) { throw QuantityError(value, reason); };
  if (digits.starts_with('+')) digits.remove_prefix(1);
  const auto split = digits.find_first_of("eE");
  int exponent = 0;
  if (split != std::string_view::npos) {
    auto tail = digits.substr(split + 1);
    if (tail.starts_with('+')) tail.remove_prefix(1);
    const auto [stop, error] = std::from_chars(tail.data(), tail.data() + tail.size(), exponent);
    if (error != std::errc{} || std::abs(exponent) > 10000) {
      refuse("the number is out of range; write one that a double can hold");
    }
  }
  const std::string decimal =
      std::string(digits.substr(0, split)) + "e" + std::to_string(exponent + power_of_ten);
  double number = 0.0;
  const auto [stop, error] =
      std::from_chars(decimal.data(), decimal.data() + decimal.size(), number);
  if (error != std::errc{} || stop != decimal.data() + decimal.size() || !std::isfinite(number))
    refuse("the number is out of range; write one that a double can hold");
  return number;
}

}  // namespace

std::string describe(const Dimension& dimension) {
  if (dimension == dimension::none) return "a plain number, such as 0.5";
  if (const auto* known = find(dimension))
    return std::string(known->name) + ", such as \"" + known->example + "\"";
  return name_of(dimension);
}

double parse_quantity(std::string_view text, const Dimension& expected) {
  const std::string value(text);
  text = trim(text);
  const auto length = number_length(text);
  if (length == 0)
    throw QuantityError(value, "does not begin with a finite number; write " + describe(expected));
  const auto unit_text = trim(text.substr(length));
  if (unit_text.starts_with(','))
    throw QuantityError(
        value, "a comma in the number; write " + describe(expected) + ", with a decimal point");
  if (unit_text.empty() && expected != dimension::none)
    throw QuantityError(value, "a number without a unit; write " + describe(expected));
  const Unit unit = parse_unit(unit_text, value);
  if (unit.dimension != expected)
    throw QuantityError(value, name_of(unit.dimension) + " where " + name_of(expected) +
                                   " is needed; write " + describe(expected));
  const double number =
      scaled_decimal(text.substr(0, length), unit.power_of_ten, value) * unit.factor;
  if (!std::isfinite(number))
    throw QuantityError(value, "the number is out of range; write one that a double can hold");
  return number;
}

}  // namespace sprung
