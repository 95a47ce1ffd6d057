// SPDX-License-Identifier: BSD-3-Clause
// The `rio` program as a user runs it: replay, evaluate, plot, options, experiment; and
// a real recording where there is one. `rio simulate` is in simulate_test.cpp, damaged input in
// damaged_test.cpp.
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "e2e/tool.hpp"
#include "rio/files.hpp"
#include "rio/options.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

TEST_F(Tool, ReplaysEveryScanIntoEveryOutput) {
  for (const std::string preset : kPresets) {
    const std::string outputs = " --out " + file("t.tum") + " --states " + file("s.csv");
    const Outcome run = rio("replay " + flight_ + outputs + " --json --preset " + preset);
    ASSERT_EQ(run.status, 0) << run.output;
    const auto json = nlohmann::json::parse(run.last_line());
    EXPECT_EQ(json["scans"], scans());
    for (const char* stage : {"update_ms", "propagation_ms"}) {
      for (const char* figure : {"mean", "median", "p99", "max"})
        EXPECT_GT(json[stage][figure], 0.0);
    }
    const bool loose = preset == "doppler-only";  // three rows a scan
    if (!loose) {
      EXPECT_GT(json["models"]["doppler"]["rows_used"], 1000);
    }
    EXPECT_EQ(json["verdict"].get<std::string>().find("no scan was used"), std::string::npos);
    const char* model = loose                               ? "ego_velocity"
                        : preset == "default"               ? "landmark_point"
                        : preset == "published-uncertainty" ? "landmark_position"
                                                            : "trail_distance";
    EXPECT_GT(json["models"][model]["rows_used"], loose ? 300 : 1000) << preset;
    EXPECT_EQ(json["clones"], loose                       ? 0
                              : preset == "default"       ? 3
                              : preset == "published-ekf" ? 7
                                                          : 10);
    EXPECT_EQ(lines_of(file("t.tum")).size(), scans());
    EXPECT_EQ(lines_of(file("s.csv")).size(), scans());
    const std::string row = lines_of(file("s.csv"))[0];
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), 11 + 45 + 6 - 1);
    const auto error =
        nlohmann::json::parse(rio("evaluate " + flight_ + " " + file("t.tum") + " --json").output);
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
    EXPECT_EQ(run.status, 0) << run.output;
    EXPECT_EQ(nlohmann::json::parse(run.last_line())["scans"], scans()) << arguments;
    return lines_of(file("b.csv"));
  };
  const auto filter = states("");
  const auto window = states("--backend smoother");
  EXPECT_NE(filter, window);
  // the same measurements: in the end, apart by centimetres
  for (int axis = 0; axis < 3; ++axis) {
    const auto position = [axis](const std::string& row) {
      std::istringstream in(row);
      std::string cell;
      for (int i = 0; i <= 1 + axis; ++i) std::getline(in, cell, ',');
      return std::stod(cell);
    };
    EXPECT_NEAR(position(filter.back()), position(window.back()), 0.2) << axis;
  }
  // the command line wins over preset and file, which alone do the same
  EXPECT_EQ(states("--preset published-smoother --backend ekf"),
            states("--preset published-smoother --config " + file("ekf.yaml")));
  EXPECT_EQ(states("--config " + file("smoother.yaml")), window);
  EXPECT_EQ(states("--config " + file("smoother.yaml") + " --backend ekf"), filter);
  const Outcome wrong = rio("replay " + flight_ + " --backend best");
  EXPECT_NE(wrong.status, 0);
  EXPECT_NE(wrong.output.find("--backend"), std::string::npos) << wrong.output;
}

TEST_F(Tool, PrintsTheSummaryAndAVerdictAndALinePerScanWhenAsked) {
  const auto count_scans = [](const std::string& output) {
    std::istringstream in(output);
    std::size_t count = 0;
    for (std::string line; std::getline(in, line);) {
      count += line.find(" s  position ") != std::string::npos ? 1 : 0;
    }
    return count;
  };
  Outcome run = rio("replay " + flight_);
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(count_scans(run.output), 0U);
  EXPECT_EQ(run.last_line(), "verdict: healthy");
  EXPECT_EQ(count_scans(rio("replay " + flight_ + " --verbose").output), scans());
  EXPECT_EQ(count_scans(rio("replay " + flight_ + " --verbose --quiet").output), 0U);
}

