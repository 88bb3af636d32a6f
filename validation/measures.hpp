#pragma once
/// What a comparison measures: names, units and definitions, in one table.

#include <span>
#include <string>

namespace sprung {

struct Measure {
  const char* name;
  const char* unit;        ///< of the value that is judged; "1" for a ratio
  bool against_reference;  ///< whether the reference's own error enters the verdict
  const char* definition;
};

std::span<const Measure> measures();
/// Throws std::invalid_argument, naming the measures there are, if there is none of that name.
const Measure& measure(const std::string& name);

}  // namespace sprung
