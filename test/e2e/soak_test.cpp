// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate --live` and `rio live` against each other at real speed, over noisy cables, for two
// minutes, or RIO_SOAK_SECONDS (test/soak.sh). Judged is what does not hang on what else the
// machine does: bytes, memory, and, unless data came too late, the estimate. Times are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <future>

#include "e2e/tool.hpp"
#include "rio/io/dataset.hpp"
#include "rio/testing/allocation_guard.hpp"
#include "support/matches.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;

double seconds_to_run() {
  const char* given = std::getenv("RIO_SOAK_SECONDS");
  return given == nullptr ? 120.0 : std::max(20.0, std::atof(given));
}

/// Resident memory of a process [MB]; 0 if it is over.
double resident(const std::string& pid) {
  std::ifstream status("/proc/" + pid + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::atof(line.c_str() + 6) / 1024.0;
  }
  return 0.0;
}

/// What the simulation says of a cable: how many packets it took, and left whole.
struct Sent {
  std::uint64_t packets = 0, whole = 0;
};
Sent sent_by(const std::string& output, const std::string& sensor) {
  const auto number_of = [&](const std::string& what) {
    const auto found = matches(output, "/" + sensor + "/port: .*?([0-9]+) " + what);
    return found.size() == 1 ? std::stoull(found[0]) : 0;
  };
  const std::uint64_t packets = number_of("packets");
  return {packets, packets - number_of("dropped") - number_of("damaged")};
}

struct Soak : testing::Test {
  TempDir dir;
  std::string out = (dir.path() / "flight").string();
  std::string recorded = (dir.path() / "recorded").string();
  std::string tum = (dir.path() / "live.tum").string();

  /// The output of the simulation and the summary of `rio live`; its memory, once a second.
  std::pair<Outcome, Outcome> fly(double seconds, std::vector<double>* memory) const {
    dir.write("soak.yaml",
              "seed: 9\npath: {length: 0, duration: " + std::to_string(seconds) + " s}\n");
    auto player = std::async(std::launch::async, [&] {
      return try_rio("simulate " + out + " --scenario " + (dir.path() / "soak.yaml").string() +
                     " --live --dropped 0.005 --damaged 0.01 --delayed 0.02 --split 0.2");
    });
    while (!fs::exists(out + "/radar0/port") &&
           player.wait_for(milliseconds(50)) != std::future_status::ready) {
    }
    const std::string pid_file = (dir.path() / "pid").string();
    auto run = std::async(std::launch::async, [&] {
      return run_command("echo $$ >" + pid_file + "; exec " RIO_TOOL " live --sensors " + out +
                         " --radar " + out + "/radar0/port --imu " + out +
                         "/imu0/port --patience 0 --json --record " + recorded + " --out " + tum +
                         " 2>/dev/null");
    });
    while (run.wait_for(std::chrono::seconds(1)) != std::future_status::ready) {
      if (const auto lines = lines_of(pid_file); !lines.empty()) {
        memory->push_back(resident(lines.front()));
        if (memory->back() == 0.0) memory->pop_back();
      }
    }
    return {player.get(), run.get()};
  }
};

void measure_times(const Json& live) {
  measured("last byte to estimate, median, ms", live["latency_median_ms"], "1");
  measured("last byte to estimate, p99, ms", live["latency_p99_ms"],
           "late bytes of the IMU are waited for");
  measured("CPU, share of a core", live["cpu_share"], "0.03");
}

/// The points of the scans as they were on the wire, sorted.
std::vector<std::vector<std::array<float, 4>>> wire_points(const io::Dataset& dataset) {
  std::vector<std::vector<std::array<float, 4>>> scans;
  for (const RadarScan& scan : dataset.scans) {
    auto& points = scans.emplace_back();
    for (const RadarDetection& d : scan.detections) {
      const Eigen::Vector3f p = d.point_S.cast<float>();
      points.push_back({p.x(), p.y(), p.z(), static_cast<float>(d.range_rate)});
    }
  }
  std::sort(scans.begin(), scans.end());
  return scans;
}