TEST_F(Tool, TheVerdictSaysWhatIsWrongAndSince) {
  const fs::path flight = copy("silent");
  std::vector<std::string> rows = lines_of(flight / "radar0/data.csv");
  const auto stamp = [](const std::string& row) { return row.substr(0, row.find(',')); };
  const std::int64_t begin = std::stoll(stamp(rows[1]));
  std::ofstream out(flight / "radar0/data.csv");
  for (const std::string& row : rows) {  // 2 s of silence
    const double t =
        row[0] == '#' ? 0.0 : 1e-9 * static_cast<double>(std::stoll(stamp(row)) - begin);
    if (t < 10.0 || t > 12.0) out << row << '\n';
  }
  out.close();
  Outcome run = rio("replay " + flight.string());
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.last_line().rfind("verdict: doubtful: radar silent for 1.", 0), 0U) << run.output;
  run = rio("replay " + flight.string() + " --json");
  const auto json = nlohmann::json::parse(run.last_line());
  EXPECT_EQ(json["health"]["state"], "ok");
  EXPECT_NEAR(json["health"]["seconds"]["dead reckoning"].get<double>(), 1.0, 0.3);
  EXPECT_EQ(json["verdict"].get<std::string>().rfind("doubtful: ", 0), 0U);
}

TEST_F(Tool, StartsFromAFileAndWithAnotherVelocity) {
  std::ofstream(file("start.yaml")) << "position: [1, 2, 3]\nquaternion_wxyz: [1, 0, 0, 0]\n"
                                       "velocity: [0, 0, 0]\nsigma: {velocity: 2.0}\n";
  const std::string replay = "replay " + flight_ + " --quiet --init " + file("start.yaml");
  ASSERT_EQ(rio(replay + " --out " + file("f.tum")).status, 0);
  double x = 0.0;
  std::istringstream(lines_of(file("f.tum"))[0].substr(21)) >> x;
  EXPECT_NEAR(x, 1.0, 0.05);
  // the velocity is wrong, the covariance knows it, the first scans correct it
  const Outcome run =
      rio(replay + " --init-velocity 1.5 0 0 --states " + file("v.csv") + " --json");
  ASSERT_EQ(run.status, 0) << run.output;
  std::istringstream row(lines_of(file("v.csv"))[15]);
  std::vector<double> values;
  for (std::string cell; std::getline(row, cell, ',');) values.push_back(std::stod(cell));
  EXPECT_LT(std::abs(values[8]), 0.1);
}

TEST_F(Tool, StaticStartNeedsNoTruth) {
  const fs::path flight = copy("no_truth");
  fs::remove_all(flight / "state_groundtruth_estimate0");
  const Outcome run = rio("replay " + flight.string() + " --json");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_EQ(nlohmann::json::parse(run.last_line())["initialised_by"], "static");
  const Outcome asked = rio("replay " + flight.string() + " --init groundtruth");
  EXPECT_NE(asked.status, 0);
  EXPECT_NE(asked.output.find("no ground truth"), std::string::npos) << asked.output;
}

TEST_F(Tool, ALostEstimateIsAnError) {
  const Outcome run =
      rio("replay " + flight_ + " --quiet --preset published-ekf --init-velocity 1000 0 0");
  EXPECT_EQ(WEXITSTATUS(run.status), 3);
  EXPECT_NE(run.output.find("verdict: lost: "), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("rio: the estimate is lost: "), std::string::npos) << run.output;
}

TEST_F(Tool, AReplayWithoutAnyScanIsAnError) {
  fs::copy(flight_, file("apart"), fs::copy_options::recursive);
  std::ofstream(file("apart/radar0/data.csv")) << "1,1,2,3,0,9,9\n2,1,2,3,0,9,9\n";
  const Outcome run = rio("replay --no-check " + file("apart"));
  EXPECT_EQ(WEXITSTATUS(run.status), 1);
  EXPECT_PRED2(contains, run.output, "no scan gave an update: the path is that of the IMU alone");
}

