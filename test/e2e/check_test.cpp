// SPDX-License-Identifier: BSD-3-Clause
// `rio check` as a user runs it; with RIO_TEST_DATA also on real recordings.
#include <tuple>

#include "e2e/tool.hpp"
#include "support/real_data.hpp"

namespace rio::test {
namespace {

using Check = Tool;

TEST_F(Check, AFlightIsFine) {
  const Outcome run =
      rio("check " + flight_, {"imu stamps", "accelerometer unit", "gyro unit", "clocks", "Doppler",
                               "axes and Doppler sign", "delay of the radar"});
  expect_none(run.output, {"wrong "});
}

TEST_F(Check, SaysWhatIsWrongAndExitsWithThree) {
  const std::string folder = changed("sign", "radar0/data.csv", "if ($5 != \"\") $5 = -$5");
  const Parts wrong = {"the Doppler has the wrong sign", "negate the column doppler"};
  fails(3, "check " + folder, wrong);
  expect_parts(try_rio("replay " + folder).output, wrong);
}

TEST_F(Check, WhatItProposesIsAnOptionFileThatPutsItRight) {
  const fs::path folder = copy("late_and_turned");
  const std::vector<std::string> rows = lines_of(folder / "radar0/data.csv");
  std::ofstream csv(folder / "radar0/data.csv");
  for (const std::string& row : rows) {
    csv << std::stoll(row) + 100'000'000 << row.substr(row.find(',')) << "\n";
  }
  csv.close();
  std::ofstream(folder / "radar0/sensor.yaml") << "rate_hz: 15\n";  // nothing of the mounting
  const std::string before = try_rio("check " + folder.string()).output;
  const std::size_t at = before.find("\nradar: {");
  ASSERT_NE(at, std::string::npos) << before;
  const std::string line = before.substr(at + 1, before.find('\n', at + 1) - at);
  expect_parts(line, {"time_offset: 0.", "T_BS: "});
  std::ofstream(file("proposed.yaml")) << line;
  rio("check " + folder.string() + " --config " + file("proposed.yaml"));
}

TEST_F(Check, AxesUnitsAndSignOfAFolderAreOptions) {
  const std::string digits = "CONVFMT = \"%.17g\"; ";
  const std::string points =
      changed("points", "radar0/data.csv",
              digits + "if ($5 != \"\") { x = $2; $2 = -$3; $3 = x; $5 = -$5 }");
  const std::string imu = changed("imu", "imu0/data.csv",
                                  digits +
                                      "for (i = 2; i < 5; ++i) $i *= (i > 2 ? -1 : 1) * "
                                      "57.295779513082321; for (i = 5; i < 8; ++i) $i *= (i > 5 ? "
                                      "-1 : 1) / 9.80665");
  const std::string quiet = "replay --quiet --no-check ";
  rio(quiet + flight_ + " --out " + file("as_flown.tum"));
  rio(quiet + points + " --axes ti --approaching --out " + file("points.tum"));
  rio(quiet + imu + " --imu-axes frd --gyro-unit deg/s --accel-unit g --out " + file("imu.tum"));
  EXPECT_EQ(dir_->read("points.tum"), dir_->read("as_flown.tum"));
  EXPECT_LT(path_error(file("as_flown.tum"), file("imu.tum")), 1e-3);
  rio("convert " + points + " " + file("right") + " --axes ti --approaching");
  rio(quiet + file("right") + " --sensors " + flight_ + " --out " + file("right.tum"));
  EXPECT_EQ(dir_->read("right.tum"), dir_->read("as_flown.tum"));
}

TEST_F(Check, JsonHoldsTheSame) {
  const std::string folder =
      changed("degrees", "imu0/data.csv", "for (i = 2; i < 5; ++i) $i = $i * 57.29578");
  const Json json = fails(3, "check --json " + folder, {}).json();
  EXPECT_EQ(json["verdict"], "wrong");
  int wrong = 0;
  for (const Json& finding : json["findings"]) {
    if (finding["verdict"] != "wrong") continue;
    ++wrong;
    EXPECT_EQ(finding["subject"], "gyro unit") << finding;
  }
  EXPECT_EQ(wrong, 1);
}

TEST_F(Check, TakesTheMountingFromAFile) {
  dir_->write("turned.yaml",
              "radar: {T_BS: {translation: [0, 0, 0], quaternion_wxyz: [0, 0, 0, 1]}}\n");
  // the flight is too gentle to name the turn, but what is told explains nothing of it
  const std::string nothing = "the radar explains 0 % of the movement";
  expect_none(try_rio("check " + flight_).output, {nothing});
  expect_parts(try_rio("check " + flight_ + " --config " + file("turned.yaml")).output, {nothing});
}

TEST_F(Check, AReplayEndsWithWhatIsNotOk) {
  rio("replay " + flight_, {"\ndata: nothing found\nverdict: healthy\n"});
  expect_none(rio("replay --no-check " + flight_, {"verdict: healthy\n"}).output, {"data: "});
  // whatever becomes of the estimate, the checks do not change the exit status
  const std::string folder =
      changed("milli", "imu0/data.csv", "for (i = 5; i < 8; ++i) $i = $i * 101.97");
  const int code = try_rio("replay --no-check --init groundtruth " + folder).code;
  fails(code, "replay --init groundtruth " + folder,
        {"\ndata wrong: accelerometer unit: ", " -> multiply the last three columns",
         "note: something is wrong with the recording"});
}

TEST_F(Check, AReplayTakesStepsOfAClockOut) {
  rio("replay --quiet " + flight_ + " --out " + file("as_flown.tum"));
  std::string folder;
  for (const auto& [csv, by, note] :
       {std::tuple("radar0/data.csv", "3e8", "radar0 steps by +0.300 s at scan "),
        std::tuple("imu0/data.csv", "3e8", "the IMU steps by +0.300 s at sample "),
        std::tuple("imu0/data.csv", "-45e6", "the IMU steps by -0.045 s at sample ")}) {
    const std::string step =
        std::string("if (!first) first = $1; if ($1 - first > 6e9) $1 = sprintf(\"%.0f\", $1 + ") +
        by + ")";
    folder = changed(std::string(csv, 4) + by, csv, step);
    const std::string out = folder + ".tum";
    rio("replay " + folder + " --out " + out,
        {std::string("note: the clock of ") + note, "a clock steps within"});
    EXPECT_LT(path_error(flight_, out), path_error(flight_, file("as_flown.tum")) + 0.01);
    expect_none(try_rio("replay --no-check " + folder).output, {"steps by"});
  }
  for (const std::string command : {"calibrate ", "fit-noise "}) {
    rio(command + folder, {"note: the clock of the IMU steps by -0.045 s at sample "});
  }
}

TEST_F(Check, AReplayGivesWhatIsNotOkAsJson) {
  EXPECT_EQ(rio("replay --json " + flight_).json()["data"], Json::array());
  EXPECT_FALSE(rio("replay --json --no-check " + flight_).json().contains("data"));
  const std::string folder = changed("repeated", "imu0/data.csv", "if (NR % 20 == 0) print");
  const Json json = rio("replay --json " + folder).json();
  ASSERT_EQ(json["data"].size(), 1U) << json;
  EXPECT_EQ(json["data"][0]["verdict"], "doubtful");
  EXPECT_EQ(json["data"][0]["subject"], "imu stamps");
}

TEST_F(Check, AReplayThatCannotStartPrintsWhatCheckFinds) {
  const std::string replay = "replay --init static ";
  const std::string in_g =
      changed("in_g", "imu0/data.csv", "for (i = 5; i <= 7; ++i) $i /= 9.80665");
  fails(1, replay + in_g,
        {"no start: the estimator found no standstill",
         "it is in g -> multiply the last three columns of imu0/data.csv by 9.80665"});
  fails(1, replay + "--no-check " + in_g, {"`rio check`"});
  // what was asked for is complete, if without an estimate
  fails(1, replay + in_g + " --mcap " + file("none.mcap") + " --report " + file("none.html"),
        {"no start"});
  rio("info " + file("none.mcap"));
  expect_parts(text_of(file("none.html")), {"no scan was used"});

  // at rest in the end only; nowhere
  const std::string option = "start: {max_wait: 3}";
  rio(replay + changed("late", "imu0/data.csv", "if (NR < 1600) next"),
      {" scans are before it, and dropped -> " + option});
  const std::size_t end = lines_of(fs::path(flight_) / "imu0/data.csv").size() - 1000;
  const std::string moving =
      changed("moving", "imu0/data.csv", "if (NR < 1600 || NR > " + std::to_string(end) + ") next");
  fails(1, replay + moving, {"no standstill of 1.5 s", "-> " + option});
  // with the line of `check`, pasted
  fs::remove_all(fs::path(moving) / "state_groundtruth_estimate0");
  expect_parts(try_rio("check " + moving).output, {"\n" + option + "\n"});
  std::ofstream(file("wait.yaml")) << option << "\n";
  rio("replay " + moving + " --config " + file("wait.yaml"),
      {"start: in motion\n", "data: nothing found"});
}

TEST_F(Check, NothingToCheck) {
  fails(1, "check " + file("nothing"), {"nothing"});
  fails(2, "check", {"RECORDING"});
}

TEST_F(Check, NothingIsWrongInRealRecordings) {
  const fs::path data = real_data("");
  if (data.empty()) GTEST_SKIP() << kNoRealData;
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    if (!entry.is_directory() || !fs::exists(entry.path() / "radar0/data.csv")) continue;
    ++count;
    rio("check " + entry.path().string());
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace rio::test
