// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate` and `rio scenarios` as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

TEST_F(Tool, SameSeedWritesTheSameBytesAndTheSameReplay) {
  ASSERT_EQ(rio("simulate " + file("again") + " --seed 9 --length 25").status, 0);
  for (const char* name : {"imu0/data.csv", "radar0/data.csv", "radar0/sensor.yaml",
                           "state_groundtruth_estimate0/data.csv"}) {
    EXPECT_EQ(lines_of(fs::path(flight_) / name), lines_of(fs::path(file("again")) / name)) << name;
  }
  ASSERT_EQ(rio("replay " + flight_ + " --quiet --states " + file("a.csv")).status, 0);
  ASSERT_EQ(rio("replay " + file("again") + " --quiet --states " + file("b.csv")).status, 0);
  EXPECT_EQ(lines_of(file("a.csv")), lines_of(file("b.csv")));
}

const char* const kWritten[] = {"imu0/data.csv",
                                "imu0/sensor.yaml",
                                "radar0/data.csv",
                                "radar0/labels.csv",
                                "radar0/sensor.yaml",
                                "scenario.yaml",
                                "state_groundtruth_estimate0/data.csv"};

/// Every file of two simulated recordings, comments aside.
void expect_equal(const fs::path& a, const fs::path& b) {
  for (const char* name : kWritten) {
    EXPECT_FALSE(lines_of(a / name).empty()) << a / name;
    EXPECT_EQ(lines_of(a / name), lines_of(b / name)) << name;
  }
}

TEST_F(Tool, ScenarioFileOfAFlightReproducesIt) {
  const std::string again = file("flight again");
  ASSERT_EQ(rio("simulate '" + again + "' --scenario " + flight_ + "/scenario.yaml").status, 0);
  expect_equal(flight_, again);
  std::ofstream(file("short.yaml")) << "scenario: storm\npath: {length: 25}\nseed: 3\n";
  const std::string simulate = "simulate " + file("storm") + " --scenario " + file("short.yaml");
  const Outcome run = rio(simulate + " --ideal --seed 5");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("short.yaml, seed 5, 25.0 m"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find(" % static"), std::string::npos) << run.output;
  ASSERT_EQ(rio("simulate " + file("storm2") + " --scenario " + file("storm/scenario.yaml")).status,
            0);
  expect_equal(file("storm"), file("storm2"));
}

TEST_F(Tool, SeveralRadarsOfOneFlight) {
  const Outcome written = rio("simulate " + file("two") + " --length 20 --radars 2");
  ASSERT_EQ(written.status, 0) << written.output;
  const Outcome run = rio("replay " + file("two") + " --json");
  ASSERT_EQ(run.status, 0) << run.output;
  const auto json = nlohmann::json::parse(run.last_line());
  EXPECT_GT(json["scans"], 500);
  EXPECT_EQ(json["counters"]["updates_failed"], 0);
  EXPECT_TRUE(json["calibration"].contains("radar1_rotation_x"));
  EXPECT_NE(rio("replay " + flight_ + " --barometer").status, 0);  // it has none
}

TEST_F(Tool, FliesARecordedTrajectoryWhereverScenarioAndOutputLie) {
  fs::create_directories(file("elsewhere"));
  fs::copy_file(fs::path(flight_) / "state_groundtruth_estimate0/data.csv", file("walk.csv"));
  const std::string relative = fs::relative(file("walk.csv")).string();
  const Outcome run = rio("simulate " + file("walk") + " --trajectory " + relative);
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find(", seed 1, 25.0 m in "), std::string::npos) << run.output;
  std::ofstream(file("elsewhere/s.yaml")) << "path: {file: ../walk.csv}\n";
  ASSERT_EQ(rio("simulate " + file("walk2") + " --scenario " + file("elsewhere/s.yaml")).status, 0);
  expect_equal(file("walk"), file("walk2"));
  ASSERT_EQ(rio("simulate " + file("walk3") + " --scenario " + file("walk2/scenario.yaml")).status,
            0);
  expect_equal(file("walk"), file("walk3"));
}

