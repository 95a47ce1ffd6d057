// SPDX-License-Identifier: BSD-3-Clause
// Flights through the odometry API, with either back-end.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "experiment/trial.hpp"
#include "rio/core/so3.hpp"
#include "rio/testing/allocation_guard.hpp"
#include "support/short_flight.hpp"

namespace rio::test {

/// The default scenario but for what `change` does.
inline sim::Flight flight_of(std::uint64_t seed, double length, double seconds,
                             const std::function<void(sim::Scenario&)>& change = {}) {
  sim::Scenario scenario{.seed = seed, .path = {.length = length}, .max_duration = seconds};
  if (change) change(scenario);
  return sim::simulate_flight(scenario);
}

/// Errors of the estimate at the scans of a flight.
struct Errors {
  /// False if no scan has been processed since the last call.
  bool add(const Odometry& odometry, const sim::Flight& flight) {
    if (odometry.counters().scans == scans) return false;
    scans = odometry.counters().scans;
    const NavState& x = odometry.at_scan();
    const NavState truth = flight.truth_at(x.time);
    Eigen::Matrix<double, 6, 1> e;
    e << quaternion_log(x.q_WB.conjugate() * truth.q_WB), truth.p_WB - x.p_WB;
    const Eigen::Matrix<double, 6, 6> P = odometry.covariance().topLeftCorner<6, 6>();
    const Vector3d position = e.tail<3>();
    square += position.squaredNorm();
    height_square += position.z() * position.z();
    pose_nees += e.dot(P.inverse() * e) / 6.0;
    position_nees += position.dot(P.bottomRightCorner<3, 3>().inverse() * position) / 3.0;
    last = position.norm();
    ++steps;
    return true;
  }
  double rms() const { return std::sqrt(square / steps); }                ///< of the position [m]
  double rms_height() const { return std::sqrt(height_square / steps); }  ///< [m]

  double square = 0.0;         ///< of the position, summed [m^2]
  double height_square = 0.0;  ///< same
  double pose_nees = 0.0;      ///< summed, divided by its dimension
  double position_nees = 0.0;  ///< same
  double last = 0.0;           ///< of the position [m]
  int steps = 0;
  std::uint64_t scans = 0;
};

/// Equal to the bit.
inline bool same(const NavState& a, const NavState& b) {
  return a.time == b.time && a.p_WB == b.p_WB && a.v_WB == b.v_WB &&
         a.q_WB.coeffs() == b.q_WB.coeffs() && a.gyro_bias == b.gyro_bias &&
         a.accel_bias == b.accel_bias;
}

class BackEndTest : public testing::TestWithParam<BackEnd> {
 protected:
  /// The default preset with the sensors of a flight.
  static Options options_for(const sim::Flight& flight) {
    Options o = experiment::options_for(flight, "default");
    o.backend = GetParam();
    return o;
  }
  /// As the tables of what was measured call it.
  static std::string name() { return GetParam() == BackEnd::kEkf ? "filter" : "window"; }
};

/// The first seconds of the scenario indoor-1.
template <int kSeconds>
class IndoorTest : public BackEndTest {
 protected:
  static const sim::Flight& flight() {
    static const sim::Flight flight = short_flight("indoor-1", kSeconds);
    return flight;
  }
  static Options options() { return options_for(flight()); }
  static Time start() { return flight().imu.front().time; }
};

inline const auto kBothBackEnds = testing::Values(BackEnd::kEkf, BackEnd::kSmoother);

inline std::string back_end_name(const testing::TestParamInfo<BackEnd>& info) {
  return info.param == BackEnd::kEkf ? "Ekf" : "Smoother";
}

/// A flight to a new estimator, which does not touch the heap; some scans are ahead of the IMU.
/// @param all the flight as each radar sees it, scans of the same stamps
/// @param start if none, it aligns itself
/// @param each called with the time of the newest sample after the scans of a stamp
inline std::unique_ptr<Odometry> fly_without_heap(
    const std::vector<sim::Flight>& all, const Options& options, const NavState* start,
    const std::function<void(Odometry&, Time)>& each = [](Odometry&, Time) {}) {
  const std::vector<RadarScan>& scans = all.front().scans;
  auto odometry = experiment::create_odometry(options);
  std::size_t next = 0;
  const AllocationGuard guard;
  if (start != nullptr) {
    EXPECT_EQ(odometry->reset(*start, 1e-4 * BodyCovariance::Identity()), Status::kOk);
  }
  for (const ImuSample& sample : all.front().imu) {
    if (next % 50 == 49 && next < scans.size()) (void)odometry->add_scan(scans[next]);
    (void)odometry->add_imu(sample);
    (void)odometry->covariance_now();
    for (; next < scans.size() && scans[next].time <= sample.time; ++next) {
      for (std::size_t r = 0; r < all.size(); ++r) (void)odometry->add_scan(all[r].scans[next], r);
      each(*odometry, sample.time);
    }
  }
  EXPECT_EQ(guard.count(), 0);
  return odometry;
}

}  // namespace rio::test
