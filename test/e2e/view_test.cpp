// SPDX-License-Identifier: BSD-3-Clause
// What a run leaves to look at: the page, the CSV files, the messages, the live view. The browser
// and the readers of others take part where they are installed (NODE_PATH).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
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

/// The way through the positions of a trajectory [m].
double length_of(const fs::path& tum) {
  double length = 0.0;
  std::vector<double> last;
  for (const std::string& line : lines_of(tum)) {
    std::istringstream in(line);
    std::vector<double> row(4);
    for (double& value : row) in >> value;
    if (!last.empty()) length += std::hypot(row[1] - last[1], row[2] - last[2], row[3] - last[3]);
    last = row;
  }
  return length;
}

/// The float32 values of a column of a page.
std::vector<float> column_of(const Json& data, const std::string& name) {
  const TempDir dir;
  const fs::path text = dir.write("column", data.at("columns").at(name).get<std::string>());
  const std::string bytes = run_command("base64 -d " + text.string()).output;
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

/// Opens a page in a browser, if one is there.
/// @param said by the program: a library may be missing
void look_at(const std::string& page, const std::string& name, const std::string& said) {
  if (!has_node("playwright-core") || !fs::exists("/usr/bin/chromium") || contains(said, "libjs")) {
    GTEST_SKIP() << "skipped: needs playwright-core, chromium, libjs-dygraphs and libjs-three";
  }
  const fs::path shots = fs::temp_directory_path() / name;  // for a person to look at
  fs::create_directories(shots);
  const Outcome look =
      run_command("node " + kScripts + "look_at_report.cjs " + page + " " + shots.string());
  EXPECT_EQ(look.code, 0) << look.output;
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
  expect_none(text, {"src='http", "the truth ends"});
  look_at(page, "rio-report", run.output);
}

TEST_F(Tool, ThePageSaysWhereTheTruthEnds) {
  const std::string half = halved("half_a_truth", "state_groundtruth_estimate0/data.csv");
  const std::string page = file("half.html");
  rio("replay " + half + " --no-check --report " + page);
  const std::vector<float> error = column_of(data_of(page), "e.x");
  const std::vector<float> time = column_of(data_of(page), "t");
  std::size_t last = error.size() - 1;
  while (!std::isfinite(error[last])) --last;
  std::ostringstream end;
  end << ", at " << std::fixed << std::setprecision(1) << time[last] << " s: there the truth ends";
  EXPECT_LT(time[last], 0.6 * time.back());
  expect_parts(text_of(page), {end.str()});
}

TEST_F(Tool, ThePageShowsWhatIsEstimated) {
  const std::string page = file("same.html");
  const std::string log = file("same_log");
  rio("replay " + flight_ + " --no-check --report " + page + " --log " + log);
  const Json data = data_of(page);
  const auto scans = table(log + "/scans.csv");
  const std::vector<std::pair<std::string, std::string>> same = {
      {"p.x", "p_x_m"}, {"sp.y", "sigma_p_y_m"}, {"v.z", "v_z_mps"}, {"n.ms", "update_ms"}};
  for (const auto& [column, name] : same) {
    const std::vector<float> shown = column_of(data, column);
    ASSERT_EQ(shown.size(), scans.size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
      const double logged = std::stod(scans[i].at(name));
      EXPECT_NEAR(shown[i], logged, 1e-6 * (1.0 + std::abs(logged))) << column << " of scan " << i;
    }
  }
  // what is drawn at special values has room for them
  for (const Json& plot : data.at("plots")) {
    if (plot.at("range").empty()) continue;
    for (const double line : plot.at("lines")) {
      EXPECT_GT(line, plot.at("range").at(0));
      EXPECT_LT(line, plot.at("range").at(1));
    }
  }
}

TEST_F(Tool, ThePageShowsEventsAfterTheLastScan) {
  const std::string silent = halved("silent_half", "radar0/data.csv");
  const std::string page = file("silent_half.html");
  const Outcome run = rio("replay " + silent + " --no-check --report " + page);
  const Json data = data_of(page);
  EXPECT_GT(data.at("events").back().at("t").get<float>(), column_of(data, "t").back());
  look_at(page, "rio-silent", run.output);
}

TEST_F(Tool, ThePageShowsTheCalibrationOfEachRadarWithoutGaps) {
  const std::string folder = file("two");
  rio("simulate " + folder + " --seed 3 --length 20 --radars 2");
  const Json run = rio("replay " + folder + " --no-check --json --out " + file("two.tum") +
                       " --report " + file("two.html"))
                       .json();
  EXPECT_NEAR(run.at("path_length_m").get<double>(), length_of(file("two.tum")), 1e-3);
  std::ostringstream rmse;  // a pose each instant, as in the trajectory
  rmse << std::fixed << std::setprecision(3) << path_error(folder, file("two.tum"));
  expect_parts(text_of(file("two.html")),
               {"<dt>Position error (RMSE)</dt><dd>" + rmse.str() + " m</dd>"});
  const Json data = data_of(file("two.html"));
  for (const char* name : {"sradar_rotation_x", "sradar1_rotation_x"}) {
    const std::vector<float> sigma = column_of(data, name);
    EXPECT_LE(std::count_if(sigma.begin(), sigma.end(), [](float s) { return std::isnan(s); }), 1)
        << name;  // at most before its first scan
  }
}

TEST_F(Tool, ThePageSaysWhatIsDoubtfulAboutTheRecording) {
  const std::string folder =
      changed("in_g", "imu0/data.csv", "for (i = 5; i < 8; ++i) $i = $i * 101.97");
  const Outcome run =
      try_rio("replay --init groundtruth " + folder + " --report " + file("doubts.html"));
  expect_parts(text_of(file("doubts.html")),
               {"<h2>Doubts about the recording</h2>", "<td>accelerometer unit</td><td>wrong</td>",
                "multiply the last three columns"});
  look_at(file("doubts.html"), "rio-report-without-scans", run.output);
}

TEST_F(Tool, OneOutputThatFailsLeavesTheOthers) {
  const std::string replay = "replay " + flight_ + " --no-check --log " + file("kept");
  fails(1, replay + " --mcap /dev/full --report " + file("kept.html"),
        {"/dev/full: cannot be written", "left out from here on"});
  EXPECT_GT(table(file("kept/scans.csv")).size(), scans() - 5);
  expect_parts(text_of(file("kept.html")), {"class='verdict healthy'"});
  fails(1, replay + " --report " + file("kept"), {"kept: cannot be written: it is a folder"});
  std::ofstream(file("kept.mcap")) << "of a run before";
  fails(1, replay + " --view --view-address 203.0.113.1 --mcap " + file("kept.mcap"),
        {"203.0.113.1"});
  EXPECT_EQ(text_of(file("kept.mcap")), "of a run before");
}

TEST_F(Tool, AnEstimateOfAnotherTimeIsTold) {
  const std::string replay = "replay " + flight_ + " --no-check --quiet --mcap " + file("run.mcap");
  const std::string same = file("same.tum");
  const std::string later = file("later.tum");
  rio(replay + " --out " + same);
  std::ofstream shifted(later);
  for (const std::string& line : lines_of(same)) {
    std::istringstream in(line);
    double t = 0.0;
    in >> t;
    shifted << std::fixed << t + 3600.0 << in.rdbuf() << "\n";
  }
  shifted.close();
  const Outcome run = rio(replay + " --also " + same + " --also " + later,
                          {"note: --also later: no time in common with this run"});
  EXPECT_EQ(run.output.find("--also same"), std::string::npos) << run.output;
}

TEST_F(Tool, TheMessagesAreReadByOthers) {
  const std::string mcap = file("run.mcap");
  const std::string other = file("other.tum");
  rio("replay " + flight_ + " --no-check --preset doppler-only --out " + other);
  rio("replay " + flight_ + " --no-check --out " + file("run.tum") + " --also " + other +
      " --mcap " + mcap);
  EXPECT_NEAR(path_error(flight_, mcap), path_error(flight_, file("run.tum")), 1e-5);
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
  EXPECT_EQ(topics.at("/path/other").at("last").at("poses").size(), lines_of(other).size());
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
  EXPECT_EQ(seen.at("topics").at("/truth"), 1) << seen;  // sent once, before a viewer came
}

}  // namespace
}  // namespace rio::test
