// SPDX-License-Identifier: BSD-3-Clause
// Faults of stamps, order and arrival.
#include <cmath>
#include <vector>

#include "experiment/fault.hpp"

namespace rio::experiment {

namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

void shift(Event& e, Time by) {
  (e.is_imu() ? e.sample.time : e.scan.time) += by;
}

ChangeEvent shifted(Time by) {
  return [by](Event& e, Moment&) { shift(e, by); };
}

/// The stamps of the first events of a kind.
ChangeEvent first(int count, Time by) {
  return [count, by](Event& e, Moment& m) {
    if (m.n < count) shift(e, by);
  };
}

/// The first stamps of a kind, `apart` events apart.
ChangeEvent two_set(int apart, Time first, Time second) {
  return [=](Event& e, Moment& m) {
    Time& stamp = e.is_imu() ? e.sample.time : e.scan.time;
    if (m.n == 0) stamp = first;
    if (m.n == apart) stamp = second;
  };
}

void start_at_0(Event& e, Moment& m) {
  shift(e, -m.begin);
}

ChangeEvent jittering(double sigma) {
  return [sigma](Event& e, Moment& m) { shift(e, from_seconds(sigma * m.random.normal())); };
}

ChangeEvent late(double by) {
  return [by](Event& e, Moment&) { e.arrival += from_seconds(by); };
}

/// All of a kind arrive together at the end of each block.
ChangeEvent in_blocks(double block) {
  return [block](Event& e, Moment& m) {
    e.arrival = m.begin + from_seconds(block * (std::floor(m.t / block) + 1.0));
  };
}

/// Every second one arrives after its successor.
void swap(Event& e, Moment& m) {
  if (m.n % 2 == 1) return;
  const sim::Scenario& sensors = m.flight.scenario;
  e.arrival += from_seconds(1.5 / (e.is_imu() ? sensors.imu.rate_hz : sensors.radar.rate_hz));
}

/// The same event once more.
ChangeEvent again(double after) {
  return [after](Event& e, Moment& m) {
    m.more.push_back(e);
    m.more.back().arrival += from_seconds(after);
  };
}

void lose(Event& e, Moment&) {
  e.lost = true;
}

}  // namespace

