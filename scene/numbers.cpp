#include "scene/numbers.hpp"

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

std::string csv_text(const SeriesData& data) {
  std::string text;
  for (const auto& column : data.columns)
    text += (text.empty() ? "" : ",") + column.name + " [" + column.unit + "]";
  text += '\n';
  char buffer[40];
  for (std::size_t i = 0; i < data.values.size(); ++i) {
    const auto end =
        std::to_chars(buffer, buffer + sizeof buffer, data.values[i], std::chars_format::general, 17);
    text.append(buffer, end.ptr);
    text += (i + 1) % data.columns.size() == 0 ? '\n' : ',';
  }
  return text;
}

}  // namespace sprung
