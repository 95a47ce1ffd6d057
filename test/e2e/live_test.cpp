// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate --live` and `rio live` as a user runs them, side by side, on pseudo-terminals.
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <future>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "e2e/tool.hpp"
#include "examples/03_live_loop/hardware.hpp"
#include "live/pty.hpp"
#include "rio/sim/ti_packet.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

using Json = nlohmann::json;

constexpr const char* kSpeed = " --speed 3";  // 12 s of flight in 4
constexpr int kTries = 3;                     // of a flight that a busy machine made another

class Live : public Tool {
 protected:
  static bool appears(const std::string& path) {
    for (int i = 0; i < 1000 && !fs::exists(path); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return fs::exists(path);
  }

  /// A flight played while the program listens; both programs' outputs.
  static std::pair<Outcome, Outcome> fly(const std::string& name, const std::string& simulate,
                                         const std::string& live) {
    const std::string out = file(name);
    std::ofstream(file("short.yaml")) << "seed: 9\nmax_duration: 12 s\n";
    auto player = std::async(std::launch::async, [&] {
      return rio("simulate " + out + " --scenario " + file("short.yaml") + " --live" + kSpeed +
                 simulate);
    });
    EXPECT_TRUE(appears(out + "/radar0/port"));
    Outcome run = rio("live --sensors " + out + " --radar " + out + "/radar0/port --imu " + out +
                      "/imu0/port --patience 0 --json" + kSpeed + live + " 2>/dev/null");
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
          rio("replay " + recording + " --init static --no-check --states " + again);
      if (player.status != 0 || live.status != 0 || replay.status != 0) {
        std::cerr << player.output << live.output << replay.output;
        continue;
      }
      *run = Json::parse(live.last_line());
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

  /// States by stamp.
  static std::map<std::string, std::string> states_of(const std::string& path) {
    std::map<std::string, std::string> rows;
    for (const std::string& line : lines_of(path)) {
      const std::size_t comma = line.find(',');
      rows[line.substr(0, comma)] = line.substr(comma);
    }
    return rows;
  }

  /// Rows of `a` that `b` has to the last digit.
  static std::size_t equal_rows(const std::string& a, const std::string& b) {
    const auto other = states_of(b);
    std::size_t equal = 0;
    for (const auto& [stamp, row] : states_of(a)) {
      const auto found = other.find(stamp);
      equal += found != other.end() && found->second == row ? 1 : 0;
    }
    return equal;
  }
};

// A file for viewers, a server that nobody has asked and a report: each scan is in the file.
TEST_F(Live, ShowsTheFlightWhileItHappens) {
  const std::string mcap = file("shown.mcap"), page = file("shown.html");
  const auto [player, live] =
      fly("shown", "",
          " --mcap " + mcap + " --view 0 --report " + page + " --states " + file("shown.csv"));
  ASSERT_EQ(live.status, 0) << live.output << player.output;
  const std::size_t rows = lines_of(file("shown.csv")).size();
  EXPECT_GT(rows, 50U);
  const Outcome info = rio("info " + mcap);
  ASSERT_EQ(info.status, 0) << info.output;
  for (const char* topic : {"/tf ", "/odometry ", "/radar0/points "}) {
    const std::size_t at = info.output.find(topic);
    ASSERT_NE(at, std::string::npos) << topic << info.output;
    std::string type;
    std::size_t messages = 0;
    std::istringstream(info.output.substr(at + std::string(topic).size())) >> type >> messages;
    EXPECT_EQ(messages, rows) << topic;
  }
  EXPECT_GT(fs::file_size(page), 100'000U);
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
  const auto [player, run] = fly("flown", " --damaged 0.02 --split 0.2",
                                 " --record " + file("f") + " --record " + file("f.mcap"));
  ASSERT_EQ(run.status, 0) << run.output;
  const auto replay = [](const std::string& recording, const std::string& states) {
    return rio("replay " + recording + " --init static --no-check --states " + file(states));
  };
  ASSERT_EQ(replay(file("f"), "f.csv").status, 0);
  const Outcome mcap = replay(file("f.mcap") + " --sensors " + file("f"), "m.csv");
  ASSERT_EQ(mcap.status, 0) << mcap.output;
  EXPECT_EQ(mcap.output.find("mounting"), std::string::npos) << mcap.output;
  EXPECT_GT(lines_of(file("f.csv")).size(), 50U);
  EXPECT_EQ(dir_->read("f.csv"), dir_->read("m.csv"));
  const Outcome info = rio("info " + file("f.mcap"));
  EXPECT_EQ(info.status, 0) << info.output;
  EXPECT_NE(info.output.find("/radar0  sensor_msgs/PointCloud2"), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("points preset mav"), std::string::npos) << info.output;
}

/// Killed in flight: all but the last second is there.
TEST_F(Live, AnMcapOfAKilledRunIsReadable) {
  const auto [player, run] =
      fly("killed", "", " --record " + file("k.mcap") + " & sleep 3; kill -9 $!; wait $!; true");
  ASSERT_TRUE(fs::exists(file("k.mcap"))) << run.output;
  const Outcome info = rio("info " + file("k.mcap"));
  EXPECT_EQ(WEXITSTATUS(info.status), 1);
  EXPECT_NE(info.output.find("What stands before was used."), std::string::npos) << info.output;
  const Outcome convert = rio("convert " + file("k.mcap") + " " + file("k"));
  EXPECT_EQ(WEXITSTATUS(convert.status), 1);
  measured("seconds of IMU in 3 s at three times the speed, killed",
           static_cast<double>(lines_of(file("k") + "/imu0/data.csv").size()) / 200.0, "4 to 10");
  EXPECT_GT(lines_of(file("k") + "/imu0/data.csv").size(), 4U * 200);
}

/// Every scan that was recorded is one that was sent: its points, to float precision.
TEST_F(Live, ABadCableInventsNothing) {
  const auto [player, run] = fly("bad", " --dropped 0.01 --damaged 0.01 --delayed 0.05 --split 0.2",
                                 " --record " + file("bad_rec"));
  ASSERT_EQ(run.status, 0) << run.output;
  const Json json = Json::parse(run.last_line());
  EXPECT_GT(json["live"]["packets_lost"], 0);
  EXPECT_GT(json["live"]["imu_lost"], 0);
  EXPECT_FALSE(json["verdict"].get<std::string>().starts_with("lost"));
  const auto points = [](const fs::path& dataset) {
    std::map<std::string, std::vector<std::array<float, 4>>> scans;
    for (const std::string& line : lines_of(dataset / "radar0/data.csv")) {
      std::array<float, 4> point{};
      std::istringstream fields(line);
      std::string stamp, field;
      std::getline(fields, stamp, ',');
      for (float& value : point) {
        std::getline(fields, field, ',');
        value = field.empty() ? 0.0F : std::stof(field);
      }
      scans[stamp].push_back(point);
    }
    std::vector<std::vector<std::array<float, 4>>> sorted;
    for (auto& [stamp, scan] : scans) sorted.push_back(std::move(scan));
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  };
  const auto sent = points(file("bad"));
  const auto came = points(file("bad_rec"));
  std::size_t accounted = came.size();
  for (const char* what : {"packets_lost", "packets_made_up", "packets_untimed"}) {
    accounted += json["live"][what].get<std::size_t>();
  }
  EXPECT_GT(accounted + 10, sent.size());  // before the IMU, and at the end
  EXPECT_LT(came.size(), sent.size());
  EXPECT_TRUE(std::includes(sent.begin(), sent.end(), came.begin(), came.end()));
}

TEST_F(Live, OverABadCableIsTheReplayOfWhatItRecorded) {
  Json json;
  EXPECT_TRUE(
      is_its_replay("worn", " --dropped 0.01 --damaged 0.01 --delayed 0.05 --split 0.2", &json));
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
    if (thread_.joinable()) thread_.join();
    return lines_;
  }

 private:
  void talk() {
    std::string line;
    while (true) {
      const bool last = over_;
      std::uint8_t byte = 0;
      if (pty_.read(&byte, 1) == 0) {
        if (last) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        continue;
      }
      line += static_cast<char>(byte);
      if (byte != '\n') continue;
      lines_ += line == "\n" ? "" : line;
      const bool no = line.starts_with(refused_);
      answer(line + (no ? "Error: Invalid range\r\nError -1\r\n" : "Done\r\n") + "mmwDemo:/>");
      line.clear();
    }
  }
  void answer(const std::string& text) {
    (void)pty_.write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }

  std::string refused_;
  live::Pty pty_;
  std::string lines_;
  std::atomic<bool> over_ = false;
  std::thread thread_{[this] { talk(); }};  // last: it uses the others
};

TEST_F(Live, SendsTheConfigurationFirst) {
  const std::string cfg = RIO_SOURCE_DIR "/data/awr1843boost_odometry.cfg";
  const std::string live = "live --patience 0 --radar " + file("nothing") + " --imu " +
                           file("nothing") + " --radar-cfg " + cfg + " --cli ";
  CliRadar radar;
  (void)rio(live + radar.path());
  std::string wanted;
  for (const std::string& line : lines_of(cfg)) {
    if (!line.starts_with('%')) wanted += line + "\n";
  }
  EXPECT_EQ(radar.lines(), wanted + "sensorStop\n");
  CliRadar strict("profileCfg");
  const Outcome refused = rio(live + strict.path());
  EXPECT_EQ(WEXITSTATUS(refused.status), 1);
  EXPECT_NE(refused.output.find("profileCfg: the radar says \"Error: Invalid range; Error -1\""),
            std::string::npos)
      << refused.output;
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
  ASSERT_EQ(run.status, 0) << run.output;
  const Json json = Json::parse(run.last_line());
  EXPECT_GT(json["scans"], 30);
  EXPECT_GT(hardware.odometry_received(), 200);
  EXPECT_EQ(json["live"]["odometry_sent"], hardware.odometry_received());
}

/// The IMU of a flight, and packets of such points, read at once: what the program says and its
/// status.
TEST_F(Live, FailsWhereNoScanIsOfUse) {
  const auto write = [](const std::string& name, const sim::Bytes& bytes) {
    std::ofstream(file(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<long>(bytes.size()));
    return file(name);
  };
  const auto said = [&](std::uint32_t packets, float range) {
    sim::Bytes log;
    for (std::uint32_t number = 1; number <= packets; ++number) {
      const std::vector<sim::WrittenPoint> points(9, {range, range, 0.0F, 1.0F, 200, 400});
      const sim::Bytes bytes = sim::packet_of(number, points).bytes();
      log.insert(log.end(), bytes.begin(), bytes.end());
    }
    const Outcome run = rio("live --sensors " + flight_ + " --radar " + write("log.bin", log) +
                            " --imu-format csv --imu " + flight_ + "/imu0/data.csv --patience 0");
    EXPECT_EQ(WEXITSTATUS(run.status), 1) << run.output;
    return run.output;
  };
  const std::string at_once = said(300, 3.0F), far_away = said(1, 1e30F);
  EXPECT_NE(at_once.find("rio: radar 0: the packets come all at once"), std::string::npos)
      << at_once;
  EXPECT_NE(far_away.find("no scan gave an update"), std::string::npos) << far_away;
}

/// Two radars without a scan: each with its cause, in every place.
TEST_F(Live, SaysOfEachRadarWhyThereAreNoScans) {
  const auto write = [](const std::string& name, const sim::Bytes& bytes) {
    std::ofstream(file(name), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<long>(bytes.size()));
    return file(name);
  };
  sim::Bytes old;
  for (std::uint32_t number = 1; number <= 9; ++number) {
    sim::WrittenPacket packet = sim::packet_of(number, {});
    packet.version = 0x02010004;
    const sim::Bytes bytes = packet.bytes();
    old.insert(old.end(), bytes.begin(), bytes.end());
  }
  const std::string text = "mmwDemo:/>sensorStart\r\nDone\r\n\r\nmmwDemo:/>";
  const std::string command = "live --sensors " + flight_ + " --radar " + write("old.bin", old) +
                              " --radar " + write("cli.bin", {text.begin(), text.end()}) +
                              " --imu " + file("nothing") + " --patience 0";
  const char* causes[] = {"radar 0: packets of SDK 1 or 2, which are not read: load a demo of SDK",
                          "radar 1: no packets, but text: this is the CLI port"};
  const std::string to_files =
      "sh -c '" RIO_TOOL " " + command + " >" + file("summary") + " 2>" + file("log") + "'";
  EXPECT_EQ(WEXITSTATUS(run_command(to_files).status), 1);
  const std::string log = dir_->read("log"), summary = dir_->read("summary");
  const Outcome json = rio(command + " --json 2>/dev/null");
  EXPECT_EQ(WEXITSTATUS(json.status), 1);
  const Json live = Json::parse(json.last_line())["live"];
  ASSERT_EQ(live["radars"].size(), 2U);
  EXPECT_EQ(live["radars"][0]["other_firmware"], 9);
  for (std::size_t r = 0; r < 2; ++r) {
    const std::string cause = causes[r];
    EXPECT_NE(log.find(cause), std::string::npos) << log;
    EXPECT_NE(summary.find(cause.substr(9)), std::string::npos) << summary;
    const std::string problem = live["radars"][r]["problem"];
    EXPECT_EQ(problem.rfind(cause.substr(9), 0), 0U) << problem;
  }
}

TEST_F(Live, WrongCommandLines) {
  const std::string imu = "--imu " + file("nothing") + " --patience 0";
  EXPECT_EQ(WEXITSTATUS(rio("live " + imu).status), 2);
  const Outcome no_rate = rio("live --radar " + file("nothing") + " " + imu);
  EXPECT_NE(no_rate.output.find("frame rate of the radar is not known"), std::string::npos)
      << no_rate.output;
  const Outcome folder = rio("ti-config " + flight_);
  EXPECT_NE(folder.output.find(flight_ + ": is a folder"), std::string::npos) << folder.output;
  const Outcome nothing =
      rio("live --radar " + file("nothing") + " " + imu + " --sensors " + flight_);
  EXPECT_EQ(WEXITSTATUS(nothing.status), 1);
  EXPECT_NE(nothing.output.find("nothing is not there"), std::string::npos) << nothing.output;
  EXPECT_NE(nothing.output.find("no sample of the IMU"), std::string::npos) << nothing.output;
}

}  // namespace
}  // namespace rio::test
