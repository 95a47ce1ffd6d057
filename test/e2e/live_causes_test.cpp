// SPDX-License-Identifier: BSD-3-Clause
// Why `rio live` gets no scan, no sample or no start.
#include <algorithm>
#include <future>
#include <thread>

#include "e2e/tool.hpp"
#include "live/imu_stream.hpp"
#include "live/player.hpp"
#include "rio/io/dataset.hpp"
#include "rio/mavlink/frame.hpp"
#include "rio/sim/ti_packet.hpp"

namespace rio::test {
namespace {

using Line = std::vector<live::Piece>;

class LiveCauses : public Tool {
 protected:
  static const io::Dataset& recorded() {
    static const io::Dataset kRecorded = io::read_dataset(flight_);
    return kRecorded;
  }
  static Line imu() { return live::imu_line(recorded().imu, live::Cable({})).pieces(); }
  /// Of every so manyth scan.
  static Line radar(std::size_t every = 1) {
    const double rate = recorded().radar_info.rate_hz.value() / static_cast<double>(every);
    std::vector<RadarScan> scans;
    for (std::size_t i = 0; i < recorded().scans.size(); i += every) {
      scans.push_back(recorded().scans[i]);
    }
    return live::radar_line(scans, live::simulated_timing(rate), live::Cable({})).pieces();
  }

