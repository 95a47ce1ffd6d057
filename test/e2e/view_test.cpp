// SPDX-License-Identifier: BSD-3-Clause
// What a run leaves to look at: the page, the CSV files, the messages, the live view. The browser
// and the readers of others take part where they are installed (NODE_PATH).
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "e2e/tool.hpp"

namespace rio::test {
namespace {

const std::string kScripts = RIO_SOURCE_DIR "/test/view/";

bool has_node(const std::string& module) {
  return run_command("node -e 'require(\"" + module + "\")'").code == 0;
}

/// Rows of a CSV file by column name.
std::vector<std::map<std::string, std::string>> table(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> names;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::map<std::string, std::string> row;
    std::size_t i = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++i) {
      rows.empty() && names.size() == i ? names.push_back(cell) : void(row[names.at(i)] = cell);
    }
    if (!row.empty()) rows.push_back(row);
  }
  return rows;
}

TEST_F(Tool, TheLogHasEveryScanOfTheRecordingByItsStamp) {
  const std::string log = file("log");
  rio("replay " + flight_ + " --no-check --log " + log);
  const std::set<std::string> recorded = stamps();
  const auto scans = table(log + "/scans.csv");
  EXPECT_GT(scans.size(), recorded.size() - 5);
  for (const auto& row : scans) EXPECT_EQ(recorded.count(row.at("stamp_ns")), 1U);
  std::map<std::string, int> labels;
  for (const auto& row : table(log + "/points.csv")) ++labels[row.at("label")];
  EXPECT_GT(labels["static"], 1000);
  EXPECT_GT(labels["matched"], 300);
  EXPECT_GT(labels["outlier"], 100);
  int gated = 0;
  for (const auto& row : table(log + "/innovations.csv")) {
    if (row.at("result") == "out of domain") continue;
    const double nis = std::stod(row.at("nis"));
    EXPECT_EQ(row.at("result") == "used", nis <= std::stod(row.at("gate")));
    gated += row.at("result") == "gated" ? 1 : 0;
    if (row.at("model") != "doppler") continue;
    const double ratio = std::stod(row.at("innovation")) / std::stod(row.at("sigma"));
    EXPECT_NEAR(ratio * ratio, nis, 1e-6 * (1.0 + nis));
  }
  EXPECT_GT(gated, 0);
  EXPECT_GT(table(log + "/landmarks.csv").size(), 1000U);
  const auto calibration = table(log + "/calibration.csv");
  EXPECT_GT(calibration.size(), 4 * scans.size());
  for (const auto& row : calibration) {
    const std::string& what = row.at("parameter");
    EXPECT_EQ(row.at("unit"), what == "time_offset"                ? "s"
                              : what == "doppler_scale"            ? "1"
                              : what.starts_with("radar_rotation") ? "rad"
                                                                   : "m")
        << what;
  }
  EXPECT_GE(table(log + "/events.csv").size(), 1U);
}

TEST_F(Tool, ThePageIsWholeAndShowsWhatItSays) {
  const std::string page = file("run.html");
  const Outcome run = rio("replay " + flight_ + " --no-check --report " + page);
  EXPECT_LT(fs::file_size(page), 10'000'000U);
  const std::string text = text_of(page);
  expect_parts(text, {"class='verdict healthy'", "Error at the end"});
  expect_none(text, {"src='http"});
  if (!has_node("playwright-core") || !fs::exists("/usr/bin/chromium") ||
      contains(run.output, "libjs")) {
    GTEST_SKIP() << "skipped: needs playwright-core, chromium, libjs-dygraphs and libjs-three";
  }
  const fs::path shots = fs::temp_directory_path() / "rio-report";  // for a person to look at
  fs::create_directories(shots);
  const Outcome look =
      run_command("node " + kScripts + "look_at_report.cjs " + page + " " + shots.string());
  EXPECT_EQ(look.code, 0) << look.output;
}

