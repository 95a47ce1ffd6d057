// SPDX-License-Identifier: BSD-3-Clause
// What commands read and write: what is wrong with a damaged recording is named, nothing is lost
// silently, and one bad stamp or value costs its own row; no command replaces what it reads, or
// what it was not given to write.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

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
  // awk numbers are too short for a stamp: an hour is added to its first digits
  const std::string flight =
      changed("odd_stamps", "radar0/data.csv",
              "if ($1 != last) ++scan; last = $1;"
              "if (scan == 21) $1 = \"-9223372036854775808\";"
              "if (scan == 20 || scan == 22) $1 = substr($1, 1, 10) + 3600 substr($1, 11)");
  const Json json = rio("replay " + flight + " --json").json();
  EXPECT_EQ(json["scans"], scans() - 3);
  EXPECT_EQ(json["counters"]["scans_ahead"], 2);
  EXPECT_EQ(json["counters"]["scans_late"], 1);
}

TEST_F(Tool, ValuesThatAreNoNumberAreNamedAndPassedOver) {
  const std::string flight =
      changed("nan", "imu0/data.csv", "if (NR == 101 || NR == 111) $NF = \"nan\"");
  const Outcome run = rio("replay " + flight + " --json",
                          {"imu0/data.csv:101: not finite, the first of 2 such samples"});
  EXPECT_EQ(run.json()["scans"], scans());
}

// A driver that has no time yet sends 0.
TEST_F(Tool, ACorruptFirstStampCostsItsOwnSample) {
  const double whole = rio("replay " + flight_ + " --json").json()["duration_s"];
  for (const std::string stamp : {"0", "-9223372036854775808"}) {
    const std::string flight =
        changed("first" + stamp, "imu0/data.csv", "if (!row++) $1 = \"" + stamp + "\"");
    const Json json = rio("replay " + flight + " --json").json();
    EXPECT_NEAR(json["duration_s"].get<double>(), whole, 0.1) << stamp;
    EXPECT_GT(json["scans"], scans() - 5) << stamp;
    expect_none(json["health"].dump(), {"1700000"});
  }
}

// A third of a flight is no healthy flight.
TEST_F(Tool, TheVerdictSaysHowFewScansWereUsed) {
  const std::size_t third = lines_of(flight_ + "/imu0/data.csv").size() / 3;
  const std::string flight =
      changed("third", "imu0/data.csv", "if (NR > " + std::to_string(third) + ") exit");
  rio("replay " + flight, {"% of the scans were used"});
}

TEST_F(Tool, InputsAreNotReplaced) {
  const fs::path flight = copy("own");
  const std::string replay = "replay " + flight.string();
  const Parts refused = {"would replace an input"};
  for (const char* input : {"imu0/data.csv", "radar0/sensor.yaml", "scenario.yaml"}) {
    const auto before = fs::file_size(flight / input);
    for (const char* option : {" --out ", " --states ", " --mcap ", " --report "}) {
      fails(1, replay + option + (flight / input).string(), refused);
    }
    EXPECT_EQ(fs::file_size(flight / input), before);
  }
  std::ofstream(file("own.cfg")) << "preset: default\n";
  fs::create_directory(file("log"));
  std::ofstream(file("log/events.csv")) << "#\n";
  fails(1, replay + " --init " + file("log/events.csv") + " --log " + file("log"), refused);
  EXPECT_EQ(fs::file_size(file("log/events.csv")), 2U);
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
  fails(1, "replay /nowhere --mcap " + tum, {"/nowhere"});
  fails(1, "replay " + flight_ + " --report /nowhere/page.html --mcap " + tum,
        {"/nowhere/page.html: cannot be written"});
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
