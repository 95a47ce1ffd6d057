// SPDX-License-Identifier: BSD-3-Clause
// The odometry API: time semantics, bad data, start, reset, repeatability; the same with either
// back-end.
#include "rio/rio.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "api/flying.hpp"

namespace rio::test {
namespace {

using experiment::Step;
using std::chrono::milliseconds;

/// A short flight, and an estimator started at its true first state.
class OdometryTest : public BackEndTest {
 protected:
  static const sim::Flight& flight() {
    static const sim::Flight flight = flight_of(5, 20.0, 12.0);
    return flight;
  }
  static Options options() {
    Options o = options_for(flight());
    o.start.static_alignment = false;
    return o;
  }
  static std::unique_ptr<Odometry> started(const Options& o = options()) {
    auto odometry = experiment::create_odometry(o);
    EXPECT_EQ(odometry->reset(flight().truth.front(), prior()), Status::kOk);
    return odometry;
  }
  static BodyCovariance prior() {
    BodyCovariance P = BodyCovariance::Identity() * 1e-4;
    P.bottomRightCorner<6, 6>() *= 1e-2;
    return P;
  }
  /// Feeds IMU samples with stamps in (newest, until].
  static void feed_imu(Odometry& odometry, Time until, std::size_t* next) {
    for (; *next < flight().imu.size() && flight().imu[*next].time <= until; ++*next) {
      EXPECT_EQ(odometry.add_imu(flight().imu[*next]), Status::kOk);
    }
  }
};

TEST_P(OdometryTest, ScansOutOfOrderAreSortedWhileTheyWait) {
  auto sorted = started();
  auto shuffled = started();
  for (const std::size_t i : {0U, 1U, 2U, 3U}) {
    EXPECT_EQ(sorted->add_scan(flight().scans[i]), Status::kWaiting);
  }
  for (const std::size_t i : {2U, 0U, 3U, 1U}) {
    EXPECT_EQ(shuffled->add_scan(flight().scans[i]), Status::kWaiting);
  }
  std::size_t a = 0;
  std::size_t b = 0;
  feed_imu(*sorted, flight().scans[4].time, &a);
  feed_imu(*shuffled, flight().scans[4].time, &b);
  EXPECT_EQ(shuffled->counters().scans, 4U);
  EXPECT_TRUE(same(sorted->now(), shuffled->now()));
}

TEST_P(OdometryTest, LateDuplicateAndSurplusScansAreDroppedAndCounted) {
  Options o = options();
  o.timing.scan_queue = 2;
  auto odometry = started(o);
  const auto& scans = flight().scans;
  EXPECT_EQ(odometry->add_scan(scans[1]), Status::kWaiting);
  EXPECT_EQ(odometry->add_scan(scans[1]), Status::kDuplicate);
  EXPECT_EQ(odometry->add_scan(scans[2]), Status::kWaiting);
  EXPECT_EQ(odometry->add_scan(scans[3]), Status::kQueueFull);
  std::size_t next = 0;
  feed_imu(*odometry, scans[1].time + milliseconds(10), &next);
  EXPECT_EQ(odometry->add_scan(scans[3]), Status::kWaiting) << "it was not taken";
  feed_imu(*odometry, scans[3].time + milliseconds(10), &next);
  const NavState before = odometry->at_scan();
  // but for the time offset of the radar, of which three scans tell next to nothing
  EXPECT_LT(std::chrono::abs(before.time - scans[3].time), milliseconds(1));
  EXPECT_EQ(odometry->add_scan(scans[3]), Status::kDuplicate);
  EXPECT_EQ(odometry->add_scan(scans[0]), Status::kLate);
  EXPECT_EQ(odometry->add_scan({Time::min(), {}}), Status::kLate);
  EXPECT_EQ(odometry->add_scan({Time::max(), {}}), Status::kAhead);
  EXPECT_TRUE(same(odometry->at_scan(), before));
  const Counters& c = odometry->counters();
  EXPECT_EQ(c.scans, 3U);
  EXPECT_EQ(c.scans_duplicate, 2U);
  EXPECT_EQ(c.scans_overflow, 1U);
  EXPECT_EQ(c.scans_late, 2U);
  EXPECT_EQ(c.scans_ahead, 1U);
}

TEST_P(OdometryTest, WhatIsRefusedChangesNothing) {
  auto odometry = started();
  std::size_t next = 0;
  feed_imu(*odometry, flight().scans[2].time, &next);
  const NavState now = odometry->now();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ImuSample good = flight().imu[next];
  EXPECT_EQ(odometry->add_imu(flight().imu[next - 1]), Status::kStale);  // duplicate
  EXPECT_EQ(odometry->add_imu(flight().imu[0]), Status::kStale);         // out of order
  const auto refused = [&](const auto& change) {
    ImuSample bad = good;
    change(bad);
    return odometry->add_imu(bad);
  };
  EXPECT_EQ(refused([&](ImuSample& s) { s.accel_B.y() = nan; }), Status::kNonFinite);
  EXPECT_EQ(refused([](ImuSample& s) { s.accel_B.setConstant(1e300); }), Status::kImplausible);
  EXPECT_EQ(refused([](ImuSample& s) { s.gyro_B.x() = -1e200; }), Status::kImplausible);
  RadarScan scan = flight().scans[0];
  for (RadarDetection& d : scan.detections) d.range_rate = nan;
  EXPECT_EQ(odometry->add_scan(scan), Status::kNonFinite);
  EXPECT_TRUE(same(odometry->now(), now));
  // one bad detection does not cost the scan
  scan = flight().scans[1];
  scan.detections[0].point_S.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(odometry->add_scan(scan), Status::kOk);
  EXPECT_EQ(odometry->add_imu(good), Status::kOk);
  const Counters& c = odometry->counters();
  EXPECT_EQ(c.imu_stale, 2U);
  EXPECT_EQ(c.imu_non_finite, 1U);
  EXPECT_EQ(c.imu_out_of_range, 2U);
  EXPECT_EQ(c.scans_non_finite, 1U);
  EXPECT_EQ(c.detections_non_finite, flight().scans[0].detections.size() + 1);
}

TEST_P(OdometryTest, SilentRadarKeepsTheEstimateWithinItsLag) {
  auto odometry = started();
  double sigma = 0.0;
  for (const ImuSample& sample : flight().imu) {
    ASSERT_EQ(odometry->add_imu(sample), Status::kOk);
    EXPECT_LE(sample.time - odometry->at_scan().time, milliseconds(1000));
    EXPECT_EQ(odometry->now().time, sample.time);
    const double position_sigma = std::sqrt(odometry->covariance()(5, 5));
    EXPECT_GE(position_sigma, 0.999 * sigma);
    sigma = position_sigma;
  }
  // a scan from before the lag is late, one inside it is taken
  EXPECT_EQ(odometry->add_scan(flight().scans[3]), Status::kLate);
  EXPECT_EQ(odometry->add_scan(flight().scans[flight().scans.size() - 5]), Status::kOk);
}

TEST_P(OdometryTest, ImuGapIsFlaggedAndInflatesTheCovariance) {
  auto whole = started();
  auto gappy = started();
  const Time begin = flight().scans[40].time;
  const Time end = begin + milliseconds(400);
  std::size_t k = 0;
  double whole_sigma = 0.0;
  for (const ImuSample& sample : flight().imu) {
    EXPECT_EQ(whole->add_imu(sample), Status::kOk);
    const bool lost = sample.time > begin && sample.time < end;
    if (!lost) {
      EXPECT_EQ(gappy->add_imu(sample), Status::kOk);
    }
    while (k < flight().scans.size() && flight().scans[k].time <= sample.time) {
      (void)whole->add_scan(flight().scans[k]);
      (void)gappy->add_scan(flight().scans[k]);
      ++k;
    }
    if (!lost && whole_sigma == 0.0 && sample.time >= end) {
      EXPECT_TRUE(gappy->report().imu_gap);
      EXPECT_FALSE(whole->report().imu_gap);
      whole_sigma = std::sqrt(whole->covariance()(0, 0));
      EXPECT_GT(std::sqrt(gappy->covariance()(0, 0)), 3.0 * whole_sigma);
    }
  }
  EXPECT_EQ(gappy->counters().imu_gaps, 1U);
  EXPECT_EQ(whole->counters().imu_gaps, 0U);
}

TEST_P(OdometryTest, StartsByStaticAlignmentAndAgainAfterAReset) {
  Options o = options();
  o.start.static_alignment = true;
  auto odometry = Odometry::create(o);
  for (int start = 0; start < 2; ++start) {  // the second time the old stamps are new again
    EXPECT_FALSE(odometry->initialized());
    EXPECT_TRUE(same(odometry->now(), NavState{})) << "it can be read";
    EXPECT_TRUE(odometry->covariance().isZero(0.0));
    EXPECT_EQ(odometry->add_scan(flight().scans[0]), Status::kNotInitialized);
    EXPECT_EQ(odometry->counters().scans_uninitialized, 1U);
    std::size_t samples = 0;
    while (!odometry->initialized()) {
      ASSERT_EQ(odometry->add_imu(flight().imu.at(samples++)), Status::kOk);
    }
    EXPECT_NEAR(to_seconds(odometry->now().time - flight().imu[0].time), o.start.duration, 0.01);
    const Vector3d up = odometry->now().q_WB * Vector3d::UnitZ();
    EXPECT_LT(std::acos(up.z()), 3.0 * 0.05 / 9.81 * 1.5);  // accelerometer bias over gravity
    odometry->reset();
  }
}

TEST_P(OdometryTest, StaticAlignmentRefusesMotionAndWaits) {
  Options o = options();
  o.start.static_alignment = true;
  auto odometry = Odometry::create(o);
  int refused = 0;
  for (const ImuSample& sample : flight().imu) {
    if (to_seconds(sample.time - flight().imu[0].time) < 5.0) continue;  // it flies by then
    const Status status = odometry->add_imu(sample);
    EXPECT_TRUE(status == Status::kOk || status == Status::kMoving);
    refused += status == Status::kMoving ? 1 : 0;
  }
  EXPECT_FALSE(odometry->initialized());
  EXPECT_GE(refused, 3);
}

TEST_P(OdometryTest, ResetInFlightContinuesFromTheGivenState) {
  auto odometry = started();
  std::size_t next = 0;
  feed_imu(*odometry, flight().imu[1000].time, &next);
  const NavState truth = flight().truth[1000];
  EXPECT_EQ(odometry->reset(truth, prior()), Status::kOk);
  EXPECT_TRUE(same(odometry->now(), odometry->at_scan()));
  EXPECT_EQ(odometry->counters().imu_samples, 0U);
  feed_imu(*odometry, flight().imu[1100].time, &next);
  EXPECT_LT((odometry->now().p_WB - flight().truth[1100].p_WB).norm(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, OdometryTest, kBothBackEnds, back_end_name);

TEST(BackEnds, AgreeWhereNothingIsWrong) {
  const sim::Flight flight = flight_of(11, 20.0, 12.0, [](sim::Scenario& o) {
    o.imu = sim::ImuModel::ideal();
    o.radar = sim::RadarModel::ideal();
  });
  Options options = experiment::options_for(flight, "default");
  const std::vector<Step> ekf = experiment::fly(flight, options).steps;
  options.backend = BackEnd::kSmoother;
  const std::vector<Step> smoother = experiment::fly(flight, options).steps;
  ASSERT_EQ(ekf.size(), smoother.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < ekf.size(); ++i) {
    const double sigma = std::sqrt(ekf[i].covariance.block<3, 3>(3, 3).trace());
    const double apart = (ekf[i].estimate.p_WB - smoother[i].estimate.p_WB).norm();
    largest = std::max(largest, apart / sigma);
  }
  // the same measurements, linearised once or several times: they differ, by less than their sigma
  EXPECT_GT(largest, 0.0);
  EXPECT_LT(largest, 1.0);
}

}  // namespace
}  // namespace rio::test