TEST_F(Tool, TheMessagesAreReadByOthers) {
  const std::string mcap = file("run.mcap");
  rio("replay " + flight_ + " --no-check --out " + file("run.tum") + " --mcap " + mcap);
  if (!has_node("@mcap/core") || !has_node("@foxglove/rosmsg2-serialization")) {
    GTEST_SKIP() << "skipped: needs @mcap/core, @foxglove/rosmsg, @foxglove/rosmsg2-serialization";
  }
  const Outcome read = run_command("node " + kScripts + "read_run.cjs " + mcap);
  ASSERT_EQ(read.code, 0) << read.output;
  const Json topics = Json::parse(read.output);
  const std::vector<std::string> poses = lines_of(file("run.tum"));
  for (const char* topic : {"/tf", "/pose", "/odometry", "/radar0/points", "/landmarks",
                            "/innovations", "/sigma/position", "/health/quality"}) {
    EXPECT_EQ(topics.at(topic).at("count"), poses.size()) << topic;
  }
  const auto& path = topics.at("/path").at("last").at("poses");
  EXPECT_EQ(path.size(), poses.size());
  std::istringstream last(poses.back());
  double t = 0.0, x = 0.0;
  last >> t >> x;
  EXPECT_NEAR(path.back().at("pose").at("position").at("x"), x, 1e-9);
  const auto& odometry = topics.at("/odometry").at("last");
  EXPECT_EQ(odometry.at("child_frame_id"), "imu");
  EXPECT_GT(odometry.at("pose").at("covariance").at(0), 0.0);
  const auto& cloud = topics.at("/radar0/points").at("last");
  EXPECT_EQ(cloud.at("header").at("frame_id"), "radar0");
  EXPECT_EQ(cloud.at("data").size(), cloud.at("width").get<std::size_t>() * 29);
  EXPECT_TRUE(topics.contains("/truth"));
  EXPECT_TRUE(topics.contains("/events"));
}

TEST_F(Tool, ViewersNeitherDelayNorCrashARun) {
  const std::string port = "18765";
  const std::string run =
      std::string(RIO_TOOL) + " replay data/sample_flight --no-check --view " + port;
  if (contains(try_rio("replay /nowhere --view " + port).output, "built without")) {
    GTEST_SKIP() << "skipped: built without libwebsockets";
  }
  if (!has_node("@foxglove/ws-protocol") || !has_node("ws")) {
    GTEST_SKIP() << "skipped: needs @foxglove/ws-protocol, ws, @foxglove/rosmsg2-serialization";
  }
  const std::string watch = "node " + kScripts + "watch.cjs " + port;
  const Outcome all =
      run_command("cd " RIO_SOURCE_DIR "; timeout 12 " + run + " >" + file("a") + " 2>&1 & " +
                  watch + " stall >/dev/null & " + watch + " hostile & " + watch +
                  " watch; kill %2 2>/dev/null; wait %1; echo status $?");
  expect_parts(all.output, {"disconnected", "status 124"});  // it lived to the end
  const std::size_t json = all.output.find("{\"name\":\"rio\"");
  ASSERT_NE(json, std::string::npos) << all.output;
  const Json seen = Json::parse(all.output.substr(json, all.output.find('\n', json) - json));
  EXPECT_GT(seen.at("topics").at("/pose"), 50) << seen;  // of ten seconds at 15 Hz
}

TEST_F(Tool, ComparesVariantsAndOtherEstimates) {
  const std::string tum = file("other.tum");
  rio("replay " + flight_ + " --no-check --out " + tum);
  const std::string page = file("compare.html");
  rio("compare " + flight_ + " " + tum +
          " --vary update.max_landmarks=5,40 --backend ekf --report " + page,
      {"| ekf update.max_landmarks=5 |", "| ekf update.max_landmarks=40 |", "| other |"});
  EXPECT_TRUE(fs::exists(page));
  std::ofstream(file("strange.tum")) << "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n";
  fails(1, "compare " + tum + " " + file("strange.tum"), {"no time in common: other is from "});
  fails(1, "plot " + tum + " --out x.png", {"rsvg-convert"});
}

}  // namespace
}  // namespace rio::test
