// SPDX-License-Identifier: BSD-3-Clause
// The odometry API: the covariance of now, and the health of a flight that is well and of one that
// is not.
#include "api/flying.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class HealthTest : public IndoorTest<25> {
 protected:
  /// Which data arrive; `t` since the first sample.
  struct Keep {
    bool (*imu)(Time t) = [](Time) { return true; };
    bool (*scan)(Time t) = [](Time) { return true; };
  };
  /// Calls each(t, odometry) after every sample, lost or not.
  template <class Each>
  static void fly(Odometry& odometry, Keep keep, Each&& each) {
    std::size_t next = 0;
    for (const ImuSample& sample : flight().imu) {
      for (; next < flight().scans.size() && flight().arrivals[next] < sample.time; ++next) {
        if (keep.scan(flight().arrivals[next] - start())) {
          (void)odometry.add_scan(flight().scans[next]);
        }
      }
      if (keep.imu(sample.time - start())) (void)odometry.add_imu(sample);
      each(sample.time - start(), odometry);
    }
  }
};

// Asked for at every sample or once, it is what the estimate would have if it followed the IMU.
TEST_P(HealthTest, CovarianceOfNowIsThatOfTheEstimateCarriedOn) {
  const auto often = Odometry::create(options());
  const auto once = Odometry::create(options());
  Options prompt = options();
  prompt.timing.max_lag = 0.1;  // followed in steps of 5 ms, as the IMU samples
  const auto following = Odometry::create(prompt);
  const BodyCovariance P = BodyCovariance::Identity() * 1e-4;
  for (const auto& odometry : {often.get(), once.get(), following.get()}) {
    ASSERT_EQ(odometry->reset(flight().truth.front(), P), Status::kOk);
  }
  EXPECT_EQ(once->covariance_now(), P);
  for (std::size_t i = 0; i < 180; ++i) {
    for (const auto& odometry : {often.get(), once.get(), following.get()}) {
      ASSERT_EQ(odometry->add_imu(flight().imu[i]), Status::kOk);
    }
    (void)often->covariance_now();
  }
  for (std::size_t i = 180; following->at_scan().time < once->now().time; ++i) {
    ASSERT_EQ(following->add_imu(flight().imu[i]), Status::kOk);
  }
  ASSERT_EQ(following->at_scan().time, once->now().time);
  EXPECT_EQ(once->covariance(), P);
  const BodyCovariance carried = following->covariance();
  for (const auto& odometry : {often.get(), once.get()}) {
    EXPECT_LT((odometry->covariance_now() - carried).norm(), 1e-6 * carried.norm());
  }
  EXPECT_GT(carried(body::kPosition, body::kPosition), 1.2e-4);
}

TEST_P(HealthTest, BeforeTheStartTheCovarianceOfNowIsThatOfTheEstimate) {
  const auto odometry = Odometry::create(options());
  for (std::size_t i = 0; i < 100; ++i) (void)odometry->add_imu(flight().imu[i]);
  ASSERT_FALSE(odometry->initialized());
  EXPECT_EQ(odometry->covariance_now(), odometry->covariance());
}

TEST_P(HealthTest, AGoodFlightIsOkFromItsFirstScansOn) {
  const auto odometry = Odometry::create(options());
  int least = 100;
  fly(*odometry, {}, [&](Time t, const Odometry& o) {
    if (t < seconds(8)) return;
    EXPECT_EQ(o.health().state, HealthState::kOk) << to_seconds(t);
    least = std::min(least, o.health().quality);
  });
  EXPECT_GT(least, 60);
  EXPECT_EQ(odometry->health().reset_counter, 1);
  EXPECT_EQ(odometry->report().health.reset_counter, 1);
}

TEST_P(HealthTest, SilenceIsToldAfterASecondAndForgotten) {
  const auto odometry = Odometry::create(options());
  const Keep keep{.scan = [](Time t) { return t < seconds(10) || t > seconds(14); }};
  fly(*odometry, keep, [](Time t, const Odometry& o) {
    const Health& health = o.health();
    if (t > milliseconds(11200) && t < seconds(14)) {
      EXPECT_EQ(health.position, HealthState::kDeadReckoning) << to_seconds(t);
      EXPECT_TRUE(health.because(HealthReason::kRadarSilent));
    }
    if ((t > seconds(8) && t < seconds(10)) || t > seconds(15)) {
      EXPECT_EQ(health.state, HealthState::kOk) << to_seconds(t);
    }
  });
}

TEST_P(HealthTest, ASilentImuIsToldByTheScans) {
  const auto odometry = Odometry::create(options());
  const Keep keep{.imu = [](Time t) { return t < seconds(10) || t > seconds(11); }};
  fly(*odometry, keep, [](Time t, const Odometry& o) {
    const Health& health = o.health();
    if (t > milliseconds(10600) && t < milliseconds(11200)) {
      EXPECT_NE(health.heading, HealthState::kOk) << to_seconds(t);
      EXPECT_TRUE(health.because(HealthReason::kImuGaps)) << to_seconds(t);
    }
    if (t > seconds(14)) {  // how far it has turned in that second nobody tells
      EXPECT_FALSE(health.because(HealthReason::kImuGaps)) << to_seconds(t);
      EXPECT_TRUE(health.because(HealthReason::kUncertainHeading)) << to_seconds(t);
    }
  });
}

// Nobody may fly on it. The scans tell, though they are soon too far ahead of the IMU to wait.
TEST_P(HealthTest, AnImuThatDiesLosesTheEstimate) {
  const auto odometry = Odometry::create(options());
  const Keep keep{.imu = [](Time t) { return t < seconds(10); }};
  fly(*odometry, keep, [](Time t, const Odometry& o) {
    if (t < seconds(8)) return;
    if (t < seconds(10)) {
      EXPECT_EQ(o.health().state, HealthState::kOk) << to_seconds(t);
    } else if (t > milliseconds(11400)) {
      EXPECT_EQ(o.health().state, HealthState::kLost) << to_seconds(t);
      EXPECT_TRUE(o.health().because(HealthReason::kImuGaps)) << to_seconds(t);
    }
  });
}

// Nor does a radar whose clock is ahead by less than a scan may wait look like a pause of the IMU.
TEST_P(HealthTest, ARadarClockThatIsAheadIsNoPauseOfTheImu) {
  const auto odometry = Odometry::create(options());
  std::size_t next = 0;
  for (const ImuSample& sample : flight().imu) {
    for (; next < flight().scans.size() && flight().arrivals[next] < sample.time; ++next) {
      RadarScan scan = flight().scans[next];
      scan.time += milliseconds(800);
      (void)odometry->add_scan(scan);
      EXPECT_FALSE(odometry->health().because(HealthReason::kImuGaps));
    }
    (void)odometry->add_imu(sample);
  }
}

INSTANTIATE_TEST_SUITE_P(BackEnds, HealthTest, kBothBackEnds, back_end_name);

}  // namespace
}  // namespace rio::test
