#pragma once
/// Formulas of a scene file ("0.5 * (1 - cos(pi * t))"), evaluated by muParser.

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace sprung {

/// A formula that cannot be read; what() says why and which variables there are.
class FormulaError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// One formula of plain numbers in SI units. muParser's functions and operators, and pi.
class Formula {
 public:
  /// `variables`: the names that `text` may use. Throws FormulaError.
  Formula(const std::string& text, std::vector<std::string> variables);
  Formula(const Formula& other);
  Formula& operator=(const Formula& other);
  Formula(Formula&&) noexcept;
  Formula& operator=(Formula&&) noexcept;
  ~Formula();

  /// Values in the order of the names. May be infinite or not a number, as the formula gives it.
  double value(std::span<const double> values) const;
  const std::string& text() const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

}  // namespace sprung