/// Translation of T_BS in radar0/sensor.yaml.
std::array<double, 3> lever_arm(const fs::path& dataset) {
  std::array<double, 3> arm{};
  std::size_t row = 0;
  for (const std::string& line : lines_of(dataset / "radar0/sensor.yaml")) {
    const std::size_t last = line.rfind(", ", line.size() - 2);
    const bool is_row = line.find('[') != std::string::npos || line.starts_with("         ");
    if (is_row && row < 3) arm.at(row++) = std::stod(line.substr(last + 2));
  }
  return arm;
}

TEST_F(Tool, RecordingTellsTheMountingWrongly) {
  std::ofstream(file("told.yaml")) << "seed: 9\npath: {length: 25}\n"
                                      "told: {extrinsic_distance: 5 cm}\n";
  ASSERT_EQ(rio("simulate " + file("told") + " --scenario " + file("told.yaml")).status, 0);
  EXPECT_EQ(lines_of(file("told") + "/radar0/data.csv"), lines_of(flight_ + "/radar0/data.csv"));
  const std::array<double, 3> told = lever_arm(file("told"));
  const std::array<double, 3> truth = lever_arm(flight_);
  EXPECT_NEAR(std::hypot(told[0] - truth[0], told[1] - truth[1], told[2] - truth[2]), 0.05, 1e-12);
}

TEST_F(Tool, WrongStartIsWrittenAndReplayed) {
  std::ofstream(file("vague.yaml")) << "scenario: vague-velocity\npath: {length: 25}\n";
  const std::string out = file("vague");
  const Outcome run = rio("simulate " + out + " --scenario " + file("vague.yaml"));
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("start.yaml"), std::string::npos) << run.output;
  EXPECT_FALSE(fs::exists(flight_ + "/start.yaml"));
  const std::vector<std::string> start = lines_of(out + "/start.yaml");
  EXPECT_EQ(std::count(start.begin(), start.end(), "velocity: [2, 2, 0]"), 1);  // it stands
  EXPECT_EQ(std::count(start.begin(), start.end(), "  velocity: 2"), 1);        // sigma
  const Outcome replay = rio("replay " + out + " --json --init " + out + "/start.yaml");
  ASSERT_EQ(replay.status, 0) << replay.output;
  EXPECT_EQ(nlohmann::json::parse(replay.last_line())["initialised_by"], "file");
  const Outcome stale = rio("simulate " + out + " --length 25");
  EXPECT_NE(stale.status, 0);
  EXPECT_NE(stale.output.find("start.yaml: is left"), std::string::npos) << stale.output;
}

TEST_F(Tool, ListsScenariosAndPrintsThemAsFiles) {
  const Outcome list = rio("scenarios");
  ASSERT_EQ(list.status, 0) << list.output;
  EXPECT_NE(list.output.find("\nhover  "), std::string::npos) << list.output;
  const Outcome one = rio("scenarios latency");
  ASSERT_EQ(one.status, 0) << one.output;
  EXPECT_NE(one.output.find("\n  latency: 0.08  # [s] "), std::string::npos) << one.output;
  std::ofstream(file("latency.yaml")) << one.output;
  EXPECT_EQ(rio("scenarios " + file("latency.yaml")).output, one.output);
  const std::string simulate = "simulate " + file("latency") + " --length 25 --scenario ";
  const Outcome run = rio(simulate + file("latency.yaml"));
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("latency acts in experiments"), std::string::npos) << run.output;
}

TEST_F(Tool, WrongScenariosAreRejected) {
  std::ofstream(file("wrong.yaml")) << "radar:\n  poeple: 3\n";
  const std::vector<std::array<std::string, 2>> cases = {
      {"--scenario strom", "did you mean \"storm\"?"},
      {"--scenario " + file("wrong.yaml"), "wrong.yaml:2: unknown key \"radar.poeple\""},
      {"--trajectory " + file("none.tum"), "none.tum"},
      {"--trajectory " + flight_ + " --length 30", "--length excludes --trajectory"},
      {"--seed -1", "--seed"},
      {"--length 3", "--length"},
      {"--length nan", "--length: nan is not a number"}};
  for (const auto& [arguments, message] : cases) {
    const Outcome run = rio("simulate " + file("rejected") + " " + arguments);
    EXPECT_NE(run.status, 0) << arguments;
    EXPECT_NE(run.output.find(message), std::string::npos) << run.output;
  }
  EXPECT_FALSE(fs::exists(file("rejected")));
  EXPECT_NE(rio("scenarios strom").status, 0);
}

}  // namespace
}  // namespace rio::test
