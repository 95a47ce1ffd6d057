// SPDX-License-Identifier: BSD-3-Clause
// A session against the estimator fed in the order of the stamps, and against what was sent.
#include "live/session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "live/live_flight.hpp"
#include "live/outputs.hpp"
#include "rio/io/dataset.hpp"
#include "support/measured.hpp"
#include "support/temp_dir.hpp"

namespace rio::live::test {
namespace {

using rio::test::expect_below;
using rio::test::measured;
using rio::test::TempDir;

/// The same data in the order of their stamps, as a replay gives them.
std::map<Time, NavState> replayed(const Options& options, const std::vector<ImuSample>& imu,
                                  const std::vector<RadarScan>& scans) {
  const auto odometry = Odometry::create(options);
  std::map<Time, NavState> states;
  std::size_t next = 0;
  std::uint64_t seen = 0;
  for (const ImuSample& sample : imu) {
    while (next < scans.size() && scans[next].time < sample.time) {
      (void)odometry->add_scan(scans[next++]);
    }
    (void)odometry->add_imu(sample);
    if (odometry->counters().scans == seen) continue;
    seen = odometry->counters().scans;
    states[odometry->report().time] = odometry->at_scan();
  }
  return states;
}

/// Largest distance at the stamps of `a`, all of which must be in `b`.
double worst_distance(const std::map<Time, NavState>& a, const std::map<Time, NavState>& b) {
  double worst = 0.0;
  for (const auto& [time, state] : a) {
    const auto other = b.find(time);
    if (other == b.end()) {
      ADD_FAILURE() << "no estimate at " << time.count();
      return 1e9;
    }
    worst = std::max(worst, (state.p_WB - other->second.p_WB).norm());
  }
  return worst;
}

/// The points of a scan as numbers that were on the wire.
using Points = std::vector<double>;
Points points_of(const RadarScan& scan) {
  Points points;
  for (const RadarDetection& d : scan.detections) {
    const sim::WrittenPoint p = sim::written(d);
    points.insert(points.end(), {p.x, p.y, p.z, p.velocity, static_cast<double>(p.snr)});
  }
  return points;
}
std::multiset<Points> points_of(const std::vector<RadarScan>& scans) {
  std::multiset<Points> all;
  for (const RadarScan& scan : scans) all.insert(points_of(scan));
  return all;
}

double drift(const std::map<Time, NavState>& states) {
  const NavState& end = states.rbegin()->second;
  const NavState& begin = states.begin()->second;
  const Vector3d true_way = flight().truth_at(end.time).p_WB - flight().truth_at(begin.time).p_WB;
  return (end.p_WB - begin.p_WB - true_way).norm() / 25.0;
}

TEST(Session, IsTheReplayOfItsData) {
  Estimates live;
  Session session(setup(), {&live});
  fly({}, &session);
  EXPECT_EQ(live.imu.size(), flight().imu.size());
  EXPECT_EQ(points_of(live.scans), points_of(flight().scans));
  ASSERT_GT(live.states.size(), 200U);
  const double apart = worst_distance(live.states, replayed(options(), live.imu, live.scans));
  measured("live and replay apart, m", apart, "0");
  EXPECT_EQ(apart, 0.0);
  Time off{0};
  for (std::size_t i = 0; i < live.scans.size(); ++i) {
    off = std::max({off, live.scans[i].time - flight().scans[i].time,
                    flight().scans[i].time - live.scans[i].time});
  }
  // 0.5, the delay of the IMU
  expect_below("stamps of the scans off by, ms", 1e3 * to_seconds(off), 0.6);
  EXPECT_EQ(session.times_problem(0), "");
}

TEST(Session, TellsOfEachScanOfTwoRadars) {
  SessionSetup two = setup();
  two.radars.push_back(two.radars.front());
  two.options.other_radars.push_back(two.options.mount(0));
  Estimates live;
  Session session(two, {&live});
  fly({}, &session);
  EXPECT_GT(live.told, 400U);
  EXPECT_EQ(live.told, session.odometry().counters().scans);
}

TEST(Session, GoesOnWithoutAListenerThatThrows) {
  struct Full : Listener {
    void on_estimate(const Session& /*session*/, Time /*arrival*/) override {
      throw std::runtime_error("no space left");
    }
    void on_imu(const Session& /*session*/, const ImuSample& /*sample*/) override { ++samples; }
    void on_end() override { ADD_FAILURE() << "it threw"; }
    std::size_t samples = 0;
  } full;
  struct Closed : Listener {
    void on_end() override { throw std::runtime_error("no folder"); }
  } closed;
  Estimates live;
  Session session(setup(), {&full, &live, &closed});
  fly({}, &session);
  EXPECT_EQ(live.imu.size(), flight().imu.size());
  EXPECT_LT(full.samples, live.imu.size() / 4);
  EXPECT_EQ(session.failed(), "no space left");
  session.end();
  EXPECT_EQ(session.failed(), "no space left; no folder");
}

TEST(Session, SaysWhyTheTimesOfMostFramesAreWrong) {
  SessionSetup wrong = setup();
  wrong.radars[0].period = wrong.radars[0].period * 15 / 16;
  Session session(wrong, {});
  fly({}, &session);
  EXPECT_EQ(session.times_problem(0).rfind("frames come every 66.7 ms by their numbers, not every "
                                           "62.5: correct rate_hz of sensor.yaml",
                                           0),
            0U)
      << session.times_problem(0);
  EXPECT_GT(session.frames(0).untimed, session.frames(0).used);

  const auto said_of = [&](std::uint32_t number_step, std::uint32_t subframes, Time between) {
    Session one(setup(), {});
    one.imu(flight().imu[0], kHostAhead);
    for (std::uint32_t i = 0; i < 100; ++i) {
      sim::WrittenPacket packet = sim::packet_of(i / subframes * number_step, {});
      packet.subframe = i % subframes;
      const Bytes bytes = packet.bytes();
      one.radar(0, bytes.data(), bytes.size(), kHostAhead + i * between);
    }
    return one.times_problem(0);
  };
  const Time period = setup().radars[0].period;
  EXPECT_EQ(said_of(1, 1, period), "");
  EXPECT_NE(said_of(1, 1, Time{1000}).find("a file read at once"), std::string::npos);
  EXPECT_NE(said_of(2, 1, period).find("every 33.3 ms"), std::string::npos);
  EXPECT_NE(said_of(0, 1, period).find("numbers do not count"), std::string::npos);
  EXPECT_NE(said_of(1, 2, period / 2).find("subframes"), std::string::npos);
}

TEST(Session, NothingIsInventedWhereBytesAreLost) {
  for (const CableNoise& noise :
       {CableNoise{.damaged = 0.01, .seed = 3}, CableNoise{.damaged = 0.2, .seed = 4},
        CableNoise{.dropped = 0.1, .damaged = 0.1, .delayed = 0.2, .split = 0.5, .seed = 5}}) {
    Estimates live;
    Session session(setup(), {&live});
    fly(noise, &session);
    const std::multiset<Points> sent = points_of(flight().scans);
    const std::multiset<Points> came = points_of(live.scans);
    EXPECT_LT(came.size(), sent.size());
    EXPECT_TRUE(std::includes(sent.begin(), sent.end(), came.begin(), came.end()));
    ASSERT_FALSE(live.states.empty());
    // drift as with those scans and samples left out: it is the same estimate
    EXPECT_EQ(worst_distance(live.states, replayed(options(), live.imu, live.scans)), 0.0);
    if (noise.damaged > 0.05) continue;
    expect_below("drift with 1 % of the packets damaged, %", 100.0 * drift(live.states), 0.5);
  }
}

/// For a flight that is stopped before its end.
TEST(Session, APieceKnowsWhatWasSentUpToIt) {
  const CableNoise noise{.dropped = 0.1, .damaged = 0.1, .delayed = 0.2, .split = 0.5, .seed = 5};
  const Cable whole = imu_line(flight().imu, Cable(noise));
  const Cable begin = imu_line({flight().imu.begin(), flight().imu.begin() + 500}, Cable(noise));
  const CableCounters& sent = whole.pieces()[begin.pieces().size() - 1].sent;
  EXPECT_LT(begin.counters().packets - sent.packets, 5U);  // dropped after it
  EXPECT_EQ(begin.counters().packets - sent.packets, begin.counters().dropped - sent.dropped);
  EXPECT_EQ(begin.counters().damaged, sent.damaged);
  EXPECT_EQ(begin.counters().delayed, sent.delayed);
  EXPECT_EQ(begin.counters().split, sent.split);
  EXPECT_LT(sent.packets, whole.counters().packets);
}

/// Packets without padding whose last byte may be that of a magic word: the reader waits for the
/// next bytes, the session no longer than for a pause.
TEST(Session, AFrameThatEndsAsAMagicWordBeginsDoesNotWaitForTheNext) {
  std::vector<RadarScan> scans = flight().scans;
  for (RadarScan& scan : scans) {
    scan.detections.resize(10);
    scan.detections.back().noise_db = 60.0;
  }
  Estimates live;
  Session session(setup(), {&live});
  fly({}, &session, scans);
  EXPECT_GE(live.scans.size(), scans.size() - 1);
  expect_below("from the chirps to the scan, worst, ms", 1e3 * to_seconds(live.worst_lag), 30.0);
}

TEST(Session, RecordsWhatReplaysAsItFlew) {
  TempDir dir;
  Estimates live;
  Recorder recorder(dir.path() / "flight", {});
  Session session(setup(), {&live, &recorder});
  fly({.dropped = 0.01, .damaged = 0.01, .delayed = 0.1}, &session);
  session.end();
  const io::Dataset recorded = io::read_dataset(dir.path() / "flight");
  ASSERT_EQ(recorded.imu.size(), live.imu.size());
  ASSERT_EQ(recorded.scans.size(), live.scans.size());
  EXPECT_EQ(worst_distance(live.states, replayed(options(), recorded.imu, recorded.scans)), 0.0);
  EXPECT_ERROR(Recorder(dir.path() / "flight", {}), "is another recording");
}

TEST(Session, KnowsHowLongTheImuIsSilent) {
  Session session(setup(), {});
  fly({}, &session);
  EXPECT_LT(session.imu_silence(), std::chrono::milliseconds(50));
  const Time end = flight().imu.back().time + kHostAhead;
  const Bytes packet = sim::packet_of(1, {}).bytes();
  session.radar(0, packet.data(), packet.size(), end + std::chrono::seconds(8));
  EXPECT_NEAR(to_seconds(session.imu_silence()), 8.0, 0.01);
  session.imu(flight().imu.back(), end + std::chrono::seconds(9));
  EXPECT_LT(session.imu_silence(), Time{0});
}

TEST(Session, WantsATimingForEveryRadar) {
  SessionSetup wrong = setup();
  wrong.radars.push_back(wrong.radars.front());
  EXPECT_ERROR(Session(wrong, {}), "not as many radars");
  wrong.radars = {ti::FrameTiming{}};
  EXPECT_ERROR(Session(wrong, {}), "period");
}

}  // namespace
}  // namespace rio::live::test
