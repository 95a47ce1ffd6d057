// SPDX-License-Identifier: BSD-3-Clause
// `rio replay` of damaged recordings: what is wrong is named, nothing is lost silently, and one bad
// stamp or value costs its own row.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

/// Rows changed one by one; `change` gets the number of the row. Comments are dropped.
void edit(const fs::path& file, const std::function<void(std::string&, std::size_t)>& change) {
  std::vector<std::string> lines = lines_of(file);
  std::ofstream out(file);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    change(lines[i], i);
    out << lines[i] << "\n";
  }
}

TEST_F(Tool, DamagedDataNamesFileAndLineAndIsUsedUpToThere) {
  const fs::path flight = copy("damaged");
  const fs::path radar = flight / "radar0/data.csv";
  const std::string replay = "replay " + flight.string() + " --quiet";
  fs::resize_file(radar, fs::file_size(radar) - 30);  // cut inside the last row
  fails(1, replay,
        {"verdict: healthy", "the file ends inside of this line\nWhat stands before was used.",
         "radar0/data.csv:"});
  fs::remove(radar);
  fails(1, replay, {"radar0/data.csv"});
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
  const Json json = rio("replay " + flight.string() + " --json").json();
  EXPECT_EQ(json["scans"], scans() - 3);
  EXPECT_EQ(json["counters"]["scans_ahead"], 2);
  EXPECT_EQ(json["counters"]["scans_late"], 1);
}

TEST_F(Tool, ValuesThatAreNoNumberAreNamedAndPassedOver) {
  const fs::path flight = copy("nan");
  edit(flight / "imu0/data.csv", [](std::string& line, std::size_t row) {
    if (row == 100 || row == 110) line = line.substr(0, line.rfind(',')) + ",nan";
  });
  const Outcome run = rio("replay " + flight.string() + " --json",
                          {"imu0/data.csv:101: not finite, the first of 2 such samples"});
  EXPECT_EQ(run.json()["scans"], scans());
}

// A driver that has no time yet sends 0.
TEST_F(Tool, ACorruptFirstStampCostsItsOwnSample) {
  const double whole = rio("replay " + flight_ + " --json").json()["duration_s"];
  for (const std::string stamp : {"0", "-9223372036854775808"}) {
    const fs::path flight = copy("first" + stamp);
    edit(flight / "imu0/data.csv", [&stamp](std::string& line, std::size_t row) {
      if (row == 0) line = stamp + line.substr(line.find(','));
    });
    const Json json = rio("replay " + flight.string() + " --json").json();
    EXPECT_NEAR(json["duration_s"].get<double>(), whole, 0.1) << stamp;
    EXPECT_GT(json["scans"], scans() - 5) << stamp;
    expect_none(json["health"].dump(), {"1700000"});
  }
}

// A third of a flight is no healthy flight.
TEST_F(Tool, TheVerdictSaysHowFewScansWereUsed) {
  const fs::path flight = copy("third");
  std::vector<std::string> samples = lines_of(flight / "imu0/data.csv");
  std::ofstream out(flight / "imu0/data.csv");
  for (std::size_t i = 0; i < samples.size() / 3; ++i) out << samples[i] << "\n";
  out.close();
  rio("replay " + flight.string(), {"% of the scans were used"});
}

}  // namespace
}  // namespace rio::test
