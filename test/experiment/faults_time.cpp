// SPDX-License-Identifier: BSD-3-Clause
// Faults of stamps, order and arrival.
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

/// Rotation of the body in an unnoticed pause of the IMU of some 0.3 s; the Dopplers show it soon.
constexpr double kPause = 2.0;  // [s]

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

Time& stamp_of(Event& e) {
  return e.is_imu() ? e.sample.time : e.scan.time;
}

void shift(Event& e, Time by) {
  stamp_of(e) += by;
}

/// Shifts the stamps of the first `count` events of a kind.
Fault odd_stamps(const char* name, Of of, int count, Time by,
                 Promised promised = Promise::kIgnored) {
  return changing(of, name, 1.0, promised, [count, by](Event& e, Moment& m) {
    if (m.n < count) shift(e, by);
  });
}

/// Moves the first stamps of a kind, `apart` events apart, to both ends of time.
Fault ends_of_time(const char* name, Of of, int apart, Time first, Time second) {
  return changing(of, name, 1.0, Promise::kIgnored, [=](Event& e, Moment& m) {
    if (m.n == 0) stamp_of(e) = first;
    if (m.n == apart) stamp_of(e) = second;
  });
}

/// Shifts all stamps of a kind permanently.
Fault jump(const char* name, Promised promised, Time by, Of of = Of::kBoth) {
  return changing(of, name, kForGood, promised, [by](Event& e, Moment&) { shift(e, by); });
}

Fault start_at_0(const char* name, Of of) {
  return changing(of, name, kForGood, recovered(kPause),
                  [](Event& e, Moment& m) { shift(e, -m.begin); });
}

Fault stamps_with(const char* name, Of of, double jitter) {
  return changing(of, name, 10.0, Promise::kBridged, [jitter](Event& e, Moment& m) {
    shift(e, from_seconds(jitter * m.random.normal()));
  });
}

Fault late(const char* name, Of of, double by, Promised promised) {
  return changing(of, name, 10.0, promised,
                  [by](Event& e, Moment&) { e.arrival += from_seconds(by); });
}

/// All of a kind arrive together at the end of each block.
Fault in_blocks(const char* name, Of of, double block) {
  return changing(of, name, 10.0, Promise::kBridged, [block](Event& e, Moment& m) {
    e.arrival = m.begin + from_seconds(block * (std::floor(m.t / block) + 1.0));
  });
}

/// Every second one arrives after its successor.
Fault swapped(const char* name, Of of) {
  return changing(of, name, 10.0, Promise::kBridged, [](Event& e, Moment& m) {
    if (m.n % 2 == 1) return;
    const sim::Scenario& sensors = m.flight.scenario;
    e.arrival += from_seconds(1.5 / (e.is_imu() ? sensors.imu.rate_hz : sensors.radar.rate_hz));
  });
}

/// Repeats the same event after a while.
Fault repeated(const char* name, Of of, double after) {
  return changing(of, name, 10.0, Promise::kIgnored, [after](Event& e, Moment& m) {
    m.more.push_back(e);
    m.more.back().arrival += from_seconds(after);
  });
}

void add_silences(const char* who, Of of, const std::vector<std::pair<double, Promised>>& all,
                  std::vector<Fault>* faults) {
  for (const auto& [s, promised] : all) {
    const std::string how_long = std::isinf(s) ? "for good" : fmt::format("for {} s", s);
    faults->push_back(changing(of, fmt::format("{} silent {}", who, how_long), s, promised,
                               [](Event& e, Moment&) { e.lost = true; }));
  }
}

}  // namespace

