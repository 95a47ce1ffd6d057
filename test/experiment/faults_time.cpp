// SPDX-License-Identifier: BSD-3-Clause
// Faults of stamps, order and arrival.
#include <fmt/format.h>

#include <cmath>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

/// Rotation of the body in an unnoticed pause of the IMU of some 0.3 s; the Dopplers show it soon.
constexpr double kPause = 2.0;  // [s]

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

void shift(Event& e, Time by) {
  (e.is_imu() ? e.sample.time : e.scan.time) += by;
}

/// Shifts the stamps of the first `count` events of a kind.
Fault odd_stamps(const char* name, bool imu, int count, Time by,
                 Promise promise = Promise::kIgnored) {
  return {.name = name, .promise = promise, .change = [imu, count, by](Event& e, Moment& m) {
            if (e.is_imu() == imu && m.n < count) shift(e, by);
          }};
}

/// Shifts the stamps of all, or of the scans alone, permanently.
Fault jump(const char* name, Promise promise, Time by, bool scans_only = false) {
  return {.name = name,
          .promise = promise,
          .within = kPause,
          .duration = kForGood,
          .change = [by, scans_only](Event& e, Moment&) {
            if (e.is_scan() || !scans_only) shift(e, by);
          }};
}

Fault stamps_with(const char* name, bool imu, double jitter, Promise promise) {
  return {.name = name,
          .promise = promise,
          .duration = 10.0,
          .change = [imu, jitter](Event& e, Moment& m) {
            if (e.is_imu() == imu) shift(e, from_seconds(jitter * m.random.normal()));
          }};
}

Fault late(const char* name, bool imu, double by, Promise promise, double within = 0.0) {
  return {.name = name,
          .promise = promise,
          .within = within,
          .duration = 10.0,
          .change = [imu, by](Event& e, Moment&) {
            if (e.is_imu() == imu) e.arrival += from_seconds(by);
          }};
}

/// All of a kind arrive together at the end of each block.
Fault in_blocks(const char* name, bool imu, double block, Promise promise) {
  return {.name = name,
          .promise = promise,
          .duration = 10.0,
          .change = [imu, block](Event& e, Moment& m) {
            if (e.is_imu() != imu) return;
            e.arrival = m.begin + from_seconds(block * (std::floor(m.t / block) + 1.0));
          }};
}

/// Every second one arrives after its successor.
Fault swapped(const char* name, bool imu) {
  return {.name = name, .duration = 10.0, .change = [imu](Event& e, Moment& m) {
            if (e.is_imu() != imu || m.n % 2 == 1) return;
            const double rate =
                imu ? m.flight.scenario.imu.rate_hz : m.flight.scenario.radar.rate_hz;
            e.arrival += from_seconds(1.5 / rate);
          }};
}

/// Repeats the same event after a while.
Fault repeated(const char* name, bool imu, double after) {
  return {.name = name,
          .promise = Promise::kIgnored,
          .duration = 10.0,
          .change = [imu, after](Event& e, Moment& m) {
            if (e.is_imu() != imu) return;
            m.more.push_back(e);
            m.more.back().arrival += from_seconds(after);
          }};
}

enum class Silent : std::uint8_t { kImu, kRadar, kBoth };

Fault silence(Silent who, double duration, Promise promise, double within = 0.0) {
  constexpr const char* kWho[] = {"IMU", "radar", "IMU and radar"};
  const std::string how_long =
      std::isinf(duration) ? "for good" : fmt::format("for {} s", duration);
  return {.name = fmt::format("{} silent {}", kWho[static_cast<int>(who)], how_long),
          .promise = promise,
          .within = within,
          .duration = duration,
          .change = [who](Event& e, Moment&) {
            e.lost = e.lost || who == Silent::kBoth || e.is_imu() == (who == Silent::kImu);
          }};
}

std::vector<Fault> silences() {
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kHonest = Promise::kHonest;
  constexpr Promise kRecovered = Promise::kRecovered;
  std::vector<Fault> all;
  for (const double s : {0.01, 0.03, 0.1}) all.push_back(silence(Silent::kImu, s, kBridged));
  all.push_back(silence(Silent::kImu, 0.3, kRecovered, kPause));
  for (const double s : {1.0, 2.0, 5.0}) all.push_back(silence(Silent::kImu, s, kRecovered, 10.0));
  all.push_back(silence(Silent::kImu, kForGood, Promise::kReported));
  for (const double s : {0.5, 1.0, 2.0, 5.0}) {
    all.push_back(silence(Silent::kRadar, s, kBridged));
  }
  for (const double s : {10.0, 30.0, 60.0, 120.0}) {
    all.push_back(silence(Silent::kRadar, s, kHonest));
  }
  all.push_back(silence(Silent::kRadar, kForGood, Promise::kReported));
  all.push_back(silence(Silent::kBoth, 0.3, kRecovered, kPause));
  for (const double s : {1.0, 5.0, 30.0, 120.0}) {
    all.push_back(silence(Silent::kBoth, s, kRecovered, 10.0));
  }
  return all;
}

}  // namespace

