// SPDX-License-Identifier: BSD-3-Clause
// Flights with other sensors beside the radar, with either back-end.
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "api/flying.hpp"
#include "rio/aiding.hpp"
#include "rio/sim/random.hpp"
#include "support/measured.hpp"

namespace rio::test {

using namespace std::chrono_literals;

/// What the aids of one instant add, if any.
using Aids = std::function<void(Odometry&, const NavState& truth, sim::Random&)>;

inline const Aids kNone = [](Odometry&, const NavState&, sim::Random&) {};

class AidedTest : public BackEndTest {
 protected:
  /// A sparse radar, so that there is something to gain.
  static const sim::Flight& flight() {
    static const sim::Flight flight = flight_of(8, 80.0, 60.0, [](sim::Scenario& o) {
      o.radar.max_static = 6;
      o.radar.threshold_db = 13.0;
    });
    return flight;
  }
  static Time start() { return flight().imu.front().time; }
  static Options options() { return options_for(flight()); }
  /// Flies with the aids every `period` from `late` after they were measured.
  Errors fly(const Options& options, const Aids& aids, Time period = 40ms, Time delay = Time{0},
             std::pair<double, double> blind = {1e9, 1e9}) {
    odometry = Odometry::create(options);
    sim::Random random(4);
    Errors e;
    std::size_t scan = 0;
    Time next = start() + period / 2;
    nis = rows = 0.0;
    gated = 0;
    for (const ImuSample& sample : flight().imu) {
      EXPECT_EQ(odometry->add_imu(sample), Status::kOk);
      for (; next + delay <= sample.time; next += period) {
        if (odometry->initialized()) aids(*odometry, flight().truth_at(next), random);
      }
      for (; scan < flight().scans.size() && flight().arrivals[scan] <= sample.time; ++scan) {
        const double t = to_seconds(flight().scans[scan].time - start());
        if (t >= blind.first && t <= blind.second) continue;
        (void)odometry->add_scan(flight().scans[scan]);
      }
      if (!e.add(*odometry, flight())) continue;
      for (const InnovationRecord& record : odometry->report().records) {
        if (record.model != Model::kAiding) continue;
        const bool used = record.result == GateResult::kUsed;
        gated += used ? 0 : 1;
        nis += used ? record.nis : 0.0;
        rows += used ? record.dof : 0.0;
      }
    }
    return e;
  }
  /// Measurements are as uncertain as they say.
  void expect_consistent() const {
    expect_near(name() + ": NIS a row of the aids", nis / rows, 1.0, 0.2);
  }
  std::unique_ptr<Odometry> odometry;
  double nis = 0.0;   ///< of the aids used, summed
  double rows = 0.0;  ///< of them
  int gated = 0;
};

}  // namespace rio::test
