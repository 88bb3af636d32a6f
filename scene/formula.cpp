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
      parser.Eval();
    } catch (const mu::Parser::exception_type& error) {
      throw FormulaError("the formula cannot be read: " + error.GetMsg() +
                         "; it may use pi and the variables " + list_words(names, false, "and"));
    }
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
