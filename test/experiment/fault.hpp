// SPDX-License-Identifier: BSD-3-Clause
// Faults: possible errors between the sensors and the odometry API, and the promise for each.
//
// A fault changes the events of a flight, IMU samples and scans in the order of arrival, from some
// time on. Or it is in the sensors, or in the configuration of the estimator, from the start; it is
// judged like one that begins later.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "rio/io/start.hpp"
#include "rio/options.hpp"
#include "rio/sim/flight.hpp"
#include "rio/sim/random.hpp"
#include "rio/types.hpp"

namespace rio::experiment {

/// One call of the odometry API.
struct Event {
  enum class Kind : std::uint8_t { kImu, kScan, kReset };

  Time arrival{0};   ///< when it arrives, true time
  Time measured{0};  ///< true time, whatever the stamp says
  Kind kind = Kind::kImu;
  ImuSample sample{};
  RadarScan scan{};
  std::shared_ptr<const Alignment> start{};
  bool lost = false;  ///< never arrives

  bool is_imu() const { return kind == Kind::kImu; }
  bool is_scan() const { return kind == Kind::kScan; }
};
using Stream = std::vector<Event>;

/// Context of a fault when it changes an event.
struct Moment {
  double t = 0.0;       ///< arrival of the event since the fault began [s]
  int n = 0;            ///< events of this kind since then
  Time begin{0};        ///< of the fault, true time
  const Event& before;  ///< the last one of this kind before the fault
  const sim::Flight& flight;
  sim::Random& random;
  Stream& more;  ///< takes further events
};

/// Promised reaction of the estimator. "Wrong" is defined in survival.hpp.
enum class Promise : std::uint8_t {
  kIgnored,    ///< never wrong, nothing reset
  kBridged,    ///< never wrong
  kHonest,     ///< degraded, never beyond 5 sigma; not wrong at the end
  kRecovered,  ///< not wrong later than Fault::within after its end
  kReported,   ///< may be wrong, but reports it within a second
};

/// A promise and its time.
struct Promised {
  Promise promise;
  double within;  ///< of kRecovered, after the end of the fault [s]

  Promised(Promise kept, double seconds = 0.0) : promise(kept), within(seconds) {}  // NOLINT
};
inline Promised recovered(double within) {
  return {Promise::kRecovered, within};
}

inline constexpr double kForGood = std::numeric_limits<double>::infinity();

/// Which events a fault changes.
enum class Of : std::uint8_t { kImu, kScans, kBoth };

using ChangeEvent = std::function<void(Event&, Moment&)>;

struct Fault {
  std::string name;
  Of of = Of::kBoth;
  double duration = 1.0;  ///< events arriving within it are changed; kForGood [s]
  Promised promised = Promise::kBridged;
  ChangeEvent change{};
  std::function<void(sim::Scenario&)> sensors{};  ///< the flight differs from its start on
  std::function<void(Options&)> configure{};      ///< wrong configuration of the estimator

  /// Changes an event of its kind that arrives in time.
  void apply(Event& e, Moment& m) const {
    const bool concerned = of == Of::kBoth || e.is_imu() == (of == Of::kImu);
    if (change && concerned && m.t < duration) change(e, m);
  }
};

/// "recovered within 5 s".
std::string promise_text(const Fault& fault);

/// The catalogue, with unique names. The first entry is no fault.
const std::vector<Fault>& faults();
/// @throws std::runtime_error if there is no such fault
const Fault& fault_named(std::string_view name);

/// The groups of the catalogue.
std::vector<Fault> imu_faults();
std::vector<Fault> radar_faults();
std::vector<Fault> time_faults();
std::vector<Fault> configuration_faults();

/// Both faults; lasts as long as the longer one.
Fault together(const Fault& a, const Fault& b, Promised promised);

/// The events of a flight, by arrival, with a fault from `begin` after its first sample on.
Stream disturbed(const sim::Flight& flight, const Fault& fault, Time begin);

}  // namespace rio::experiment
