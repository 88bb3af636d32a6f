#include "scene/record_text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace sprung {

std::string shortest(double value) {
  char buffer[40];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

void require_finite(std::span<const double> values, const std::string& what) {
  for (const double value : values)
    if (!std::isfinite(value))
      throw std::runtime_error(what + " is " + shortest(value) +
                               ": the run has broken down, and nothing of this is recorded");
}

void require_name(const std::string& name, const std::string& what) {
  const bool usable = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) || c == '_');
  });
  if (!usable)
    throw std::logic_error("\"" + name + "\" cannot name a " + what +
                           ": letters, digits and _ only");
}

void require_columns(const std::vector<Column>& columns, const std::string& what) {
  if (columns.empty()) throw std::logic_error(what + ": no columns");
  for (std::size_t i = 0; i < columns.size(); ++i) {
    require_name(columns[i].name, "column of " + what);
    if (columns[i].unit.empty() || columns[i].unit.find_first_of(",\"\n\r[]") != std::string::npos)
      throw std::logic_error(what + ": the unit of " + columns[i].name + " is \"" +
                             columns[i].unit + "\"; write a unit, or 1");
    for (std::size_t j = 0; j < i; ++j)
      if (columns[j].name == columns[i].name)
        throw std::logic_error(what + ": two columns named " + columns[i].name);
  }
}

std::string csv_text(const SeriesData& data) {
  std::string text;
  for (const auto& column : data.columns)
    text += (text.empty() ? "" : ",") + column.name + " [" + column.unit + "]";
  text += '\n';
  char buffer[40];
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, data.values[i],
                                   std::chars_format::general, 17);
    text.append(buffer, end.ptr);
    text += (i + 1) % data.columns.size() == 0 ? '\n' : ',';
  }
  return text;
}

}  // namespace sprung
