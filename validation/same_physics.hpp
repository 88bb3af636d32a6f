#pragma once
/// Whether two records speak of the same problem.

#include "scene/problem.hpp"

#include <optional>
#include <string>

namespace sprung {

/// The first thing in which two problems differ ("solid.beam youngs_modulus: 700000 against
/// 350000"), or nothing. Discretisation is no part of a Problem and may differ.
std::optional<std::string> first_difference(const Problem& reference, const Problem& candidate);

}  // namespace sprung