TEST_F(Tool, UnknownOptionsAreRejectedWithASuggestion) {
  std::ofstream(file("bad.yaml")) << "update:\n  max_clone: 5\n";
  Outcome run = rio("replay " + flight_ + " --config " + file("bad.yaml"));
  EXPECT_NE(run.status, 0);
  EXPECT_NE(run.output.find("bad.yaml:2"), std::string::npos) << run.output;
  EXPECT_NE(run.output.find("max_clones"), std::string::npos) << run.output;
  run = rio("replay " + flight_ + " --preset best");
  EXPECT_NE(run.status, 0);
}

TEST_F(Tool, PrintedOptionsLoadAgain) {
  for (const std::string preset : {"published-ekf", "published-smoother"}) {
    const Outcome options = rio("options --preset " + preset);
    ASSERT_EQ(options.status, 0);
    std::ofstream(file("all.yaml")) << options.output;
    const Outcome run = rio("replay " + flight_ + " --json --config " + file("all.yaml"));
    ASSERT_EQ(run.status, 0) << run.output;
    EXPECT_EQ(nlohmann::json::parse(run.last_line())["clones"], preset == "published-ekf" ? 7 : 10);
  }
}

TEST_F(Tool, PrintedOptionsLeaveTheSensorFilesAloneAndWhatOverridesThemIsSaid) {
  const std::string replay = "replay " + flight_ + " --quiet --no-check --out ";
  ASSERT_EQ(rio(replay + file("plain.tum")).status, 0);
  const std::string printed = rio("options").output;
  std::ofstream(file("my.yaml")) << printed;
  const Outcome with = rio(replay + file("with.tum") + " --config " + file("my.yaml"));
  ASSERT_EQ(with.status, 0) << with.output;
  EXPECT_EQ(lines_of(file("with.tum")), lines_of(file("plain.tum")));
  EXPECT_EQ(with.output.find("overrides"), std::string::npos) << with.output;

  std::string said = printed;  // two lines of sensors, and one of something else
  const auto say = [&said](const std::string& line, const std::string& instead) {
    ASSERT_NE(said.find(line), std::string::npos) << line;
    said.replace(said.find(line), line.size(), instead);
  };
  say("# sigma_range: ", "sigma_range: 0.2  # ");
  say("# translation: ", "translation: ");
  say(" min_range: ", " min_range: 0.3  # ");
  std::ofstream(file("said.yaml")) << said;
  const Outcome over = rio(replay + file("over.tum") + " --config " + file("said.yaml"));
  EXPECT_NE(
      over.output.find("said.yaml overrides the sensor files: radar.sigma_range = 0.2 (0.03)"),
      std::string::npos)
      << over.output;
  EXPECT_NE(over.output.find("overrides the sensor files: radar.T_BS.translation = [0, 0, 0] (["),
            std::string::npos)
      << over.output;
  EXPECT_EQ(over.output.find("min_range"), std::string::npos) << over.output;
}

TEST_F(Tool, LibraryLoadsTheOptionsThatAReplayFliesWith) {
  std::ofstream(file("some.yaml")) << "preset: published-ekf\nradar: {sigma_range: 0.2}\n";
  const files::Sources sources{
      "", flight_, file("some.yaml"), {"frontend.ransac_seed=4", "radar.fov_azimuth=100 deg"}};
  std::vector<std::string> notes;
  const std::string loaded = files::as_yaml(files::load(sources, &notes));
  const Outcome flown = rio("options --from " + flight_ + " --config " + file("some.yaml") +
                            " --set frontend.ransac_seed=4 --set \"radar.fov_azimuth=100 deg\"");
  ASSERT_EQ(flown.status, 0) << flown.output;
  EXPECT_NE(flown.output.find(loaded), std::string::npos) << flown.output << loaded;
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("radar.sigma_range = 0.2 (0.03)"), std::string::npos) << notes[0];
  EXPECT_NE(loaded, files::as_yaml({}));

  const auto refused = [](const files::Sources& wrong) {
    std::vector<std::string> left{"as before"};
    EXPECT_THROW((void)files::load(wrong, &left), std::runtime_error);
    EXPECT_EQ(left.size(), 1u);
  };
  refused({"no such preset", "", "", {}});
  refused({"", dir_->path() / "missing", "", {}});
  refused({"", "", file("missing.yaml"), {}});
  refused({"", "", "", {"frontend.ransac_sed=4"}});
}

