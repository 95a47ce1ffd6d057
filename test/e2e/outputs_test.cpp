// SPDX-License-Identifier: BSD-3-Clause
// No command replaces what it reads, or what it was not given to write.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

TEST_F(Tool, InputsAreNotReplaced) {
  const fs::path flight = copy("own");
  const std::string replay = "replay " + flight.string();
  const Parts refused = {"would replace an input"};
  for (const char* input : {"imu0/data.csv", "radar0/sensor.yaml", "scenario.yaml"}) {
    const auto before = fs::file_size(flight / input);
    for (const char* option : {" --out ", " --states "}) {
      fails(1, replay + option + (flight / input).string(), refused);
    }
    EXPECT_EQ(fs::file_size(flight / input), before);
  }
  std::ofstream(file("own.cfg")) << "preset: default\n";
  fs::create_symlink(file("own.cfg"), file("own.link"));
  fails(1, replay + " --config " + file("own.cfg") + " --out " + file("own.link"), refused);
  const std::string tum = file("own.tum");
  fails(1, replay + " --out " + tum + " --states " + tum, {"two outputs"});
  // a result beside the recording may be written again
  const std::string beside = (flight / "estimate.tum").string();
  for (int i = 0; i < 2; ++i) rio(replay + " --quiet --out " + beside);
  fails(1, "plot " + beside + " --out " + beside, refused);
}

TEST_F(Tool, AnOldResultStaysUntilThereIsANewOne) {
  const std::string tum = file("kept.tum");
  std::ofstream(tum) << "# kept\n";
  fails(1, "replay " + flight_ + " --out " + tum + " --states /nowhere/states.csv",
        {"/nowhere/states.csv: cannot be written"});
  EXPECT_EQ(fs::file_size(tum), 7U);
}

TEST_F(Tool, SimulateReplacesNoRecording) {
  const fs::path recording = copy("recorded");
  const std::string simulate = "simulate " + recording.string() + " --length 25";
  rio(simulate);  // its own flight
  fs::remove(recording / "scenario.yaml");
  const auto before = fs::file_size(recording / "imu0/data.csv");
  fails(1, simulate, {"no simulated flight"});
  EXPECT_EQ(fs::file_size(recording / "imu0/data.csv"), before);
  fails(1, "simulate ''", {"the name of the folder is empty"});
}

}  // namespace
}  // namespace rio::test
