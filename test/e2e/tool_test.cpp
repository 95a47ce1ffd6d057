// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program as a user runs it: replay, options; and a real recording where there is one.
// `rio evaluate` is in evaluate_test.cpp, `rio simulate` in simulate_test.cpp, damaged input in
// files_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "e2e/tool.hpp"
#include "rio/files.hpp"
#include "rio/options.hpp"
#include "support/matches.hpp"
#include "support/measured.hpp"
#include "support/real_data.hpp"

namespace rio::test {
namespace {

/// Cells of a row of numbers.
std::vector<double> numbers(const std::string& row) {
  std::vector<double> values;
  std::istringstream in(row);
  for (std::string cell; std::getline(in, cell, ',');) values.push_back(std::stod(cell));
  return values;
}

TEST_F(Tool, ReplaysEveryScanIntoEveryOutput) {
  const struct {
    std::string preset;
    const char* model;  ///< besides the Doppler
    int rows, doppler, clones;
  } presets[] = {{"default", "landmark_point", 1000, 1000, 3},
                 {"published-ekf", "trail_distance", 1000, 1000, 7},
                 {"published-smoother", "trail_distance", 1000, 1000, 10},
                 {"published-uncertainty", "landmark_position", 1000, 1000, 10},
                 {"doppler-only", "ego_velocity", 300, -1, 0}};  // three rows a scan
  EXPECT_EQ(std::size(kPresets), std::size(presets));
  for (const auto& [preset, model, rows, doppler, clones] : presets) {
    SCOPED_TRACE(preset);
    const Json json = rio("replay " + flight_ + " --out " + file("t.tum") + " --states " +
                          file("s.csv") + " --json --preset " + preset)
                          .json();
    EXPECT_EQ(json["scans"], scans());
    for (const char* stage : {"update_ms", "propagation_ms"}) {
      for (const char* figure : {"mean", "median", "p99", "max"})
        EXPECT_GT(json[stage][figure], 0.0);
    }
    EXPECT_GT(json["models"]["doppler"]["rows_used"], doppler);
    expect_none(json["verdict"], {"no scan was used"});
    EXPECT_GT(json["models"][model]["rows_used"], rows);
    EXPECT_EQ(json["clones"], clones);
    EXPECT_EQ(lines_of(file("t.tum")).size(), scans());
    EXPECT_EQ(lines_of(file("s.csv")).size(), scans());
    EXPECT_EQ(numbers(lines_of(file("s.csv"))[0]).size(), 11U + 45U + 6U);
    const Json error = rio("evaluate " + flight_ + " " + file("t.tum") + " --json").json();
    const std::string late = "evaluate " + flight_ + " " + file("t.tum") + " --truth-offset ";
    rio(late + "1.5s",
        {"note: the clocks of truth and ", "t.tum seem to differ: with --truth-offset"});
    expect_none(rio(late + "0").output, {"seem to differ"});
    EXPECT_EQ(error["associated"], scans());
    EXPECT_LT(error["norm_of_rmse_m"], 0.5);
  }
}

TEST_F(Tool, ReplaysWithEitherBackEnd) {
  std::ofstream(file("ekf.yaml")) << "backend: ekf\n";
  std::ofstream(file("smoother.yaml")) << "backend: smoother\n";
  const auto states = [](const std::string& arguments) {
    const Outcome run =
        rio("replay " + flight_ + " --quiet --json --states " + file("b.csv") + " " + arguments);
    EXPECT_EQ(run.json()["scans"], scans()) << arguments;
    return lines_of(file("b.csv"));
  };
  const auto filter = states("");
  const auto window = states("--backend smoother");
  EXPECT_NE(filter, window);
  // the same measurements: in the end, apart by centimetres
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(numbers(filter.back())[1 + axis], numbers(window.back())[1 + axis], 0.2) << axis;
  }
  // the command line wins over preset and file, which alone do the same
  EXPECT_EQ(states("--preset published-smoother --backend ekf"),
            states("--preset published-smoother --config " + file("ekf.yaml")));
  EXPECT_EQ(states("--config " + file("smoother.yaml")), window);
  EXPECT_EQ(states("--config " + file("smoother.yaml") + " --backend ekf"), filter);
  fails(2, "replay " + flight_ + " --backend best", {"--backend"});
}

TEST_F(Tool, PrintsTheSummaryAndAVerdictAndALinePerScanWhenAsked) {
  const auto lines = [](const std::string& options) {
    return matches(rio("replay " + flight_ + options).output, "( s  position )").size();
  };
  EXPECT_EQ(lines(""), 0U);
  EXPECT_EQ(lines(" --verbose"), scans());
  EXPECT_EQ(lines(" --verbose --quiet"), 0U);
}

TEST_F(Tool, TheVerdictSaysWhatIsWrongAndSince) {
  const std::string flight =
      changed("silent", "radar0/data.csv",  // 2 s of silence
              "if (!first) first = $1; if ($1 - first > 10e9 && $1 - first < 12e9) next");
  const Outcome run = rio("replay " + flight);
  EXPECT_EQ(run.last_line().rfind("verdict: doubtful: radar silent for 1.", 0), 0U) << run.output;
  // of the recording, whatever the start
  rio("replay " + flight + " --init static --report " + file("since.html"), {", first at 11."});
  expect_parts(text_of(file("since.html")),
               {"\"events\":[{\"t\":1.55",
                "{\"t\":11.055,\"kind\":\"health\",\"serious\":false,\"text\":\"health: dead "
                "reckoning, radar silent\"}"});
  const Json health = rio("replay " + flight + " --json").json()["health"];
  EXPECT_EQ(health["state"], "ok");
  EXPECT_NEAR(health["seconds"]["dead reckoning"].get<double>(), 1.0, 0.3);
}

TEST_F(Tool, StartsFromAFileAndWithAnotherVelocity) {
  std::ofstream(file("start.yaml")) << "position: [1, 2, 3]\nquaternion_wxyz: [1, 0, 0, 0]\n"
                                       "velocity: [0, 0, 0]\nsigma: {velocity: 2.0}\n";
  const std::string replay = "replay " + flight_ + " --quiet --init " + file("start.yaml");
  rio(replay + " --out " + file("f.tum"));
  double x = 0.0;
  std::istringstream(lines_of(file("f.tum"))[0].substr(21)) >> x;
  EXPECT_NEAR(x, 1.0, 0.05);
  // the velocity is wrong, the covariance knows it, the first scans correct it
  rio(replay + " --init-velocity 1.5 0 0 --states " + file("v.csv"));
  EXPECT_LT(std::abs(numbers(lines_of(file("v.csv"))[15])[8]), 0.1);
}

TEST_F(Tool, StaticStartNeedsNoTruth) {
  const std::string flight = copy("no_truth").string();
  fs::remove_all(flight + "/state_groundtruth_estimate0");
  EXPECT_EQ(rio("replay " + flight + " --json").json()["initialised_by"], "static");
  fails(1, "replay " + flight + " --init groundtruth", {"no ground truth"});
}

TEST_F(Tool, AReplayWithoutAResultIsAnError) {
  fails(3, "replay " + flight_ + " --quiet --preset published-ekf --init-velocity 1000 0 0",
        {"verdict: lost: ", "rio: the estimate is lost: "});
  const fs::path apart = copy("apart");
  std::ofstream(apart / "radar0/data.csv") << "1,1,2,3,0,9,9\n2,1,2,3,0,9,9\n";
  fails(1, "replay --no-check " + apart.string(),
        {"no scan gave an update: the path is that of the IMU alone"});
}

TEST_F(Tool, UnknownOptionsAreRejectedWithASuggestion) {
  std::ofstream(file("bad.yaml")) << "update:\n  max_clone: 5\n";
  fails(1, "replay " + flight_ + " --config " + file("bad.yaml"), {"bad.yaml:2", "max_clones"});
  fails(1, "replay " + flight_ + " --preset best", {"best"});
  fails(1, "replay " + flight_ + " --set update.no_such=1", {"update.no_such=1"});
  fails(1, "check " + flight_ + " --set nonsense", {"is not KEY=VALUE"});
  EXPECT_LE(rio("replay " + flight_ + " --no-check --json --set update.max_landmarks=3")
                .json()["landmarks"],
            3);
}

TEST_F(Tool, PrintedOptionsLeaveTheSensorFilesAloneAndWhatOverridesThemIsSaid) {
  const std::string replay = "replay " + flight_ + " --quiet --no-check --out ";
  rio(replay + file("plain.tum"));
  const std::string printed = rio("options").output;
  std::ofstream(file("my.yaml")) << printed;
  expect_none(rio(replay + file("with.tum") + " --config " + file("my.yaml")).output,
              {"overrides"});
  EXPECT_EQ(lines_of(file("with.tum")), lines_of(file("plain.tum")));

  std::string said = printed;  // two lines of sensors, and one of something else
  const auto say = [&said](const std::string& line, const std::string& instead) {
    ASSERT_NE(said.find(line), std::string::npos) << line;
    said.replace(said.find(line), line.size(), instead);
  };
  say("# sigma_range: ", "sigma_range: 0.2  # ");
  say("# translation: ", "translation: ");
  say(" min_range: ", " min_range: 0.3  # ");
  std::ofstream(file("said.yaml")) << said;
  const Outcome over = try_rio(replay + file("over.tum") + " --config " + file("said.yaml"));
  expect_parts(over.output, {"said.yaml overrides the sensor files: radar.sigma_range = 0.2 (0.03)",
                             "overrides the sensor files: radar.T_BS.translation = [0, 0, 0] (["});
  expect_none(over.output, {"min_range"});
}

TEST_F(Tool, LibraryLoadsTheOptionsThatAReplayFliesWith) {
  std::ofstream(file("some.yaml")) << "preset: published-ekf\nradar: {sigma_range: 0.2}\n";
  const files::Sources sources{
      "", flight_, file("some.yaml"), {"frontend.ransac_seed=4", "radar.fov_azimuth=100 deg"}};
  std::vector<std::string> notes;
  const std::string loaded = files::as_yaml(files::load(sources, &notes));
  rio("options --from " + flight_ + " --config " + file("some.yaml") +
          " --set frontend.ransac_seed=4 --set \"radar.fov_azimuth=100 deg\"",
      {"preset: published-ekf\n", loaded});
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("radar.sigma_range = 0.2 (0.03)"), std::string::npos) << notes[0];
  EXPECT_NE(loaded, files::as_yaml({}));