  /// The run on ports on which these bytes come in time: of the IMU, of each radar.
  static Outcome hear(const std::vector<Line>& lines, const std::string& more) {
    const volatile std::sig_atomic_t never = 0;
    std::vector<live::Pty> ports(lines.size());
    std::string command =
        "live --patience 0 --json --speed 5 " + more + " --imu " + ports[0].path();
    for (std::size_t r = 1; r < ports.size(); ++r) command += " --radar " + ports[r].path();
    auto run = std::async(std::launch::async, [&] { return try_rio(command); });
    const auto is_open = [](const live::Pty& port) { return port.is_open(); };
    for (int i = 0; i < 500 && !std::all_of(ports.begin(), ports.end(), is_open); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    live::play(live::in_order(lines), 5.0, never, [&](const live::Event& event) {
      return ports[event.line].write(event.piece->bytes.data(), event.piece->bytes.size());
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(200));  // unread bytes are lost
    ports.clear();
    return run.get();
  }
};

/// The first so many seconds.
Line first(double seconds, Line line) {
  const Time end = line.front().due + from_seconds(seconds);
  std::erase_if(line, [end](const live::Piece& piece) { return piece.due > end; });
  return line;
}

/// The packet as it comes from a port.
std::string text_of(const sim::WrittenPacket& packet) {
  const sim::Bytes bytes = packet.bytes();
  return {bytes.begin(), bytes.end()};
}

template <class Message>
std::string mavlink_of(const Message& message) {
  std::string frame(mavlink::kMaxFrame, '\0');
  auto* const bytes = reinterpret_cast<std::uint8_t*>(frame.data());
  frame.resize(mavlink::Writer({1, 1}).write(message, bytes, frame.size()));
  return frame;
}

/// The IMU of a flight, and packets of such points, read at once.
TEST_F(LiveCauses, FailsWhereNoScanIsOfUse) {
  const auto log_of = [&](std::uint32_t packets, float range, const std::string& rest = "") {
    std::string log = rest;
    for (std::uint32_t number = 1; number <= packets; ++number) {
      const std::vector<sim::WrittenPoint> points(9, {range, range, 0.0F, 1.0F, 200, 400});
      log += text_of(sim::packet_of(number, points));
    }
    return dir_->write("log.bin", log).string();
  };
  const std::string live = "live --sensors " + flight_ + " --imu-format csv --imu " + flight_ +
                           "/imu0/data.csv --patience 0 --radar ";
  fails(1, live + log_of(300, 3.0F), {"rio: radar 0: the packets come all at once"});
  fails(1, live + log_of(1, 1e30F), {"no scan gave an update: their points or times"});
  fails(1, live + log_of(1, 3.0F) + " --imu-clock host",
        {"rio: no scan gave an update: the stamps of the IMU are -",
         " s off this machine's clock: --imu-clock own"});
  std::string damaged;
  for (int i = 0; i < 40; ++i) damaged += text_of(sim::packet_of(1, {})).substr(0, 44);
  fails(1, live + log_of(1, 3.0F, damaged), {"40 packets are damaged, 1 whole: bytes are lost"});
}

/// Two radars without a scan: each with its cause, in every place.
TEST_F(LiveCauses, SaysOfEachRadarWhyThereAreNoScans) {
  std::string old;
  for (std::uint32_t number = 1; number <= 9; ++number) {
    sim::WrittenPacket packet = sim::packet_of(number, {});
    packet.version = 0x02010004;
    old += text_of(packet);
  }
  const std::string text = "mmwDemo:/>sensorStart\r\nDone\r\n\r\nmmwDemo:/>";
  const std::string command = "live --sensors " + flight_ + " --radar " +
                              dir_->write("old.bin", old).string() + " --radar " +
                              dir_->write("cli.bin", text).string() + " --imu " + file("no_imu") +
                              " --patience 0";
  const std::string causes[] = {"packets of SDK 1 or 2, which are not read: load a demo of SDK",
                                "no packets, but text: this is the CLI port"};
  fails(1, command + " --report " + file("page.html") + " >" + file("summary"),
        {"radar 0: " + causes[0], "radar 1: " + causes[1]});
  expect_parts(dir_->read("summary"), {causes[0], causes[1]});
  expect_parts(dir_->read("page.html"), {"<dt>Scans</dt><dd>radar 0: " + causes[0], causes[1]});
  const Json radars = fails(1, command + " --json 2>/dev/null", {}).json()["live"]["radars"];
  ASSERT_EQ(radars.size(), 2U);
  EXPECT_EQ(radars[0]["other_firmware"], 9);
  for (std::size_t r = 0; r < 2; ++r) {
    const std::string problem = radars[r]["problem"];
    EXPECT_TRUE(problem.starts_with(causes[r])) << problem;
  }
  // the error does not stand within a line, in a pipe of both
  const std::string all = fails(1, command + " --json", {}).output;
  EXPECT_LT(all.rfind('}'), all.find("rio: radar 0: "));
}

/// What comes instead of samples from the port of the IMU.
TEST_F(LiveCauses, SaysWhyThereAreNoSamples) {
  const std::string other = ": another port, baud rate or --imu-format";
  const std::string text = "1,0,0,0,0,0\n", radar = text_of(sim::packet_of(1, {}));
  const std::string frame = "RI\1" + std::string(35, '\x90');
  const std::string heartbeat = mavlink_of(mavlink::Heartbeat{});
  const std::string without = ", but MAVLink without a usable ";
  const std::string raw_imu = mavlink_of(mavlink::RawImu{});
  const std::string ubx = "\xB5\x62 and more", pixhawk = "\xFE>\7\1\1i and more";
  const struct {
    std::string bytes, format, said;
  } rows[] = {
      {"", "binary", ": no byte came"},
      {radar + radar, "binary", ", but packets of a TI radar: give the port of the IMU; --imu and"},
      {radar + radar, "mavlink",
       ", but packets of a TI radar: give the port of the IMU; --imu and"},
      {std::string(300, '\xE6'), "binary", " in 300 bytes" + other},  // as by another baud rate
      {std::string(300, '\xE6'), "mavlink", " in 300 bytes" + other},
      {"$GNGGA,123519,4807.038,N\r\n", "csv", " in 26 bytes" + other},
      {text, "csv", ", but numbers in text, as of an IMU: --imu-format csv, in the columns"},
      {"1 0 0 0 0 0 9.8\n", "csv", " in 16 bytes" + other + ", or no lines of seven numbers with"},
      {text, "mavlink-raw", ", but numbers in text, as of an IMU: --imu-format csv"},
      {ubx + ubx + ubx, "binary", ", but UBX of a GNSS receiver: not read; send its samples"},
      {pixhawk + pixhawk + pixhawk, "csv", ", but MAVLink of an autopilot: --imu-format mavlink"},
      {heartbeat + raw_imu, "mavlink",
       without + "HIGHRES_IMU of IMU 0 (seen: HEARTBEAT, RAW_IMU): have it "
                 "sent, or --imu-format mavlink-raw"},
      {heartbeat, "mavlink-raw", without + "RAW_IMU of IMU 0 (seen: HEARTBEAT)"},
      {pixhawk + pixhawk + pixhawk, "mavlink",
       without + "HIGHRES_IMU of IMU 0 (seen: none that is read"},
      {frame + frame + frame, "binary", ", but 3 whose checksum is wrong: bytes are missing"},
  };
  for (const auto& [bytes, format, said] : rows) {
    fails(1,
          "live --sensors " + flight_ + " --patience 0 --radar " + file("nothing") + " --imu " +
              dir_->write("imu.bin", bytes).string() + " --imu-format " + format,
          {"no sample of the IMU" + said});
  }
}

TEST_F(LiveCauses, SaysThatTheImuHasStopped) {
  const Outcome stopped = hear({first(4.0, imu()), first(8.0, radar())}, "--sensors " + flight_);
  EXPECT_EQ(stopped.code, 0) << stopped.output;
  const Json json = stopped.json();
  const std::string problem = json["live"]["imu_problem"], verdict = json["verdict"];
  EXPECT_TRUE(problem.starts_with("no sample of the IMU for ")) << problem;
  EXPECT_TRUE(verdict.starts_with("doubtful: ") && verdict.ends_with(problem)) << verdict;
  EXPECT_TRUE(stopped.output.starts_with("no sample of the IMU for ")) << stopped.output;
  const Outcome silent = hear({{}, first(4.0, radar())}, "--sensors " + flight_);
  EXPECT_EQ(silent.code, 1);
  EXPECT_TRUE(silent.output.starts_with("no sample of the IMU: no byte came\n")) << silent.output;
}

/// As of a board that counts from its start: the radar's frame of before has a negative stamp.
TEST_F(LiveCauses, AnImuThatStartsAgainIsNotLost) {
  Line samples = first(8.0, imu());
  for (std::size_t i = samples.size() / 2; i < samples.size(); ++i) {
    ImuSample sample = recorded().imu[i];
    sample.time -= recorded().imu[samples.size() / 2].time;
    const auto frame = live::imu_frame(sample, static_cast<std::uint8_t>(i));
    samples[i].bytes.assign(frame.begin(), frame.end());
  }
  const Outcome run = hear({samples, first(8.0, radar())},
                           "--sensors " + flight_ + " --record " + file("again.mcap"));
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_NEAR(run.json()["duration_s"].get<double>(), 8.0, 0.1);
}

TEST_F(LiveCauses, EachRadarHasItsRate) {
  const fs::path two = copy("two_rates");
  fs::copy(two / "radar0", two / "radar1");
  ASSERT_EQ(run_command("sed -i 's/^rate_hz: 15/rate_hz: 7.5/' " + two.string() + "/radar1/*").code,
            0);
  const std::vector<Line> lines = {first(8.0, imu()), first(8.0, radar()), first(8.0, radar(2))};
  const Json json = hear(lines, "--sensors " + two.string()).json();
  EXPECT_EQ(json["live"]["radars"][1]["problem"], "") << json;
}

/// Samples at rest that the estimator cannot start with.
TEST_F(LiveCauses, SaysWhyItDoesNotStart) {
  const struct {
    const char* values;
    std::int64_t step;  // of the stamps
    const char* said;
  } rows[] = {
      {"0.01,0,0,0,0,1", 5'000'000, "it is in g; --imu must send"},
      {"0.01,0,9.81,0.01,0,0", 5'000'000, "gyro and accelerometer are exchanged; --imu must send"},
      {"10,0,0,0,0,9.81", 5'000'000, "they are in deg/s; --imu must send"},
      {"0.01,0,0,0,0,0.02", 5'000'000, "gravity was removed; --imu must send"},
      {"0.01,0,0,0,0,9.81", 5'000, "the stamps are in us; --imu must send"},
  };
  for (const auto& [values, step, said] : rows) {
    std::string samples;
    for (std::int64_t i = 1; i < 1200; ++i)
      samples += std::to_string(i * step) + "," + values + "\n";
    const Outcome run =
        fails(1,
              "live --sensors " + flight_ + " --patience 0 --radar " + file("nothing") + " --imu " +
                  dir_->write("imu.csv", samples).string() + " --imu-format csv",
              {"IMU: no start yet: ", "rio: ", "no start: ", said});
    expect_none(run.output, {"nan"});
  }
}

TEST_F(LiveCauses, TheViewListensOnItsAddressAlone) {
  const std::string live =
      "live --sensors " + flight_ + " --radar - --imu /dev/null --view 18766 --view-address ";
  const Outcome none = try_rio(live + "192.0.2.1 </dev/null");
  if (contains(none.output, "built without")) GTEST_SKIP() << "skipped: without libwebsockets";
  expect_parts(none.output, {"rio: --view: cannot listen on 192.0.2.1:18766"});
  const Outcome sockets =
      run_command("sleep 2 | " RIO_TOOL " " + live +
                  "127.0.0.1 2>&1 | { grep -m 1 ^view; grep -h :494E /proc/net/tcp*; }");
  expect_parts(sockets.output, {" 0100007F:494E 00000000:0000 "});
  expect_none(sockets.output, {"00000000:494E"});
}

/// But not under nohup.
TEST_F(LiveCauses, EndsCleanlyWhenItsTerminalIsLost) {
  for (const std::string with : {"", "nohup "}) {
    const std::string log = file("log" + with);
    const std::string said =
        run_command(with + RIO_TOOL " live --sensors " + flight_ + " --radar " + file("nothing") +
                    " --imu " + file("no_imu") + " 2>'" + log + "' & until grep -q yet '" + log +
                    "'; do sleep 0.1; done; kill -HUP $!; sleep 0.5; echo later; kill $!; wait $!")
            .output;
    ASSERT_TRUE(contains(said, "verdict: ") && contains(said, "later")) << said;
    EXPECT_EQ(said.find("verdict: ") > said.find("later"), with == "nohup ");
  }
}

TEST_F(LiveCauses, ReplacesNoInput) {
  const std::string radar = dir_->write("r.mcap", "radar"), imu = dir_->write("i.mcap", "imu");
  const std::string live =
      "live --sensors " + flight_ + " --radar " + radar + "@3125000 --imu " + imu;
  for (const char* output : {"out", "states", "json-lines", "mcap", "report", "record"}) {
    for (const std::string& input : {radar, imu}) {
      fails(1, live + " --" + output + " " + input,
            {"rio: " + input + ": would replace an input; nothing was written"});
    }
  }
  EXPECT_EQ(dir_->read("r.mcap") + dir_->read("i.mcap"), "radarimu");
}

TEST_F(LiveCauses, WrongCommandLines) {
  const std::string imu = "live --imu " + file("no_imu") + " --patience 0";
  const std::string both = imu + " --radar " + file("nothing");
  fails(2, imu, {"--radar"});
  fails(1, both, {"frame rate of the radar is not known"});
  const std::string with = " --sensors " + flight_,
                    no_byte = "; no sample of the IMU: no byte came";
  fails(1, imu + with + " --radar " + file("no_imu"), {"no_imu: given for two, IMU and radar 0"});
  fails(1, both + with, {"nothing is not there", "no sample of the IMU"});
  fails(1, both + with, {"rio: radar 0: " + file("nothing") + " is not there" + no_byte});
  fails(1, both + with + " --radar-cfg " RIO_SOURCE_DIR "/data/awr1843boost_odometry.cfg",
        {"note: radar0/sensor.yaml has rate_hz 15, ", "boost_odometry.cfg 20: correct the wrong"});
  fails(1, imu + " --radar /dev/null" + with,
        {"rio: radar 0: /dev/null has ended without a byte" + no_byte});
}

}  // namespace
}  // namespace rio::test
