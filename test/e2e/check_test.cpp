// SPDX-License-Identifier: BSD-3-Clause
// `rio check` as a user runs it; with RIO_TEST_DATA also on real recordings.
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

using Json = nlohmann::json;

class Check : public Tool {
 protected:
  static int exit_code(const Outcome& run) { return WEXITSTATUS(run.status); }

  /// The flight with the columns of a file changed by an awk program.
  static std::string changed(const std::string& name, const std::string& csv,
                             const std::string& awk) {
    const fs::path folder = copy(name);
    const std::string file = (folder / csv).string();
    const std::string command =
        "awk -F, -v OFS=, -v CONVFMT=%.12g -v OFMT=%.12g '/^#/ {print; "
        "next} {" +
        awk + "; print}' " + file + " > " + file + ".new && mv " + file + ".new " + file;
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return folder.string();
  }
};

TEST_F(Check, AFlightIsFine) {
  const Outcome run = rio("check " + flight_);
  EXPECT_EQ(exit_code(run), 0) << run.output;
  for (const char* subject : {"imu stamps", "accelerometer unit", "gyro unit", "clocks", "Doppler",
                              "axes and Doppler sign", "delay of the radar"}) {
    EXPECT_NE(run.output.find(subject), std::string::npos) << subject << "\n" << run.output;
  }
  EXPECT_EQ(run.output.find("wrong "), std::string::npos) << run.output;
}

