// SPDX-License-Identifier: BSD-3-Clause
// What a test has measured, for the table that test/run.sh prints at its end.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
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

}  // namespace rio::test