/// Each frame that was sent whole came, and nothing else.
void judge_bytes(const Json& live, const std::string& player, const io::Dataset& flown,
                 const io::Dataset& recorded) {
  const Sent scans = sent_by(player, "radar0");
  const Sent samples = sent_by(player, "imu0");
  ASSERT_EQ(scans.packets, flown.scans.size());
  ASSERT_EQ(samples.packets, flown.imu.size());
  const std::uint64_t frames = live["packets"];
  const std::uint64_t untimed = live["packets_untimed"];
  const std::uint64_t made_up = live["packets_made_up"];
  measured("frames sent whole", static_cast<double>(scans.whole), "");
  measured("frames handed out", static_cast<double>(frames), "as many");
  measured("frames of unknown time", static_cast<double>(untimed), "0 without other load");
  measured("IMU samples sent whole", static_cast<double>(samples.whole), "");
  EXPECT_GE(frames, scans.whole);
  EXPECT_LE(frames, scans.whole + made_up);  // two neighbours damaged: told by the time
  measured("frames left out by their arrival", static_cast<double>(made_up), "");
  EXPECT_EQ(live["imu_samples"], samples.whole);
  EXPECT_EQ(recorded.imu.size(), samples.whole);
  EXPECT_LE(recorded.scans.size(), scans.whole);
  // left out, and counted, where the machine stood still; and one before the first sample
  EXPECT_GE(recorded.scans.size() + untimed + made_up + 1, scans.whole);
  const auto sent = wire_points(flown);
  const auto came = wire_points(recorded);
  EXPECT_TRUE(std::includes(sent.begin(), sent.end(), came.begin(), came.end()));
}

/// Resident memory once a second.
void judge_memory(const std::vector<double>& memory) {
  constexpr double kMost = 2.0;  // [MB]: times of the scans, for the median at the end
  ASSERT_GT(memory.size(), 10U);
  const auto quarter = memory.begin() + static_cast<std::ptrdiff_t>(memory.size() / 4);
  const double most = *std::max_element(quarter, memory.end());
  const double grown = most - *std::max_element(memory.begin(), quarter);
  measured("memory, most, MB", most, "");
  measured("memory grown after the first quarter, MB", grown, "below 2");
  if (AllocationGuard::kWorks) {  // no sanitizer
    EXPECT_LT(grown, kMost);
  }
}

TEST_F(Soak, NothingIsLostOrGrows) {
  std::vector<double> memory;
  const auto [player, run] = fly(seconds_to_run(), &memory);
  ASSERT_EQ(player.code, 0) << player.output;
  const Json json = run.json();
  measure_times(json["live"]);
  const io::Dataset flown = io::read_dataset(out);
  judge_bytes(json["live"], player.output, flown, io::read_dataset(recorded));
  judge_memory(memory);

  const Json error = rio("evaluate " + out + " " + tum + " --json").json();
  const double off = error["final_drift_percent"];
  measured("length of the flight, m", error["path_length_m"], "");
  const Json& counters = json["counters"];
  const Json& seconds = json["health"]["seconds"];
  const double well = seconds["ok"].get<double>() + seconds["degraded"].get<double>();
  const double ill = seconds["dead reckoning"].get<double>() + seconds["lost"].get<double>();
  measured("drift at the end, % of it", off, "below 0.5");
  measured("dead reckoning or lost, s", ill, "0");
  measured("degraded, s", seconds["degraded"], "");
  measured("scans too late", counters["scans_late"], "0 without other load");
  if (counters["scans_late"] > 1 || counters["scans_overflow"] > 0 ||
      json["live"]["packets_untimed"] > 1) {
    GTEST_SKIP() << "bytes and memory are as they must be; the machine stood still, so that the "
                    "estimate is not judged: "
                 << counters;
  }
  EXPECT_EQ(run.code, 0) << run.output;
  EXPECT_LT(off, 0.5);
  EXPECT_LT(ill, 0.01 * well);
}

}  // namespace
}  // namespace rio::test
