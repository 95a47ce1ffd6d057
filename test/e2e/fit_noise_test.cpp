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

void keep_lines(const std::string& file, std::size_t count) {
  std::vector<std::string> lines = lines_of(file);
  ASSERT_GT(lines.size(), count);
  lines.resize(count);
  std::ofstream out(file);
  for (const std::string& line : lines) out << line << "\n";
}

TEST(FitNoise, PrintsAnOptionFileThatReplayTakes) {
  const TempDir dir;
  const std::string flight = (dir.path() / "flight").string();
  const std::string fitted = (dir.path() / "noise.yaml").string();
  ASSERT_EQ(rio("simulate " + flight + " --scenario monte-carlo --seed 9").status, 0);
  const Outcome fit =
      run_command(RIO_TOOL " fit-noise " + flight + " 2>/dev/null >" + fitted + "; cat " + fitted);
  // of the scenario; 15 % as test/calibrate/noise_calibration_test.cpp
  EXPECT_NEAR(value_of(fit.output, "sigma_range"), 0.03, 0.15 * 0.03);
  EXPECT_NEAR(value_of(fit.output, "sigma_azimuth"), 2.0, 0.15 * 2.0);
  EXPECT_NEAR(value_of(fit.output, "sigma_elevation"), 4.0, 0.15 * 4.0);
  EXPECT_NEAR(value_of(fit.output, "sigma_doppler"), 0.02, 0.15 * 0.02);
  const Outcome replay = rio("replay " + flight + " --quiet --config " + fitted);
  EXPECT_EQ(replay.status, 0) << replay.output;
}

TEST(FitNoise, SaysWhatIsWrong) {
  const TempDir dir;
  const Outcome missing = rio("fit-noise " + (dir.path() / "nothing").string());
  EXPECT_NE(missing.status, 0);
  EXPECT_NE(missing.output.find("nothing"), std::string::npos) << missing.output;

  const std::string flight = (dir.path() / "short").string();
  ASSERT_EQ(rio("simulate " + flight + " --scenario monte-carlo --seed 9").status, 0);
  keep_lines(flight + "/radar0/data.csv", 600);  // two seconds of scans, most of them at rest
  const Outcome brief = rio("fit-noise " + flight);
  EXPECT_NE(brief.status, 0);
  EXPECT_NE(brief.output.find("fly longer"), std::string::npos) << brief.output;
}

}  // namespace
}  // namespace rio::test