TEST_F(Tool, EveryCommandWithAnOptionFileSaysWhatItOverrides) {
  const fs::path recording = file("two_seconds");  // the note comes before the work
  for (const char* sensor : {"imu0", "radar0"}) {
    fs::create_directories(recording / sensor);
    fs::copy(fs::path(flight_) / sensor / "sensor.yaml", recording / sensor);
    std::vector<std::string> lines = lines_of((fs::path(flight_) / sensor / "data.csv").string());
    lines.resize(401);
    std::ofstream out(recording / sensor / "data.csv");
    for (const std::string& line : lines) out << line << "\n";
  }
  std::ofstream(file("range.yaml")) << "radar: {sigma_range: 0.2}\n";
  const std::string how = " " + recording.string() + " --config " + file("range.yaml");
  for (const char* command : {"replay", "check", "fit-noise", "calibrate"}) {
    const std::string output = rio(command + how).output;
    const std::string note = "note: " + file("range.yaml") +
                             " overrides the sensor files: radar.sigma_range = 0.2 (0.03)";
    const std::size_t at = output.find(note);
    EXPECT_NE(at, std::string::npos) << command << "\n" << output;
    EXPECT_EQ(output.find(note, at + 1), std::string::npos) << command << "\n" << output;
  }
}

TEST_F(Tool, PageOfPresetsIsWhatTheProgramSays) {
  const Outcome table = rio("options --compare");
  ASSERT_EQ(table.status, 0);
  std::stringstream page;
  page << std::ifstream(fs::path(RIO_SOURCE_DIR) / "data" / "presets.md").rdbuf();
  EXPECT_NE(page.str().find(table.output), std::string::npos) << table.output;
}

TEST_F(Tool, ExperimentAllWritesEveryTableOnce) {
  const fs::path out = dir_->path() / "all";
  const std::string block = "<!-- rio experiment consistency -->\nold\n<!-- end -->\n";
  const fs::path page = dir_->write("all.md", "before\n" + block + "after\n");
  const std::string command =
      "experiment all --seeds 2 --out " + out.string() + " --update " + page.string();
  EXPECT_NE(rio("experiment all --out " + out.string()).status, 0);  // no page
  const Outcome first = rio(command);
  ASSERT_EQ(first.status, 0) << first.output;
  EXPECT_NE(first.output.find("consistency: 100 %\n"), std::string::npos) << first.output;
  EXPECT_NE(first.output.find("| default | heading |"), std::string::npos);
  const std::string written = dir_->read("all.md");
  EXPECT_EQ(written.find("old"), std::string::npos);
  EXPECT_NE(written.find("| default | heading |"), std::string::npos);
  const Outcome again = rio(command);
  ASSERT_EQ(again.status, 0) << again.output;
  EXPECT_EQ(again.output, "consistency: written by this program already\n");
  dir_->write("all.md", written + "<!-- rio experiment none -->\n<!-- end -->\n");
  EXPECT_NE(rio(command).output.find("no such experiment: none"), std::string::npos);
}

TEST_F(Tool, ExperimentPrintsAndLeavesReportDataAndChart) {
  const fs::path out = dir_->path() / "experiment";
  const fs::path page = dir_->path() / "page.md";
  std::ofstream(page) << "before\n<!-- rio experiment consistency -->\nold\n<!-- end -->\nafter\n";
  const Outcome run = rio("experiment consistency --seeds 2 --threads 1 --out " + out.string() +
                          " --update " + page.string());
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("| default | heading |"), std::string::npos) << run.output;
  for (const char* name : {"consistency.md", "consistency.csv", "consistency.svg"}) {
    EXPECT_GT(fs::file_size(out / name), 500U) << name;
  }
  std::stringstream text;
  text << std::ifstream(page).rdbuf();
  EXPECT_EQ(text.str().find("old"), std::string::npos);
  EXPECT_EQ(text.str(), "before\n<!-- rio experiment consistency -->\n\n" + run.output +
                            "\n<!-- end -->\nafter\n");
}

