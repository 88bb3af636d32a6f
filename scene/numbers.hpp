#pragma once
/// Numbers as text in files, and the refusal of those that are none. Private to the library.

#include "scene/record.hpp"

#include <span>
#include <string>

namespace sprung {

/// The shortest decimal that reads back as the same double: 0.2, 3, 1e-05.
std::string shortest(double value);

/// Throws std::runtime_error that begins with `what` if a value is NaN or infinite.
void require_finite(std::span<const double> values, const std::string& what);

/// "time [s],displacement_x [m]" and a line per row, 17 significant digits each.
std::string csv_text(const SeriesData& data);

}  // namespace sprung