std::vector<Fault> time_faults() {
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kHonest = Promise::kHonest;
  constexpr Promise kReported = Promise::kReported;
  constexpr Of kImu = Of::kImu;
  constexpr Of kScans = Of::kScans;
  const Promised soon = recovered(kPause);
  std::vector<Fault> all = {
      odd_stamps("one IMU stamp +1 h", kImu, 1, hours(1)),
      odd_stamps("one IMU stamp +10 s", kImu, 1, seconds(10)),
      odd_stamps("one IMU stamp -1 h", kImu, 1, -hours(1)),
      odd_stamps("ten IMU stamps +1 h in a row", kImu, 10, hours(1)),
      odd_stamps("nine scan stamps +1 h", kScans, 9, hours(1)),
      odd_stamps("nine scan stamps +0.9 s", kScans, 9, milliseconds(900), kBridged),
      ends_of_time("IMU stamps at both ends of time", kImu, 10, Time::max(), Time::min()),
      ends_of_time("scan stamps at both ends of time", kScans, 1, Time::min(), Time::max()),
      start_at_0("all clocks start again at 0", Of::kBoth),
      jump("all clocks jump by 1 h", soon, hours(1)),
      jump("all clocks go back by 0.3 s", soon, -milliseconds(300)),
      jump("all clocks jump by 2 s", kHonest, seconds(2)),
      jump("the radar's clock late by 0.05 s", kHonest, milliseconds(50), kScans),
      jump("the radar's clock late by 0.2 s", soon, milliseconds(200), kScans),
      jump("the radar's clock early by 0.2 s", soon, -milliseconds(200), kScans),
      jump("the radar's clock late by 0.3 s", soon, milliseconds(300), kScans),
      jump("the radar's clock early by 0.3 s", soon, -milliseconds(300), kScans),
      start_at_0("the radar's clock starts again at 0", kScans),
      stamps_with("IMU stamps jitter by 2 ms for 10 s", kImu, 2e-3),
      stamps_with("scan stamps jitter by 20 ms for 10 s", kScans, 20e-3),
      repeated("IMU samples twice for 10 s", kImu, 0.0),
      repeated("IMU samples again after 0.3 s", kImu, 0.3),
      repeated("scans twice for 10 s", kScans, 0.0),
      repeated("scans again after 0.3 s", kScans, 0.3),
      swapped("IMU samples swapped for 10 s", kImu),
      swapped("scans swapped for 10 s", kScans),
      late("scans 0.1 s late for 10 s", kScans, 0.1, kBridged),
      late("scans 0.9 s late for 10 s", kScans, 0.9, kBridged),
      late("scans 1.5 s late for 10 s", kScans, 1.5, kHonest),
      late("IMU 0.1 s late for 10 s", kImu, 0.1, kBridged),
      // in the end newer samples overtake the late ones, which are lost: a pause of 0.9 s
      late("IMU 0.9 s late for 10 s", kImu, 0.9, recovered(10.0)),
      in_blocks("IMU in blocks of 0.1 s for 10 s", kImu, 0.1),
      in_blocks("IMU in blocks of 0.5 s for 10 s", kImu, 0.5),
      in_blocks("scans in blocks of 0.5 s for 10 s", kScans, 0.5),
      in_blocks("scans in blocks of 2 s for 10 s", kScans, 2.0),
  };
  add_silences("IMU", kImu,
               {{0.01, kBridged},
                {0.03, kBridged},
                {0.1, kBridged},
                {0.3, soon},
                {1.0, recovered(10.0)},
                {2.0, recovered(10.0)},
                {5.0, recovered(10.0)},
                {kForGood, kReported}},
               &all);
  add_silences("radar", kScans,
               {{0.5, kBridged},
                {1.0, kBridged},
                {2.0, kBridged},
                {5.0, kBridged},
                {10.0, kHonest},
                {30.0, kHonest},
                {60.0, kHonest},
                {120.0, kHonest},
                {kForGood, kReported}},
               &all);
  add_silences("IMU and radar", Of::kBoth,
               {{0.3, soon},
                {1.0, recovered(10.0)},
                {5.0, recovered(10.0)},
                {30.0, recovered(10.0)},
                {120.0, recovered(10.0)}},
               &all);
  return all;
}

}  // namespace rio::experiment
