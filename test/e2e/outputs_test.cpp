// SPDX-License-Identifier: BSD-3-Clause
// No command replaces what it reads, or what it was not given to write.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

void expect_refused(const Outcome& run, const std::string& why) {
  EXPECT_EQ(WEXITSTATUS(run.status), 1) << run.output;
  EXPECT_NE(run.output.find(why), std::string::npos) << run.output;
}

TEST_F(Tool, InputsAreNotReplaced) {
  const fs::path flight = copy("own");
  const std::string name = flight.string();
  for (const char* input : {"imu0/data.csv", "radar0/sensor.yaml", "scenario.yaml"}) {
    const auto before = fs::file_size(flight / input);
    for (const char* option : {" --out ", " --states "}) {
      expect_refused(rio("replay " + name + option + (flight / input).string()),
                     "would replace an input");
    }
    EXPECT_EQ(fs::file_size(flight / input), before);
  }
  std::ofstream(file("own.cfg")) << "preset: default\n";
  fs::create_symlink(file("own.cfg"), file("own.link"));
  expect_refused(
      rio("replay " + name + " --config " + file("own.cfg") + " --out " + file("own.link")),
      "would replace an input");
  const std::string tum = file("own.tum");
  expect_refused(rio("replay " + name + " --out " + tum + " --states " + tum), "two outputs");
  // a result beside the recording may be written again
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(rio("replay " + name + " --quiet --out " + name + "/estimate.tum").status, 0);
  }
  expect_refused(rio("plot " + name + "/estimate.tum --out " + name + "/estimate.tum"),
                 "would replace an input");
}

TEST_F(Tool, AnOldResultStaysUntilThereIsANewOne) {
  const std::string tum = file("kept.tum");
  std::ofstream(tum) << "# kept\n";
  expect_refused(rio("replay " + flight_ + " --out " + tum + " --states /nowhere/states.csv"),
                 "/nowhere/states.csv: cannot be written");
  EXPECT_EQ(fs::file_size(tum), 7U);
}

TEST_F(Tool, SimulateReplacesNoRecording) {
  const fs::path recording = copy("recorded");
  EXPECT_EQ(rio("simulate " + recording.string() + " --length 25").status, 0) << "its own flight";
  fs::remove(recording / "scenario.yaml");
  const auto before = fs::file_size(recording / "imu0/data.csv");
  expect_refused(rio("simulate " + recording.string() + " --length 25"), "no simulated flight");
  EXPECT_EQ(fs::file_size(recording / "imu0/data.csv"), before);
  expect_refused(rio("simulate ''"), "the name of the folder is empty");
}

// Their scans share instants: one line for each.
TEST_F(Tool, TheTrajectoryOfSeveralRadarsIsOne) {
  const std::string flight = file("radars");
  ASSERT_EQ(rio("simulate " + flight + " --seed 2 --length 25 --radars 2").status, 0);
  ASSERT_EQ(rio("replay " + flight + " --quiet --out " + file("radars.tum") + " --states " +
                file("radars.csv"))
                .status,
            0);
  const Outcome run = rio("evaluate " + flight + " " + file("radars.tum"));
  EXPECT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(lines_of(file("radars.tum")).size(), lines_of(file("radars.csv")).size());
}

}  // namespace
}  // namespace rio::test
