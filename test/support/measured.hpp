// SPDX-License-Identifier: BSD-3-Clause
// What a test has measured, for the table that test/run.sh prints at its end, and the bounds of it.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace rio::test {

/// One row: what, the value, and what is asked of it, as in "below 0.5 m". Appended to the file
/// that the environment variable RIO_MEASURED names, and printed.
inline void measured(const std::string& what, double value, const std::string& asked) {
  const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
  const std::string test =
      info == nullptr ? "" : std::string(info->test_suite_name()) + "." + info->name();
  char row[256];
  std::snprintf(row, sizeof row, "%-44s %-44s %10.4g   %s\n", test.c_str(), what.c_str(), value,
                asked.c_str());
  std::fputs(row, stdout);
  const char* path = std::getenv("RIO_MEASURED");
  if (path == nullptr) return;
  if (std::FILE* file = std::fopen(path, "a"); file != nullptr) {
    std::fputs(row, file);  // one write a row: tests run side by side
    std::fclose(file);
  }
}

inline std::string short_text(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

/// A row and its check: below the bound.
inline void expect_below(const std::string& what, double value, double bound) {
  measured(what, value, "below " + short_text(bound));
  EXPECT_LT(value, bound) << what;
}
/// Between the bounds.
inline void expect_between(const std::string& what, double value, double low, double high) {
  measured(what, value, short_text(low) + " to " + short_text(high));
  EXPECT_GT(value, low) << what;
  EXPECT_LT(value, high) << what;
}
/// Off by no more than the tolerance.
inline void expect_near(const std::string& what, double value, double expected, double tolerance) {
  measured(what, value, short_text(expected) + " within " + short_text(tolerance));
  EXPECT_NEAR(value, expected, tolerance) << what;
}

}  // namespace rio::test
