/// Units by hand: each expected value is the decimal number that the definition of the unit gives.

#include "scene/quantity.hpp"

#include <gtest/gtest.h>

#include <string>

namespace sprung {
namespace {

struct Good {
  const char* text;
  Dimension dimension;
  double value;
};

class Quantity : public testing::TestWithParam<Good> {};

TEST_P(Quantity, IsExactInSi) {
  const auto& [text, dimension, value] = GetParam();
  EXPECT_EQ(parse_quantity(text, dimension), value) << text;  // the same double, not a near one
}

constexpr Dimension force{1, 1, -2};
constexpr Dimension force_per_length{1, 0, -2};
constexpr Dimension energy{1, 2, -2};
constexpr Dimension power{1, 2, -3};
constexpr Dimension volume_flow{0, 3, -1};
constexpr Dimension kinematic_viscosity{0, 2, -1};

INSTANTIATE_TEST_SUITE_P(
    Hand, Quantity,
    testing::Values(
        Good{"3.75 mm", dimension::length, 0.00375}, Good{"300 mm", dimension::length, 0.3},
        Good{"0.3 m", dimension::length, 0.3}, Good{"1.5 cm", dimension::length, 0.015},
        Good{"1 dm", dimension::length, 0.1}, Good{"2 km", dimension::length, 2000.0},
        Good{"5 um", dimension::length, 5e-6}, Good{"5 \u00b5m", dimension::length, 5e-6},
        Good{"5 \u03bcm", dimension::length, 5e-6}, Good{"7 nm", dimension::length, 7e-9},
        Good{"-2.5e-1 mm", dimension::length, -0.00025}, Good{"+1 m", dimension::length, 1.0},
        Good{".5 m", dimension::length, 0.5}, Good{"2. m", dimension::length, 2.0},
        Good{"1E3 m", dimension::length, 1000.0}, Good{"1e+3 m", dimension::length, 1000.0},
        Good{"  3mm  ", dimension::length, 0.003}, Good{"0 m", dimension::length, 0.0},
        Good{"0.2 s", dimension::time, 0.2}, Good{"5 ms", dimension::time, 0.005},
        Good{"2 min", dimension::time, 120.0}, Good{"5 Hz", dimension::frequency, 5.0},
        Good{"1 kHz", dimension::frequency, 1000.0}, Good{"1.2 1/s", dimension::frequency, 1.2},
        Good{"1.2 s-1", dimension::frequency, 1.2}, Good{"1.2 s^-1", dimension::frequency, 1.2},
        Good{"0.5 m/s", dimension::velocity, 0.5}, Good{"30 mm/s", dimension::velocity, 0.03},
        Good{"60 m/min", dimension::velocity, 1.0},
        Good{"9.81 m/s2", dimension::acceleration, 9.81},
        Good{"9.81 m/s/s", dimension::acceleration, 9.81},
        Good{"9.81 m/s^2", dimension::acceleration, 9.81},
        Good{"1000 kg/m3", dimension::density, 1000.0},
        Good{"1.05 g/cm3", dimension::density, 1050.0}, Good{"1 kg/L", dimension::density, 1000.0},
        Good{"0.7 MPa", dimension::pressure, 7e5}, Good{"1 bar", dimension::pressure, 1e5},
        Good{"5 mbar", dimension::pressure, 500.0}, Good{"1 GPa", dimension::pressure, 1e9},
        Good{"0.35 N/mm2", dimension::pressure, 350000.0},
        Good{"100 dyn/cm2", dimension::pressure, 10.0},
        // 13.5951 g/cm3 x 9.80665 m/s2 x 1 mm
        Good{"1 mmHg", dimension::pressure, 133.322387415},
        Good{"1 Pa s", dimension::dynamic_viscosity, 1.0},
        Good{"1 Pa*s", dimension::dynamic_viscosity, 1.0},
        Good{"3.5 mPa s", dimension::dynamic_viscosity, 0.0035},
        Good{"3.5 cP", dimension::dynamic_viscosity, 0.0035},
        Good{"1 kg/m/s", dimension::dynamic_viscosity, 1.0},
        Good{"1 mm2/s", kinematic_viscosity, 1e-6}, Good{"5 L/min", volume_flow, 5e-3 / 60},
        Good{"2 kN", force, 2000.0}, Good{"2 kg m/s2", force, 2.0},
        Good{"3 N/m", force_per_length, 3.0}, Good{"4 J", energy, 4.0}, Good{"4 N m", energy, 4.0},
        Good{"5 kW", power, 5000.0}, Good{"0.5", dimension::none, 0.5},
        Good{"3 mm/m", dimension::none, 0.003}));

struct Bad {
  const char* text;
  Dimension dimension;
  const char* message;  // the whole of it
};

class BadQuantity : public testing::TestWithParam<Bad> {};

TEST_P(BadQuantity, SaysWhatIsWrongAndWhatToWrite) {
  const auto& [text, dimension, message] = GetParam();
  try {
    const double value = parse_quantity(text, dimension);
    FAIL() << text << " was taken as " << value;
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), message);
  }
}

constexpr const char* units =
    "; units are m, g, s, min, Hz, N, dyn, Pa, bar, mmHg, P, J, W and L with the prefixes n, u, m, "
    "c, "
    "d, k, M and G, as in \"mm/s\" or \"kg/m3\"";

