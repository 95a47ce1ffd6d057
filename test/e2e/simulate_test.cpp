// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate` and `rio scenarios` as a user runs them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "e2e/tool.hpp"
#include "rio/io/dataset.hpp"

namespace rio::test {
namespace {

/// Every file of two simulated recordings, comments aside.
void expect_equal(const fs::path& a, const fs::path& b) {
  for (const char* name :
       {"imu0/data.csv", "imu0/sensor.yaml", "radar0/data.csv", "radar0/labels.csv",
        "radar0/sensor.yaml", "scenario.yaml", "state_groundtruth_estimate0/data.csv"}) {
    EXPECT_FALSE(lines_of(a / name).empty()) << a / name;
    EXPECT_EQ(lines_of(a / name), lines_of(b / name)) << name;
  }
}

TEST_F(Tool, SameSeedWritesTheSameBytesAndTheSameReplay) {
  rio("simulate " + file("again") + " --seed 9 --length 25");
  expect_equal(flight_, file("again"));
  rio("replay " + flight_ + " --quiet --states " + file("a.csv"));
  rio("replay " + file("again") + " --quiet --states " + file("b.csv"));
  EXPECT_EQ(lines_of(file("a.csv")), lines_of(file("b.csv")));
}

TEST_F(Tool, ScenarioFileOfAFlightReproducesIt) {
  const std::string again = file("flight again");
  rio("simulate '" + again + "' --scenario " + flight_ + "/scenario.yaml");
  expect_equal(flight_, again);
  std::ofstream(file("short.yaml")) << "scenario: storm\npath: {length: 25}\nseed: 3\n";
  rio("simulate " + file("storm") + " --scenario " + file("short.yaml") + " --ideal --seed 5",
      {"short.yaml, seed 5, 25.0 m", " % static"});
  rio("simulate " + file("storm2") + " --scenario " + file("storm/scenario.yaml"));
  expect_equal(file("storm"), file("storm2"));
}

/// Their scans share instants: one line of the trajectory for each.
TEST_F(Tool, SeveralRadarsOfOneFlight) {
  rio("simulate " + file("two") + " --length 20 --radars 2", {" + ", " scans, ", " of radar0: "});
  const Json json = rio("replay " + file("two") + " --json --out " + file("two.tum") +
                        " --states " + file("two.csv"))
                        .json();
  EXPECT_GT(json["scans"], 500);
  EXPECT_EQ(json["counters"]["updates_failed"], 0);
  EXPECT_TRUE(json["calibration"].contains("radar1_rotation_x"));
  rio("evaluate " + file("two") + " " + file("two.tum"));
  EXPECT_EQ(lines_of(file("two.tum")).size(), lines_of(file("two.csv")).size());
  fails(1, "replay " + flight_ + " --barometer", {"there is no baro0"});
}

TEST_F(Tool, FliesARecordedTrajectoryWhereverScenarioAndOutputLie) {
  fs::create_directories(file("elsewhere"));
  fs::copy_file(fs::path(flight_) / "state_groundtruth_estimate0/data.csv", file("walk.csv"));
  const std::string relative = fs::relative(file("walk.csv")).string();
  rio("simulate " + file("walk") + " --trajectory " + relative, {", seed 1, 25.0 m in "});
  std::ofstream(file("elsewhere/s.yaml")) << "path: {file: ../walk.csv}\n";
  rio("simulate " + file("walk2") + " --scenario " + file("elsewhere/s.yaml"));
  expect_equal(file("walk"), file("walk2"));
  rio("simulate " + file("walk3") + " --scenario " + file("walk2/scenario.yaml"));
  expect_equal(file("walk"), file("walk3"));
}

TEST_F(Tool, RecordingTellsTheMountingWrongly) {
  std::ofstream(file("told.yaml")) << "seed: 9\npath: {length: 25}\n"
                                      "told: {extrinsic_distance: 5 cm}\n";
  rio("simulate " + file("told") + " --scenario " + file("told.yaml"));
  EXPECT_EQ(lines_of(file("told") + "/radar0/data.csv"), lines_of(flight_ + "/radar0/data.csv"));
  const auto lever_arm = [](const std::string& dataset) {
    return io::read_sensor_info(dataset).radar_info.T_BS->translation;
  };
  EXPECT_NEAR((lever_arm(file("told")) - lever_arm(flight_)).norm(), 0.05, 1e-12);
}

TEST_F(Tool, WrongStartIsWrittenAndReplayed) {
  std::ofstream(file("vague.yaml")) << "scenario: vague-velocity\npath: {length: 25}\n";
  const std::string out = file("vague");
  rio("simulate " + out + " --scenario " + file("vague.yaml"), {"start.yaml"});
  EXPECT_FALSE(fs::exists(flight_ + "/start.yaml"));
  const std::vector<std::string> start = lines_of(out + "/start.yaml");
  EXPECT_EQ(std::count(start.begin(), start.end(), "velocity: [2, 2, 0]"), 1);  // it stands
  EXPECT_EQ(std::count(start.begin(), start.end(), "  velocity: 2"), 1);        // sigma
  const Json json = rio("replay " + out + " --json --init " + out + "/start.yaml").json();
  EXPECT_EQ(json["initialised_by"], "file");
  fails(1, "simulate " + out + " --length 25", {"start.yaml: is left"});
}

TEST_F(Tool, ListsScenariosAndPrintsThemAsFiles) {
  rio("scenarios", {"\nhover  "});
  const std::string one = rio("scenarios latency", {"\n  latency: 0.08  # [s] "}).output;
  std::ofstream(file("latency.yaml")) << one;
  EXPECT_EQ(rio("scenarios " + file("latency.yaml")).output, one);
  rio("simulate " + file("latency") + " --length 25 --scenario " + file("latency.yaml"),
      {"latency acts in experiments"});
}

TEST_F(Tool, WrongScenariosAreRejected) {
  std::ofstream(file("wrong.yaml")) << "radar:\n  poeple: 3\n";
  const std::string simulate = "simulate " + file("rejected");
  fails(1, simulate + " --scenario strom", {"did you mean \"storm\"?"});
  fails(1, simulate + " --scenario " + file("wrong.yaml"),
        {"wrong.yaml:2: unknown key \"radar.poeple\""});
  fails(1, simulate + " --trajectory " + file("none.tum"), {"none.tum"});
  fails(2, simulate + " --trajectory " + flight_ + " --length 30",
        {"--length excludes --trajectory"});
  fails(2, simulate + " --seed -1", {"--seed"});
  fails(2, simulate + " --seed 18446744073709551616", {"18446744073709551616 is too large"});
  fails(2, simulate + " --length 3", {"--length"});
  fails(2, simulate + " --length nan", {"--length: nan is not a number"});
  EXPECT_FALSE(fs::exists(file("rejected")));
  fails(1, "scenarios strom", {"storm"});
}

}  // namespace
}  // namespace rio::test
