#pragma once
/// The scene that the tests change line by line, so that every expected line number can be counted.

#include "scene/document.hpp"

#include <sstream>
#include <string>
#include <vector>

namespace sprung::test {

inline const std::vector<std::string> beam_lines{
    /*  1 */ R"(title = "Beam")",
    /*  2 */ R"(source = "a test")",
    /*  3 */ R"([domain])",
    /*  4 */ R"(channel = { from = ["0 m", "0 m"], to = ["0.9 m", "0.3 m"] })",
    /*  5 */ R"([time])",
    /*  6 */ R"(end = "3 s")",
    /*  7 */ R"([fluid])",
    /*  8 */ R"(density = "1000 kg/m3")",
    /*  9 */ R"([viscosity])",
    /* 10 */ R"(dynamic = "1 Pa s")",
    /* 11 */ R"([walls])",
    /* 12 */ R"(no_slip = ["bottom", "top"])",
    /* 13 */ R"([inflow])",
    /* 14 */ R"(side = "left")",
    /* 15 */ R"(profile = "parabolic")",
    /* 16 */ R"(mean_velocity = "0.5 m/s")",
    /* 17 */ R"(ramp = "1 s")",
    /* 18 */ R"([outflow])",
    /* 19 */ R"(side = "right")",
    /* 20 */ R"(pressure = "0 Pa")",
    /* 21 */ R"([solid.beam])",
    /* 22 */ R"(body = { from = ["0.3 m", "0 m"], to = ["0.315 m", "0.1 m"] })",
    /* 23 */ R"(youngs_modulus = "0.7 MPa")",
    /* 24 */ R"(clamped = "bottom")",
    /* 25 */ R"([probes.tip])",
    /* 26 */ R"(displacement_of = ["0.3075 m", "0.1 m"])",
    /* 27 */ R"([probes.profile])",
    /* 28 */
    R"(velocity_along = { from = ["0.4 m", "0 m"], to = ["0.4 m", "0.3 m"], points = 121 })",
    /* 29 */ R"(times = ["0.2 s", "3 s"])",
    /* 30 */ R"([probes.force])",
    /* 31 */ R"(force_on = "beam")",
    /* 32 */ R"([probes.outline])",
    /* 33 */ R"(outline_of = "beam")",
    /* 34 */ R"(points = 87)",
    /* 35 */ R"(times = ["0.2 s", "3 s"])",
    /* 36 */ R"([record])",
    /* 37 */ R"(fields_every = "0.5 s")",
};

/// The scene with line `number` (from 1) replaced; 0 replaces none.
inline std::string beam_text(std::size_t number = 0, const std::string& replacement = "") {
  std::string text;
  for (std::size_t i = 0; i < beam_lines.size(); ++i)
    text += (i + 1 == number ? replacement : beam_lines[i]) + "\n";
  return text;
}

/// What `action` throws as SceneError, or "" if it throws none.
template <class Action>
std::string scene_error(const Action& action) {
  try {
    action();
  } catch (const SceneError& error) {
    return error.what();
  }
  return "";
}

}  // namespace sprung::test