INSTANTIATE_TEST_SUITE_P(
    Hand, BadQuantity,
    testing::Values(
        Bad{"0.7 mm", dimension::pressure,
            "\"0.7 mm\": a length where a pressure is needed; write a pressure, such as \"0.7 "
            "MPa\""},
        Bad{"0.7 MPa", dimension::length,
            "\"0.7 MPa\": a pressure where a length is needed; write a length, such as \"3.75 "
            "mm\""},
        Bad{"1 Pa/s", dimension::pressure,
            "\"1 Pa/s\": a quantity in kg m-1 s-3 where a pressure is needed; write a pressure, "
            "such "
            "as \"0.7 MPa\""},
        Bad{"3.75", dimension::length,
            "\"3.75\": a number without a unit; write a length, such as \"3.75 mm\""},
        Bad{"3 m", dimension::none,
            "\"3 m\": a length where a plain number is needed; write a plain number, such as 0.5"},
        Bad{"mm", dimension::length,
            "\"mm\": does not begin with a finite number; write a length, such as \"3.75 mm\""},
        Bad{"", dimension::length,
            "\"\": does not begin with a finite number; write a length, such as \"3.75 mm\""},
        Bad{"nan m", dimension::length,
            "\"nan m\": does not begin with a finite number; write a length, such as \"3.75 mm\""},
        Bad{"inf s", dimension::time,
            "\"inf s\": does not begin with a finite number; write a time, such as \"0.2 s\""},
        Bad{"-inf s", dimension::time,
            "\"-inf s\": does not begin with a finite number; write a time, such as \"0.2 s\""},
        Bad{"1e400 m", dimension::length,
            "\"1e400 m\": the number is out of range; write one that a double can hold"},
        Bad{"1e-400 m", dimension::length,
            "\"1e-400 m\": the number is out of range; write one that a double can hold"},
        Bad{"1e99999999999 m", dimension::length,
            "\"1e99999999999 m\": the number is out of range; write one that a double can hold"},
        Bad{"1.7e308 mmHg", dimension::pressure,
            "\"1.7e308 mmHg\": the number is out of range; write one that a double can hold"},
        Bad{"0,3 m", dimension::length,
            "\"0,3 m\": a comma in the number; write a length, such as \"3.75 mm\", with a decimal "
            "point"},
        Bad{"1 kg/m s", dimension::dynamic_viscosity,
            "\"1 kg/m s\": the unit \"kg/m s\" multiplies after a division, which can be read in "
            "two "
            "ways; write every divisor behind a / of its own, as in \"kg/m/s\""},
        Bad{"1 kg/", dimension::density,
            "\"1 kg/\": the unit \"kg/\" ends with a sign; complete it"},
        Bad{"1 /s", dimension::frequency,
            "\"1 /s\": the unit \"/s\" cannot be read; write it as in \"kg/m3\" or \"Pa s\""},
        Bad{"1 kg/m3.5", dimension::density,
            "\"1 kg/m3.5\": the exponent in the unit \"m3.5\" cannot be read; write it as in "
            "\"kg/m3\" or \"m/s2\""},
        Bad{"1 m0", dimension::length,
            "\"1 m0\": the exponent in the unit \"m0\" cannot be read; write it as in \"kg/m3\" or "
            "\"m/s2\""}));

TEST(BadUnit, NamesTheKnownOnesAndTheirCapitals) {
  const auto message = [](const char* text, const Dimension& dimension) -> std::string {
    try {
      parse_quantity(text, dimension);
    } catch (const QuantityError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message("3 in", dimension::length),
            std::string("\"3 in\": the unit \"in\" is not known") + units);
  EXPECT_EQ(message("0.7 Mpa", dimension::pressure),
            std::string("\"0.7 Mpa\": the unit \"Mpa\" is not known; capitals count: mPa or MPa") +
                units);
  EXPECT_EQ(message("1 kmmHg", dimension::pressure),
            std::string("\"1 kmmHg\": the unit \"kmmHg\" is not known") + units);
}

TEST(Describe, NamesEveryDimensionOfTheScene) {
  EXPECT_EQ(describe(dimension::length), "a length, such as \"3.75 mm\"");
  EXPECT_EQ(describe(dimension::dynamic_viscosity), "a dynamic viscosity, such as \"1 Pa s\"");
  EXPECT_EQ(describe(dimension::none), "a plain number, such as 0.5");
  EXPECT_EQ(describe({2, 0, 0}), "a quantity in kg2");
}

// Every example that a message offers must itself be accepted.
TEST(Describe, OffersExamplesThatAreAccepted) {
  for (const auto& dimension :
       {dimension::length, dimension::time, dimension::frequency, dimension::velocity,
        dimension::acceleration, dimension::density, dimension::pressure,
        dimension::dynamic_viscosity, Dimension{1, 0, 0}, Dimension{0, 2, 0}, Dimension{0, 3, 0},
        Dimension{0, 2, -1}, Dimension{0, 3, -1}, Dimension{1, 1, -2}, Dimension{1, 0, -2},
        Dimension{1, 2, -2}, Dimension{1, 2, -3}}) {
    const auto text = describe(dimension);
    const auto first = text.find('"') + 1;
    const auto example = text.substr(first, text.rfind('"') - first);
    EXPECT_GT(parse_quantity(example, dimension), 0.0) << text;
  }
}

}  // namespace
}  // namespace sprung