TEST_F(Tool, ExperimentRefusesWhatItCannotDo) {
  EXPECT_NE(rio("experiment nonsense").status, 0);
  const fs::path page = dir_->path() / "no_block.md";
  std::ofstream(page) << "nothing here\n";
  const Outcome run = rio("experiment consistency --seeds 1 --out " + dir_->path().string() +
                          " --update " + page.string());
  EXPECT_NE(run.status, 0);
  EXPECT_NE(run.output.find("no block"), std::string::npos) << run.output;
  EXPECT_EQ(lines_of(page).front(), "nothing here");
}

TEST(Results, HaveABlockForEveryExperiment) {
  std::stringstream readme;
  readme << std::ifstream(fs::path(RIO_SOURCE_DIR) / "data/results/README.md").rdbuf();
  const std::string help = rio("experiment --help").output;
  for (const char* name : {"icra2023", "iros2024", "uncertainty", "consistency", "ablation",
                           "robustness", "faults", "checks"}) {
    EXPECT_NE(help.find(name), std::string::npos) << name;
    const std::string begin = std::string("<!-- rio experiment ") + name + " -->\n";
    const std::size_t block = readme.str().find(begin);
    ASSERT_NE(block, std::string::npos) << name;
    // filled: a table follows before the end of the block
    const std::size_t end = readme.str().find("<!-- end -->", block);
    EXPECT_LT(readme.str().find("| --- |", block), end) << name;
  }
}

TEST_F(Tool, PlotsAPicture) {
  ASSERT_EQ(rio("replay " + flight_ + " --quiet --out " + file("p.tum")).status, 0);
  const Outcome run =
      rio("plot " + file("p.tum") + " --truth " + flight_ + " --out " + file("p.svg"));
  ASSERT_EQ(run.status, 0) << run.output;
  std::ifstream in(file("p.svg"));
  const std::string svg((std::istreambuf_iterator<char>(in)), {});
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(svg.find("</svg>"), std::string::npos);
}

TEST_F(Tool, BenchMeasuresEveryPresetWithEitherBackEnd) {
  const Outcome run = rio("bench --seconds 2 --detections 20 --json");
  ASSERT_EQ(run.status, 0) << run.output;
  const auto json = nlohmann::json::parse(run.last_line());
  ASSERT_EQ(json["rows"].size(), 10U);
  for (const auto& row : json["rows"]) {
    for (const char* figure :
         {"updates", "update_median_ms", "update_p99_ms", "imu_step_us", "create_ms"}) {
      EXPECT_GT(row[figure], 0.0) << figure << " of " << row;
    }
    EXPECT_GT(row["real_time_factor"], 1.0) << row;
  }
  EXPECT_EQ(json["rows"][1]["backend"], "smoother");
  const Outcome table = rio("bench --seconds 2 --detections 20");
  EXPECT_PRED2(contains, table.output, "published-uncertainty smoother");
  EXPECT_NE(rio("bench --detections 1025").status, 0);  // more than the options allow
  EXPECT_NE(rio("bench --out chart.svg").status, 0);    // without --growth
}

TEST(RealRecording, RunsThroughAndReturnsToItsStart) {
  const char* data = std::getenv("RIO_TEST_DATA");
  const fs::path recording = fs::path(data != nullptr ? data : "") / "ti_demo";
  if (data == nullptr || !fs::exists(recording)) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recording ti_demo";
  }
  for (const std::string preset : {"default", "published-ekf"}) {
    const Outcome run =
        rio("replay " + recording.string() + " --init static --json --preset " + preset);
    ASSERT_EQ(run.status, 0) << run.output;
    const auto json = nlohmann::json::parse(run.last_line());
    const double closure = json["first_to_last_m"];
    test::measured("ti_demo, " + preset + ": first to last [m]", closure,
                   preset == "default" ? "below 0.5" : "below 2");
    // scans 1 to 15 fall into the static alignment
    EXPECT_EQ(json["scans"], 397);
    EXPECT_LT(closure, preset == "default" ? 0.5 : 2.0);
  }
}

}  // namespace
}  // namespace rio::test