TEST_F(Check, SaysWhatIsWrongAndExitsWithThree) {
  const std::string folder = changed("sign", "radar0/data.csv", "if ($5 != \"\") $5 = -$5");
  const Outcome run = rio("check " + folder);
  EXPECT_EQ(exit_code(run), 3) << run.output;
  EXPECT_NE(run.output.find("the Doppler has the wrong sign"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("negate the column doppler"), std::string::npos) << run.output;
}

TEST_F(Check, WhatItProposesIsAnOptionFileThatPutsItRight) {
  const fs::path folder = copy("late_and_turned");
  const std::vector<std::string> rows = lines_of((folder / "radar0/data.csv").string());
  std::ofstream csv(folder / "radar0/data.csv");
  for (const std::string& row : rows) {
    const std::size_t comma = row.find(',');
    csv << (row[0] == '#' ? row : std::to_string(std::stoll(row) + 100'000'000) + row.substr(comma))
        << "\n";
  }
  csv.close();
  std::ofstream(folder / "radar0/sensor.yaml") << "rate_hz: 15\n";  // nothing of the mounting
  const std::string before = rio("check " + folder.string()).output;
  const std::size_t at = before.find("\nradar: {");
  ASSERT_NE(at, std::string::npos) << before;
  const std::string line = before.substr(at + 1, before.find('\n', at + 1) - at);
  EXPECT_NE(line.find("time_offset: 0."), std::string::npos) << line;
  EXPECT_NE(line.find("T_BS: "), std::string::npos) << line;
  std::ofstream(file("proposed.yaml")) << line;
  const Outcome after = rio("check " + folder.string() + " --config " + file("proposed.yaml"));
  EXPECT_EQ(exit_code(after), 0) << after.output;
}

TEST_F(Check, JsonHoldsTheSame) {
  const std::string folder =
      changed("degrees", "imu0/data.csv", "for (i = 2; i < 5; ++i) $i = $i * 57.29578");
  const Outcome run = rio("check --json " + folder);
  EXPECT_EQ(exit_code(run), 3) << run.output;
  const std::size_t begin = run.output.find('{');  // beside what stands on stderr
  ASSERT_NE(begin, std::string::npos) << run.output;
  const Json json = Json::parse(run.output.substr(begin, run.output.find('\n', begin) - begin));
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
  const Outcome as_recorded = rio("check " + flight_);
  EXPECT_EQ(as_recorded.output.find(nothing), std::string::npos) << as_recorded.output;
  const Outcome turned = rio("check " + flight_ + " --config " + file("turned.yaml"));
  EXPECT_NE(turned.output.find(nothing), std::string::npos) << turned.output;
}

TEST_F(Check, AReplayEndsWithWhatIsNotOk) {
  const Outcome fine = rio("replay " + flight_);
  EXPECT_EQ(exit_code(fine), 0) << fine.output;
  EXPECT_NE(fine.output.find("\ndata: nothing found\nverdict: healthy\n"), std::string::npos)
      << fine.output;
  EXPECT_EQ(rio("replay --no-check " + flight_).last_line(), "verdict: healthy");
  // whatever becomes of the estimate, the checks do not change the exit status
  const std::string folder =
      changed("milli", "imu0/data.csv", "for (i = 5; i < 8; ++i) $i = $i * 101.97");
  const Outcome wrong = rio("replay --init groundtruth " + folder);
  EXPECT_EQ(exit_code(wrong), exit_code(rio("replay --no-check --init groundtruth " + folder)));
  EXPECT_NE(wrong.output.find("\ndata wrong: accelerometer unit: "), std::string::npos)
      << wrong.output;
  EXPECT_NE(wrong.output.find(" -> multiply the last three columns"), std::string::npos);
  EXPECT_NE(wrong.output.find("note: something is wrong with the recording"), std::string::npos);
}

TEST_F(Check, AReplayGivesWhatIsNotOkAsJson) {
  const Json fine = Json::parse(rio("replay --json " + flight_).last_line());
  EXPECT_EQ(fine["data"], Json::array());
  EXPECT_FALSE(
      Json::parse(rio("replay --json --no-check " + flight_).last_line()).contains("data"));
  const std::string folder = changed("repeated", "imu0/data.csv", "if (NR % 20 == 0) print");
  const Outcome run = rio("replay --json " + folder);
  EXPECT_EQ(exit_code(run), 0) << run.output;  // doubtful
  const Json json = Json::parse(run.last_line());
  ASSERT_EQ(json["data"].size(), 1U) << run.output;
  EXPECT_EQ(json["data"][0]["verdict"], "doubtful");
  EXPECT_EQ(json["data"][0]["subject"], "imu stamps");
}

TEST_F(Check, AReplayThatCannotStartPrintsWhatCheckFinds) {
  const std::string in_g =
      changed("in_g", "imu0/data.csv", "for (i = 5; i <= 7; ++i) $i /= 9.80665");
  Outcome run = rio("replay --init static " + in_g);
  EXPECT_EQ(exit_code(run), 1);
  EXPECT_PRED2(contains, run.output, "no start: the estimator found no standstill");
  EXPECT_PRED2(contains, run.output,
               "it is in g -> multiply the last three columns of imu0/data.csv by 9.80665");
  EXPECT_PRED2(contains, rio("replay --init static --no-check " + in_g).output, "`rio check`");

  // at rest in the end only; nowhere
  const std::string option = "start: {max_wait: 3}";
  run = rio("replay --init static " + changed("late", "imu0/data.csv", "if (NR < 1600) next"));
  EXPECT_EQ(exit_code(run), 0) << run.output;
  EXPECT_PRED2(contains, run.output, " scans are before it, and dropped -> " + option);
  const std::size_t end = lines_of(fs::path(flight_) / "imu0/data.csv").size() - 1000;
  const std::string moving =
      changed("moving", "imu0/data.csv", "if (NR < 1600 || NR > " + std::to_string(end) + ") next");
  run = rio("replay --init static " + moving);
  EXPECT_EQ(exit_code(run), 1) << run.output;
  EXPECT_PRED2(contains, run.output, "no standstill of 1.5 s");
  EXPECT_PRED2(contains, run.output, "-> " + option);
  // with the line of `check`, pasted
  fs::remove_all(fs::path(moving) / "state_groundtruth_estimate0");
  const Outcome check = rio("check " + moving);
  EXPECT_PRED2(contains, check.output, "\n" + option + "\n");
  std::ofstream(file("wait.yaml")) << option << "\n";
  run = rio("replay " + moving + " --config " + file("wait.yaml"));
  EXPECT_EQ(exit_code(run), 0) << run.output;
  EXPECT_PRED2(contains, run.output, "data: nothing found");
}

TEST_F(Check, NothingToCheck) {
  EXPECT_EQ(exit_code(rio("check " + file("nothing"))), 1);
  EXPECT_EQ(exit_code(rio("check")), 2);
}

TEST_F(Check, NothingIsWrongInRealRecordings) {
  const char* data = std::getenv("RIO_TEST_DATA");
  if (data == nullptr) GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with recordings";
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(data)) {
    if (!entry.is_directory() || !fs::exists(entry.path() / "radar0/data.csv")) continue;
    ++count;
    const Outcome run = rio("check " + entry.path().string());
    EXPECT_EQ(exit_code(run), 0) << entry.path() << "\n" << run.output;
  }
  EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace rio::test