  for (const auto& wrong : std::vector<files::Sources>{{"no such preset", "", "", {}},
                                                       {"", dir_->path() / "missing", "", {}},
                                                       {"", "", file("missing.yaml"), {}},
                                                       {"", "", "", {"frontend.ransac_sed=4"}}}) {
    EXPECT_THROW((void)files::load(wrong, &notes), std::runtime_error);
    EXPECT_EQ(notes.size(), 1u);
  }
}

TEST_F(Tool, EveryCommandWithAnOptionFileSaysWhatItOverrides) {
  // two seconds: the note comes before the work
  const std::string recording = changed("short", "imu0/data.csv", "if (NR > 401) exit");
  std::ofstream(file("range.yaml")) << "radar: {sigma_range: 0.2}\n";
  const std::string how = " " + recording + " --config " + file("range.yaml");
  for (const char* command : {"replay", "check", "fit-noise", "calibrate"}) {
    const std::string output = try_rio(command + how).output;
    const std::string note = "note: " + file("range.yaml") +
                             " overrides the sensor files: radar.sigma_range = 0.2 (0.03)";
    const std::size_t at = output.find(note);
    EXPECT_NE(at, std::string::npos) << command << "\n" << output;
    EXPECT_EQ(output.find(note, at + 1), std::string::npos) << command << "\n" << output;
  }
}

