// SPDX-License-Identifier: BSD-3-Clause
// `rio fit-noise` as a user runs it: simulate, fit, replay with the file it prints; bad input.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "support/temp_dir.hpp"

namespace rio::test {
namespace {

int rio(const std::string& arguments) {
  return std::system((std::string(RIO_TOOL) + " " + arguments).c_str());
}

std::string text_of(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// The number behind `key`, a quote passed over.
double value_of(const std::string& text, const std::string& key) {
  const std::size_t at = text.find(key + ": ");
  if (at == std::string::npos) return 0.0;
  const std::size_t begin = at + key.size() + 2;
  return std::strtod(text.c_str() + begin + (text[begin] == '"' ? 1 : 0), nullptr);
}

void keep_lines(const std::string& file, int count) {
  std::istringstream in(text_of(file));
  std::ofstream out(file);
  std::string line;
  for (int i = 0; i < count && std::getline(in, line); ++i) out << line << "\n";
}

TEST(FitNoise, PrintsAnOptionFileThatReplayTakes) {
  const TempDir dir;
  const std::string flight = (dir.path() / "flight").string();
  const std::string fitted = (dir.path() / "noise.yaml").string();
  const std::string log = (dir.path() / "log").string();
  ASSERT_EQ(rio("simulate " + flight + " --scenario monte-carlo --seed 9 > " + log), 0);
  ASSERT_EQ(rio("fit-noise " + flight + " > " + fitted + " 2> " + log), 0) << text_of(log);
  const std::string text = text_of(fitted);
  // of the scenario; 15 % as test/calibrate/noise_calibration_test.cpp
  EXPECT_NEAR(value_of(text, "sigma_range"), 0.03, 0.15 * 0.03);
  EXPECT_NEAR(value_of(text, "sigma_azimuth"), 2.0, 0.15 * 2.0);
  EXPECT_NEAR(value_of(text, "sigma_elevation"), 4.0, 0.15 * 4.0);
  EXPECT_NEAR(value_of(text, "sigma_doppler"), 0.02, 0.15 * 0.02);
  EXPECT_EQ(rio("replay " + flight + " --quiet --config " + fitted + " > " + log + " 2>&1"), 0)
      << text_of(log);
}

TEST(FitNoise, SaysWhatIsWrong) {
  const TempDir dir;
  const std::string log = (dir.path() / "log").string();
  EXPECT_NE(rio("fit-noise " + (dir.path() / "nothing").string() + " > " + log + " 2>&1"), 0);
  EXPECT_NE(text_of(log).find("nothing"), std::string::npos);

  const std::string flight = (dir.path() / "short").string();
  ASSERT_EQ(rio("simulate " + flight + " --scenario monte-carlo --seed 9 > " + log), 0);
  keep_lines(flight + "/radar0/data.csv", 600);  // two seconds of scans, most of them at rest
  EXPECT_NE(rio("fit-noise " + flight + " > " + log + " 2>&1"), 0);
  EXPECT_NE(text_of(log).find("fly longer"), std::string::npos) << text_of(log);
}

}  // namespace
}  // namespace rio::test