std::vector<Fault> time_faults() {
  constexpr Promise kIgnored = Promise::kIgnored;
  constexpr Promise kBridged = Promise::kBridged;
  constexpr Promise kHonest = Promise::kHonest;
  constexpr Promise kReported = Promise::kReported;
  constexpr Of kImu = Of::kImu;
  constexpr Of kScans = Of::kScans;
  constexpr Of kBoth = Of::kBoth;
  // after a rotation in an unnoticed pause of the IMU of some 0.3 s the Dopplers show it soon
  const Promised soon = recovered(2.0);
  const Promised in_the_end = recovered(10.0);
  return {
      {"one IMU stamp +1 h", kImu, 1.0, kIgnored, first(1, hours(1))},
      {"one IMU stamp +10 s", kImu, 1.0, kIgnored, first(1, seconds(10))},
      {"one IMU stamp -1 h", kImu, 1.0, kIgnored, first(1, -hours(1))},
      {"ten IMU stamps +1 h in a row", kImu, 1.0, kIgnored, first(10, hours(1))},
      {"nine scan stamps +1 h", kScans, 1.0, kIgnored, first(9, hours(1))},
      {"nine scan stamps +0.9 s", kScans, 1.0, kBridged, first(9, milliseconds(900))},
      {"IMU stamps at both ends of time", kImu, 1.0, kIgnored,
       two_set(10, Time::max(), Time::min())},
      {"scan stamps at both ends of time", kScans, 1.0, kIgnored,
       two_set(1, Time::min(), Time::max())},
      {"all clocks start again at 0", kBoth, kForGood, soon, start_at_0},
      {"all clocks jump by 1 h", kBoth, kForGood, soon, shifted(hours(1))},
      {"all clocks go back by 0.3 s", kBoth, kForGood, soon, shifted(-milliseconds(300))},
      {"all clocks jump by 2 s", kBoth, kForGood, kHonest, shifted(seconds(2))},
      {"the radar's clock late by 0.05 s", kScans, kForGood, kHonest, shifted(milliseconds(50))},
      {"the radar's clock late by 0.2 s", kScans, kForGood, soon, shifted(milliseconds(200))},
      {"the radar's clock early by 0.2 s", kScans, kForGood, soon, shifted(-milliseconds(200))},
      {"the radar's clock late by 0.3 s", kScans, kForGood, soon, shifted(milliseconds(300))},
      {"the radar's clock early by 0.3 s", kScans, kForGood, soon, shifted(-milliseconds(300))},
      {"the radar's clock starts again at 0", kScans, kForGood, soon, start_at_0},
      {"the IMU's clock jumps by 2 s", kImu, kForGood, in_the_end, shifted(seconds(2))},
      {"the IMU's clock goes back by 2 s", kImu, kForGood, in_the_end, shifted(-seconds(2))},
      {"the IMU's clock starts again at 0", kImu, kForGood, in_the_end, start_at_0},
      {"IMU stamps jitter by 2 ms for 10 s", kImu, 10.0, kBridged, jittering(2e-3)},
      {"scan stamps jitter by 20 ms for 10 s", kScans, 10.0, kBridged, jittering(20e-3)},
      {"IMU samples twice for 10 s", kImu, 10.0, kIgnored, again(0.0)},
      {"IMU samples again after 0.3 s", kImu, 10.0, kIgnored, again(0.3)},
      {"scans twice for 10 s", kScans, 10.0, kIgnored, again(0.0)},
      {"scans again after 0.3 s", kScans, 10.0, kIgnored, again(0.3)},
      {"IMU samples swapped for 10 s", kImu, 10.0, kBridged, swap},
      {"scans swapped for 10 s", kScans, 10.0, kBridged, swap},
      {"scans 0.1 s late for 10 s", kScans, 10.0, kBridged, late(0.1)},
      {"scans 0.9 s late for 10 s", kScans, 10.0, kBridged, late(0.9)},
      {"scans 1.5 s late for 10 s", kScans, 10.0, kHonest, late(1.5)},
      {"IMU 0.1 s late for 10 s", kImu, 10.0, kBridged, late(0.1)},
      // in the end newer samples overtake the late ones, which are lost: a pause of 0.9 s
      {"IMU 0.9 s late for 10 s", kImu, 10.0, in_the_end, late(0.9)},
      {"IMU in blocks of 0.1 s for 10 s", kImu, 10.0, kBridged, in_blocks(0.1)},
      {"IMU in blocks of 0.5 s for 10 s", kImu, 10.0, kBridged, in_blocks(0.5)},
      {"scans in blocks of 0.5 s for 10 s", kScans, 10.0, kBridged, in_blocks(0.5)},
      {"scans in blocks of 2 s for 10 s", kScans, 10.0, kBridged, in_blocks(2.0)},
      {"IMU silent for 0.01 s", kImu, 0.01, kBridged, lose},
      {"IMU silent for 0.03 s", kImu, 0.03, kBridged, lose},
      {"IMU silent for 0.1 s", kImu, 0.1, kBridged, lose},
      {"IMU silent for 0.3 s", kImu, 0.3, soon, lose},
      {"IMU silent for 1 s", kImu, 1.0, in_the_end, lose},
      {"IMU silent for 2 s", kImu, 2.0, in_the_end, lose},
      {"IMU silent for 5 s", kImu, 5.0, in_the_end, lose},
      {"IMU silent for good", kImu, kForGood, kReported, lose},
      {"radar silent for 0.5 s", kScans, 0.5, kBridged, lose},
      {"radar silent for 1 s", kScans, 1.0, kBridged, lose},
      {"radar silent for 2 s", kScans, 2.0, kBridged, lose},
      {"radar silent for 5 s", kScans, 5.0, kBridged, lose},
      {"radar silent for 10 s", kScans, 10.0, kHonest, lose},
      {"radar silent for 30 s", kScans, 30.0, kHonest, lose},
      {"radar silent for 60 s", kScans, 60.0, kHonest, lose},
      {"radar silent for 120 s", kScans, 120.0, kHonest, lose},
      {"radar silent for good", kScans, kForGood, kReported, lose},
      {"IMU and radar silent for 0.3 s", kBoth, 0.3, soon, lose},
      {"IMU and radar silent for 1 s", kBoth, 1.0, in_the_end, lose},
      {"IMU and radar silent for 5 s", kBoth, 5.0, in_the_end, lose},
      {"IMU and radar silent for 30 s", kBoth, 30.0, in_the_end, lose},
      {"IMU and radar silent for 120 s", kBoth, 120.0, in_the_end, lose},
  };
}

}  // namespace rio::experiment