TEST_F(Tool, PageOfPresetsIsWhatTheProgramSays) {
  expect_parts(text_of(RIO_SOURCE_DIR "/data/presets.md"), {rio("options --compare").output});
}

TEST_F(Tool, WhatCannotActIsRefused) {
  rio("replay " + flight_ + " --quiet --out " + file("r.tum"));
  const std::string tum = file("r.tum ");
  fails(2, "replay " + flight_ + " --view-address 0.0.0.0", {"--view-address requires --view"});
  fails(2, "options --compare --from " + flight_, {"--compare excludes --from"});
  fails(2, "options --compare --preset doppler-only", {"--preset excludes --compare"});
  fails(2, "plot " + tum + "--truth-topic /x --out x.svg", {"--truth-topic requires --truth"});
  fails(1, "evaluate " + flight_ + " " + tum + "--truth-topic /x", {"is no bag, so has no topic"});
  for (const std::string offset : {"inf", "nan", "1e300"}) {
    fails(1, "evaluate " + flight_ + " " + tum + "--truth-offset " + offset,
          {"--truth-offset " + offset + ": no offset of stamps"});
  }
  fails(1, "compare " + tum + "--truth-topic /x", {"--truth-topic: no run is a recording"});
  for (const std::string& option :
       Parts{"--set backend=ekf", "--init static", "--sensors " + flight_}) {
    fails(1, "compare " + tum + option, {"need a recording among the runs"});
  }
  expect_none(fails(1, "compare " + flight_ + " --report /nowhere/c.html",
                    {"/nowhere/c.html: cannot be written: there is no such folder"})
                  .output,
              {"flight ..."});  // before it flies
  fails(1, "replay " + flight_ + " --init-velocity 1e9 0 0",
        {"the start was refused: a position beyond 1e7 m, another value beyond 1e4"});
}

TEST_F(Tool, BenchMeasuresEveryPresetWithEitherBackEnd) {
  const Json json = rio("bench --seconds 2 --detections 20 --json").json();
  ASSERT_EQ(json["rows"].size(), 10U);
  for (const Json& row : json["rows"]) {
    for (const char* figure :
         {"updates", "update_median_ms", "update_p99_ms", "imu_step_us", "create_ms"}) {
      EXPECT_GT(row[figure], 0.0) << figure << " of " << row;
    }
    EXPECT_GT(row["real_time_factor"], 1.0) << row;
  }
  EXPECT_EQ(json["rows"][1]["backend"], "smoother");
  rio("bench --seconds 2 --detections 20", {"published-uncertainty smoother"});
  EXPECT_EQ(try_rio("bench --detections 1025").code, 1);  // more than the options allow
  EXPECT_EQ(try_rio("bench --out chart.svg").code, 2);    // without --growth
}

TEST(RealRecording, RunsThroughAndReturnsToItsStart) {
  const fs::path recording = real_data("ti_demo");
  if (recording.empty()) GTEST_SKIP() << kNoRealData;
  for (const auto& [preset, most] : {std::pair("default", 0.5), {"published-ekf", 2.0}}) {
    const Json json =
        rio("replay " + recording.string() + " --init static --json --preset " + preset).json();
    expect_below(std::string("ti_demo, ") + preset + ": first to last [m]", json["first_to_last_m"],
                 most);
    // scans 1 to 15 fall into the static alignment
    EXPECT_EQ(json["scans"], 397);
  }
}

}  // namespace
}  // namespace rio::test
