// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/units.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/temp_dir.hpp"

namespace rio::io {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(Units, PlainNumbersAreSi) {
  EXPECT_EQ(parse_quantity("4e-4", "rad/s/sqrt(Hz)"), 4e-4);
  EXPECT_EQ(parse_quantity(" -2.5 ", "m"), -2.5);
  EXPECT_EQ(parse_quantity("+3", ""), 3.0);
}

TEST(Units, Converts) {
  // one rounding per factor: relative 1e-15
  const auto expect = [](const char* text, const char* unit, double si) {
    EXPECT_NEAR(parse_quantity(text, unit), si, 1e-15 * std::abs(si)) << text;
  };
  expect("2 deg", "rad", 2.0 * kPi / 180.0);
  expect("30ms", "s", 0.03);
  expect("5 cm", "m", 0.05);
  expect("10 deg/s", "rad/s", 10.0 * kPi / 180.0);
  expect("10 mdeg/s", "rad/s", 0.01 * kPi / 180.0);
  expect("30 rpm", "rad/s", kPi);
  expect("36 km/h", "m/s", 10.0);
  expect("40 %", "", 0.4);
  expect("100 ug/sqrt(Hz)", "m/s^2/sqrt(Hz)", 100e-6 * 9.80665);
  expect("0.6 deg/sqrt(h)", "rad/s/sqrt(Hz)", 0.6 * kPi / 180.0 / 60.0);
  expect("2 m*s^-2", "m/s^2", 2.0);
  expect("3 dB", "dB", 3.0);
}

TEST(Units, RejectsTheWrongDimension) {
  EXPECT_ERROR(parse_quantity("2 deg", "m"), "\"2 deg\" does not fit the unit [m]");
  EXPECT_ERROR(parse_quantity("2 deg", "rad/s"), "does not fit");
  EXPECT_ERROR(parse_quantity("2 m", ""), "does not fit the unit [1]");
  EXPECT_ERROR(parse_quantity("2 %", "m"), "does not fit");
  EXPECT_ERROR(parse_quantity("2 m/s^2", "m/s^2/sqrt(Hz)"), "does not fit");
}

TEST(Units, RejectsWhatItDoesNotKnow) {
  EXPECT_ERROR(parse_quantity("2 foot", "m"), "unknown unit \"foot\"");
  EXPECT_ERROR(parse_quantity("2 m^x", "m"), "unknown unit \"m^x\"");
  EXPECT_ERROR(parse_quantity("2 m/", "m"), "unknown unit \"\"");
  EXPECT_ERROR(parse_quantity("deg", "rad"), "not a number");
  EXPECT_ERROR(parse_quantity("", "rad"), "not a number");
}

}  // namespace
}  // namespace rio::io
