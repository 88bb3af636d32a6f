#pragma once
/// Numbers and names as a record's files hold them, and the refusal of those they must not hold.
/// Private to the library.

#include "scene/record.hpp"

#include <span>
#include <string>

namespace sprung {

/// The shortest decimal that reads back as the same double: 0.2, 3, 1e-05.
std::string shortest(double value);

/// Throws std::runtime_error that begins with `what` if a value is NaN or infinite.
void require_finite(std::span<const double> values, const std::string& what);

/// Throws std::logic_error unless `name` consists of letters, digits and _: names become names of
/// files, HDF5 paths and XML. `what` says what it names.
void require_name(const std::string& name, const std::string& what);

/// The same for columns, whose units may hold no comma, quote or line end either.
void require_columns(const std::vector<Column>& columns, const std::string& what);

/// "time [s],displacement_x [m]" and a line per row, 17 significant digits each.
std::string csv_text(const SeriesData& data);

}  // namespace sprung
