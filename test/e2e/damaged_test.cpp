// SPDX-License-Identifier: BSD-3-Clause
// `rio replay` of damaged recordings: what is wrong is named, nothing is lost silently, and one bad
// stamp or value costs its own row.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

TEST_F(Tool, DamagedDataNamesFileAndLineAndIsUsedUpToThere) {
  const fs::path flight = copy("damaged");
  const fs::path radar = flight / "radar0/data.csv";
  fs::resize_file(radar, fs::file_size(radar) - 30);  // cut inside the last row
  Outcome run = rio("replay " + flight.string() + " --quiet");
  EXPECT_NE(run.status, 0);
  EXPECT_PRED2(contains, run.output, "verdict: healthy");
  EXPECT_PRED2(contains, run.output,
               "the file ends inside of this line\nWhat stands before was used.");
  EXPECT_NE(run.output.find("radar0/data.csv:"), std::string::npos) << run.output;
  fs::remove(radar);
  run = rio("replay " + flight.string() + " --quiet");
  EXPECT_NE(run.status, 0);
  EXPECT_NE(run.output.find("radar0/data.csv"), std::string::npos) << run.output;
}

/// Rows changed one by one; `change` gets the number of the row. Comments are dropped.
void edit(const fs::path& file, const std::function<void(std::string&, std::size_t)>& change) {
  std::vector<std::string> lines = lines_of(file);
  std::ofstream out(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    change(lines[i], i);
    out << lines[i] << "\n";
  }
}

TEST_F(Tool, OddRadarStampsStopNothing) {
  const fs::path flight = copy("odd_stamps");
  std::set<std::string> stamps;
  edit(flight / "radar0/data.csv", [&stamps](std::string& line, std::size_t) {
    const std::string stamp = line.substr(0, line.find(','));
    stamps.insert(stamp);
    if (stamps.size() < 20 || stamps.size() > 22) return;
    const std::string odd = stamps.size() == 21 ? "-9223372036854775808"
                                                : std::to_string(std::stoll(stamp) + 3600000000000);
    line = odd + line.substr(line.find(','));
  });
  const Outcome run = rio("replay " + flight.string() + " --json");
  ASSERT_EQ(run.status, 0) << run.output;
  const auto json = nlohmann::json::parse(run.last_line());
  EXPECT_EQ(json["scans"], scans() - 3);
  EXPECT_EQ(json["counters"]["scans_ahead"], 2);
  EXPECT_EQ(json["counters"]["scans_late"], 1);
}

TEST_F(Tool, ValuesThatAreNoNumberAreNamedAndPassedOver) {
  const fs::path flight = copy("nan");
  edit(flight / "imu0/data.csv", [](std::string& line, std::size_t row) {
    if (row == 100 || row == 110) line = line.substr(0, line.rfind(',')) + ",nan";
  });
  const Outcome run = rio("replay " + flight.string() + " --json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("imu0/data.csv:101: not finite, the first of 2 such samples"),
            std::string::npos)
      << run.output;
  EXPECT_EQ(nlohmann::json::parse(run.last_line())["scans"], scans());
}

// A driver that has no time yet sends 0.
TEST_F(Tool, ACorruptFirstStampCostsItsOwnSample) {
  for (const std::string stamp : {"0", "-9223372036854775808"}) {
    const fs::path flight = copy("first" + stamp);
    edit(flight / "imu0/data.csv", [&stamp](std::string& line, std::size_t row) {
      if (row == 0) line = stamp + line.substr(line.find(','));
    });
    const Outcome run = rio("replay " + flight.string() + " --json");
    ASSERT_EQ(run.status, 0) << stamp << "\n" << run.output;
    const auto json = nlohmann::json::parse(run.last_line());
    const auto whole = nlohmann::json::parse(rio("replay " + flight_ + " --json").last_line());
    EXPECT_NEAR(json["duration_s"].get<double>(), whole["duration_s"].get<double>(), 0.1) << stamp;
    EXPECT_GT(json["scans"], scans() - 5) << stamp;
    EXPECT_EQ(json["health"].dump().find("1700000"), std::string::npos)
        << stamp << ": " << json["health"];
  }
}

// A third of a flight is no healthy flight.
TEST_F(Tool, TheVerdictSaysHowFewScansWereUsed) {
  const fs::path flight = copy("third");
  std::vector<std::string> samples = lines_of(flight / "imu0/data.csv");
  samples.resize(samples.size() / 3);
  std::ofstream out(flight / "imu0/data.csv");
  for (const std::string& line : samples) out << line << "\n";
  out.close();
  const Outcome run = rio("replay " + flight.string());
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("% of the scans were used"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace rio::test