std::vector<Fault> time_faults() {
  std::vector<Fault> all = {
      odd_stamps("one IMU stamp +1 h", true, 1, hours(1)),
      odd_stamps("one IMU stamp +10 s", true, 1, seconds(10)),
      odd_stamps("one IMU stamp -1 h", true, 1, -hours(1)),
      odd_stamps("ten IMU stamps +1 h in a row", true, 10, hours(1)),
      odd_stamps("nine scan stamps +1 h", false, 9, hours(1)),
      odd_stamps("nine scan stamps +0.9 s", false, 9, milliseconds(900), Promise::kBridged),
      {.name = "IMU stamps at both ends of time",
       .promise = Promise::kIgnored,
       .change =
           [](Event& e, Moment& m) {
             if (e.is_imu() && m.n == 0) e.sample.time = Time::max();
             if (e.is_imu() && m.n == 10) e.sample.time = Time::min();
           }},
      {.name = "scan stamps at both ends of time",
       .promise = Promise::kIgnored,
       .change =
           [](Event& e, Moment& m) {
             if (e.is_scan() && m.n == 0) e.scan.time = Time::min();
             if (e.is_scan() && m.n == 1) e.scan.time = Time::max();
           }},
      {.name = "all clocks start again at 0",
       .promise = Promise::kRecovered,
       .within = kPause,
       .duration = kForGood,
       .change = [](Event& e, Moment& m) { shift(e, -m.begin); }},
      jump("all clocks jump by 1 h", Promise::kRecovered, hours(1)),
      jump("all clocks go back by 0.3 s", Promise::kRecovered, -milliseconds(300)),
      jump("all clocks jump by 2 s", Promise::kHonest, seconds(2)),
      jump("the radar's clock late by 0.05 s", Promise::kHonest, milliseconds(50), true),
      jump("the radar's clock late by 0.2 s", Promise::kRecovered, milliseconds(200), true),
      jump("the radar's clock early by 0.2 s", Promise::kRecovered, -milliseconds(200), true),
      jump("the radar's clock late by 0.3 s", Promise::kRecovered, milliseconds(300), true),
      jump("the radar's clock early by 0.3 s", Promise::kRecovered, -milliseconds(300), true),
      {.name = "the radar's clock starts again at 0",
       .promise = Promise::kRecovered,
       .within = kPause,
       .duration = kForGood,
       .change =
           [](Event& e, Moment& m) {
             if (e.is_scan()) shift(e, -m.begin);
           }},
      stamps_with("IMU stamps jitter by 2 ms for 10 s", true, 2e-3, Promise::kBridged),
      stamps_with("scan stamps jitter by 20 ms for 10 s", false, 20e-3, Promise::kBridged),
      repeated("IMU samples twice for 10 s", true, 0.0),
      repeated("IMU samples again after 0.3 s", true, 0.3),
      repeated("scans twice for 10 s", false, 0.0),
      repeated("scans again after 0.3 s", false, 0.3),
      swapped("IMU samples swapped for 10 s", true),
      swapped("scans swapped for 10 s", false),
      late("scans 0.1 s late for 10 s", false, 0.1, Promise::kBridged),
      late("scans 0.9 s late for 10 s", false, 0.9, Promise::kBridged),
      late("scans 1.5 s late for 10 s", false, 1.5, Promise::kHonest),
      late("IMU 0.1 s late for 10 s", true, 0.1, Promise::kBridged),
      // in the end newer samples overtake the late ones, which are lost: a pause of 0.9 s
      late("IMU 0.9 s late for 10 s", true, 0.9, Promise::kRecovered, 10.0),
      in_blocks("IMU in blocks of 0.1 s for 10 s", true, 0.1, Promise::kBridged),
      in_blocks("IMU in blocks of 0.5 s for 10 s", true, 0.5, Promise::kBridged),
      in_blocks("scans in blocks of 0.5 s for 10 s", false, 0.5, Promise::kBridged),
      in_blocks("scans in blocks of 2 s for 10 s", false, 2.0, Promise::kBridged),
  };
  for (Fault& fault : silences()) all.push_back(std::move(fault));
  return all;
}

}  // namespace rio::experiment
