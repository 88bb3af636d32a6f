#include "scene/formula.hpp"

#include "scene/spelling.hpp"

#include <algorithm>
#include <numbers>

#include <muParser.h>

namespace sprung {

struct Formula::Parser {
  std::string text;
  std::vector<std::string> names;
  std::vector<double> values;
  mu::Parser parser;

  Parser(const std::string& formula, std::vector<std::string> variables)
      : text(formula), names(std::move(variables)), values(names.size(), 0.0) {
    try {
      parser.DefineConst("pi", std::numbers::pi);
      for (std::size_t k = 0; k < names.size(); ++k) parser.DefineVar(names[k], &values[k]);
      parser.SetExpr(text);
      int results = 0;
      parser.Eval(results);
      // A comma outside a function's brackets parts two formulas, of which the last would count.
      if (results != 1) refuse("it holds a comma outside a function; write a decimal point");
      if (assigns(text)) refuse("it assigns a value; compare with == and choose with ? :");
    } catch (const mu::Parser::exception_type& error) {
      refuse(error.GetMsg());
    }
  }

  [[noreturn]] void refuse(const std::string& reason) const {
    throw FormulaError("the formula cannot be read: " + reason +
                       "; it may use pi and the variables " + list_words(names, false, "and"));
  }

  /// Whether an = stands in the formula that is no part of ==, !=, <= or >=.
  static bool assigns(const std::string& formula) {
    for (std::size_t k = 0; k < formula.size(); ++k) {
      if (formula[k] != '=') continue;
      if (k + 1 < formula.size() && formula[k + 1] == '=')
        ++k;
      else if (k == 0 || std::string("!<>").find(formula[k - 1]) == std::string::npos)
        return true;
    }
    return false;
  }
};

Formula::Formula(const std::string& text, std::vector<std::string> variables)
    : parser_(std::make_unique<Parser>(text, std::move(variables))) {}
Formula::Formula(const Formula& other)
    : parser_(std::make_unique<Parser>(other.parser_->text, other.parser_->names)) {}
Formula& Formula::operator=(const Formula& other) {
  parser_ = std::make_unique<Parser>(other.parser_->text, other.parser_->names);
  return *this;
}
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(Formula&&) noexcept = default;
Formula::~Formula() = default;

double Formula::value(std::span<const double> values) const {
  std::copy(values.begin(), values.end(), parser_->values.begin());
  return parser_->parser.Eval();
}

const std::string& Formula::text() const {
  return parser_->text;
}

}  // namespace sprung
