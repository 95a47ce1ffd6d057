// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate --live` and `rio live` as a user runs them, side by side, on pseudo-terminals.
#include <algorithm>
#include <atomic>
#include <future>
#include <iostream>
#include <iterator>
#include <thread>

#include "e2e/tool.hpp"
#include "examples/03_live_loop/hardware.hpp"
#include "live/player.hpp"
#include "support/matches.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

constexpr const char* kSpeed = " --speed 3";  // 12 s of flight in 4
constexpr int kTries = 3;                     // of a flight that a busy machine made another

class Live : public Tool {
 protected:
  /// A flight played while the program listens; both programs' outputs.
  static std::pair<Outcome, Outcome> fly(const std::string& name, const std::string& simulate,
                                         const std::string& live) {
    const std::string out = file(name);
    std::ofstream(file("short.yaml")) << "seed: 9\nmax_duration: 12 s\n";
    auto player = std::async(std::launch::async, [&] {
      return try_rio("simulate " + out + " --scenario " + file("short.yaml") + " --live" + kSpeed +
                     simulate);
    });
    for (int i = 0; i < 1000 && !fs::exists(out + "/radar0/port"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    EXPECT_TRUE(fs::exists(out + "/radar0/port"));
    Outcome run = try_rio("live --sensors " + out + " --radar " + out + "/radar0/port --imu " +
                          out + "/imu0/port --patience 0 --json" + kSpeed + live + " 2>/dev/null");
    return {player.get(), run};
  }

  /// Flies until a replay of the recording is the live trajectory to the last digit: a machine that
  /// stands still for long makes data come too late, which happens in no replay. Gives up after
  /// kTries flights, with what the last one and its replay said.
  /// @param run the outputs of the flight that is the replay
  static bool is_its_replay(const std::string& name, const std::string& simulate, Json* run) {
    for (int i = 1; i <= kTries; ++i) {
      const std::string recording = file(name + std::to_string(i));
      const std::string states = recording + ".csv";
      const auto [player, live] =
          fly(name + std::to_string(i) + "_flown", simulate,
              " --record " + recording + " --states " + states + " --out " + recording + ".tum");
      const std::string again = file("again.csv");
      const Outcome replay =
          try_rio("replay " + recording + " --init static --no-check --states " + again);
      if (player.code != 0 || live.code != 0 || replay.code != 0) {
        std::cerr << player.output << live.output << replay.output;
        continue;
      }
      *run = live.json();
      const std::size_t rows = lines_of(states).size();
      if (rows > 50 && equal_rows(states, again) == rows &&
          lines_of(recording + ".tum").size() == rows) {
        return true;
      }
      std::cerr << equal_rows(states, again) << " of " << rows << " rows are those of the replay, "
                << (*run)["counters"] << "\n";
    }
    return false;
  }

  /// Rows of `a` that `b` has to the last digit.
  static std::size_t equal_rows(const std::string& a, const std::string& b) {
    std::vector<std::string> rows = lines_of(a), others = lines_of(b), equal;
    std::sort(rows.begin(), rows.end());
    std::sort(others.begin(), others.end());
    std::set_intersection(rows.begin(), rows.end(), others.begin(), others.end(),
                          std::back_inserter(equal));
    return equal.size();
  }
};

// A file for viewers, a server that nobody has asked and a report: each scan is in the file.
TEST_F(Live, ShowsTheFlightWhileItHappens) {
  const std::string mcap = file("shown.mcap"), page = file("shown.html");
  const auto [player, live] =
      fly("shown", "",
          " --mcap " + mcap + " --view 0 --report " + page + " --states " + file("shown.csv"));
  ASSERT_EQ(live.code, 0) << live.output << player.output;
  EXPECT_GT(live.json()["health"]["seconds"]["initialising"], 1.4);  // from the first sample on
  const std::size_t rows = lines_of(file("shown.csv")).size();
  EXPECT_GT(rows, 50U);
  const Outcome info = rio("info " + mcap);
  for (const std::string topic : {"/tf", "/odometry", "/radar0/points"}) {
    EXPECT_EQ(matches(info.output, topic + " +[^ ]+ +([0-9]+) "),
              std::vector<std::string>{std::to_string(rows)})
        << topic << info.output;
  }
  EXPECT_GT(fs::file_size(page), 100'000U);
}

/// As `| head` does: the flight goes on, and its other outputs.
TEST_F(Live, AReaderThatGoesAwayEndsNoFlight) {
  const std::string path = file("path.tum");
  const auto [player, live] = fly("piped", "", " --out " + path + " --json-lines - | head -n 1");
  EXPECT_GT(lines_of(path).size(), 50U) << live.output << player.output;
}

TEST_F(Live, IsTheReplayOfWhatItRecorded) {
  Json json;
  ASSERT_TRUE(is_its_replay("clean", "", &json));
  EXPECT_EQ(json["live"]["packets_damaged"], 0);
  EXPECT_EQ(json["live"]["packets_lost"], 0);
  EXPECT_EQ(json["live"]["imu_lost"], 0);
  measured("last byte to estimate, median, ms", json["live"]["latency_median_ms"], "1");
  measured("last byte to estimate, p99, ms", json["live"]["latency_p99_ms"],
           "3 without other load");
  measured("CPU, share of a core", json["live"]["cpu_share"].get<double>() / 3.0,
           "0.03 at real speed");
}

/// As a folder and as MCAP: one trajectory.
TEST_F(Live, RecordsMcapThatReplaysAsTheFolder) {
  int code = 1;
  for (int i = 1; code != 0 && i <= kTries; ++i) {  // most frames have no time after a long stall
    for (const char* record : {"f", "f.mcap"}) fs::remove_all(file(record));
    const Outcome run = fly("flown" + std::to_string(i), " --damaged 0.02 --split 0.2",
                            " --record " + file("f") + " --record " + file("f.mcap"))
                            .second;
    code = run.code;
    if (code != 0) std::cerr << run.output;
  }
  ASSERT_EQ(code, 0);
  const auto replay = [](const std::string& recording, const std::string& states) {
    return rio("replay " + recording + " --init static --no-check --states " + file(states));
  };
  replay(file("f"), "f.csv");
  expect_none(replay(file("f.mcap") + " --sensors " + file("f"), "m.csv").output, {"mounting"});
  EXPECT_GT(lines_of(file("f.csv")).size(), 50U);
  EXPECT_EQ(dir_->read("f.csv"), dir_->read("m.csv"));
  rio("info " + file("f.mcap"), {"/radar0  sensor_msgs/PointCloud2", "points preset mav"});
}

/// Killed in flight: all but the last second is there.
TEST_F(Live, AnMcapOfAKilledRunIsReadable) {
  const auto [player, run] =
      fly("killed", "", " --record " + file("k.mcap") + " & sleep 3; kill -9 $!; wait $!; true");
  ASSERT_TRUE(fs::exists(file("k.mcap"))) << run.output;
  fails(1, "info " + file("k.mcap"), {"What stands before was used."});
  fails(1, "convert " + file("k.mcap") + " " + file("k"), {"What stands before was used."});
  const double seconds = static_cast<double>(lines_of(file("k") + "/imu0/data.csv").size()) / 200.0;
  measured("seconds of IMU in 3 s at three times the speed, killed", seconds, "4 to 10");
  EXPECT_GT(seconds, 4.0);
}

TEST_F(Live, OverABadCableIsTheReplayOfWhatItRecorded) {
  Json json;
  ASSERT_TRUE(
      is_its_replay("worn", " --dropped 0.01 --damaged 0.01 --delayed 0.05 --split 0.2", &json));
  EXPECT_GT(json["live"]["packets_lost"], 0);
  EXPECT_GT(json["live"]["imu_lost"], 0);
  expect_none(json["verdict"], {"lost: "});
}

/// The CLI port of a radar: what was sent to it, and an answer to every line.
class CliRadar {
 public:
  explicit CliRadar(std::string refused = "none") : refused_(std::move(refused)) {}
  ~CliRadar() { (void)lines(); }
  const std::string& path() const { return pty_.path(); }
  /// Ends it.
  std::string lines() {
    over_ = true;
    return lines_.get();
  }

 private:
  std::string talk() {
    std::string lines, line;
    while (true) {
      const bool last = over_;
      std::uint8_t byte = 0;
      if (pty_.read(&byte, 1) == 0) {
        if (last) return lines;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      line += static_cast<char>(byte);
      if (byte != '\n') continue;
      lines += line == "\n" ? "" : line;
      const bool no = line.starts_with(refused_);
      line += (no ? "Error: Invalid range\r\nError -1\r\n" : "Done\r\n");
      line += "mmwDemo:/>";
      (void)pty_.write(reinterpret_cast<const std::uint8_t*>(line.data()), line.size());
      line.clear();
    }
  }

  std::string refused_;
  live::Pty pty_;
  std::atomic<bool> over_ = false;
  // last: it uses the others
  std::shared_future<std::string> lines_ =
      std::async(std::launch::async, [this] { return talk(); });
};

TEST_F(Live, SendsTheConfigurationFirst) {
  const std::string cfg = RIO_SOURCE_DIR "/data/awr1843boost_odometry.cfg";
  const std::string live = "live --radar " + file("nothing") + " --imu " + file("no_imu") +
                           " --radar-cfg " + cfg + " --cli ";
  CliRadar radar;
  (void)try_rio(live + radar.path() + " --patience 0");
  std::string wanted;
  for (const std::string& line : lines_of(cfg)) {
    if (!line.starts_with('%')) wanted += line + "\n";
  }
  EXPECT_EQ(radar.lines(), wanted + "sensorStop\n");
  CliRadar lost;  // its port is another thing at the end
  const std::string link = file("cli"), make = "{ sleep 1; rm " + link + "; mkdir " + link + "; }";
  fs::create_symlink(lost.path(), link);
  const Outcome run = run_command(make + " & " RIO_TOOL " " + live + link + " --patience 2");
  expect_parts(run.output, {"note: " + link + ": is a folder", "not stopped", "\nverdict: "});
  CliRadar strict("profileCfg");
  fails(1, live + strict.path() + " --patience 0",
        {"profileCfg: the radar says \"Error: Invalid range; Error -1\""});
}

/// One line to the autopilot, both ways; the program ends by a signal, which comes twice, as that
/// of `timeout` does.
TEST_F(Live, UsesTheImuOfAnAutopilotAndTellsIt) {
  Hardware hardware;
  const std::string& line = hardware.autopilot_port();
  const Outcome run =
      run_command("{ " RIO_TOOL " live --sensors " + flight_ + " --radar " + hardware.radar_port() +
                  " --imu " + line + " --imu-format mavlink --mavlink " + line +
                  " --speed 5 --json & rio=$!; sleep 5; kill -INT $rio; sleep 0.002; "
                  "kill -INT $rio 2>/dev/null; wait $rio; }");
  ASSERT_EQ(run.code, 0) << run.output;
  const Json json = run.json();
  EXPECT_GT(json["scans"], 30);
  EXPECT_GT(hardware.odometry_received(), 200);
  EXPECT_EQ(json["live"]["odometry_sent"], hardware.odometry_received());
}

}  // namespace
}  // namespace rio::test
