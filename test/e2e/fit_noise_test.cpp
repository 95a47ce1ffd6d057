// SPDX-License-Identifier: BSD-3-Clause
// `rio fit-noise` as a user runs it: simulate, fit, replay with the file it prints; bad input.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

/// The number behind `key`, a quote passed over.
double value_of(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key + ": ");
  if (at == std::string::npos) return 0.0;
  const std::size_t begin = at + key.size() + 2;
  return std::strtod(text.c_str() + begin + (text[begin] == '"' ? 1 : 0), nullptr);
}

TEST(FitNoise, PrintsAnOptionFileThatReplayTakes) {
  const TempDir dir;
  const std::string flight = (dir.path() / "flight").string();
  const std::string fitted = (dir.path() / "noise.yaml").string();
  rio("simulate " + flight + " --scenario monte-carlo --seed 9");
  rio("fit-noise " + flight + " 2>/dev/null >" + fitted);
  const std::string fit = text_of(fitted);
  // of the scenario; 15 % as test/calibrate/noise_calibration_test.cpp
  EXPECT_NEAR(value_of(fit, "sigma_range"), 0.03, 0.15 * 0.03);
  EXPECT_NEAR(value_of(fit, "sigma_azimuth"), 2.0, 0.15 * 2.0);
  EXPECT_NEAR(value_of(fit, "sigma_elevation"), 4.0, 0.15 * 4.0);
  EXPECT_NEAR(value_of(fit, "sigma_doppler"), 0.02, 0.15 * 0.02);
  rio("replay " + flight + " --quiet --config " + fitted);

  // two seconds of scans, most of them at rest
  std::vector<std::string> lines = lines_of(flight + "/radar0/data.csv");
  ASSERT_GT(lines.size(), 600U);
  lines.resize(600);
  std::ofstream out(flight + "/radar0/data.csv");
  for (const std::string& line : lines) out << line << "\n";
  out.close();
  fails(1, "fit-noise " + flight, {"fly longer"});
  fails(1, "fit-noise " + flight + "/nothing", {"nothing"});
}

}  // namespace
}  // namespace rio::test
