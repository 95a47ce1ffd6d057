// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/velocity_monitor.hpp"

#include <gtest/gtest.h>

#include "support/random_state.hpp"

namespace rio {
namespace {

constexpr int kScans = VelocityMonitor::kScans;

// What a radar with this velocity sees, some points moving with another one, through the RANSAC.
class MonitorTest : public testing::Test {
 protected:
  const Observations& see(const Vector3d& v_S, const RadarVelocity& predicted, int statics = 30,
                          int others = 0, const Vector3d& v_others = Vector3d::Zero()) {
    scan_.items.clear();
    scan_.time += std::chrono::milliseconds(66);
    for (int i = 0; i < statics + others; ++i) {
      const double az = random_.uniform(-1.0, 1.0);
      const double el = random_.uniform(-0.5, 0.5);
      RadarDetection raw;
      raw.point_S =
          3.0 * Vector3d(std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el));
      const Vector3d& v = i < statics ? v_S : v_others;
      raw.range_rate = -raw.point_S.normalized().dot(v) + random_.normal(0.03);
      scan_.items.push_back(make_detection(raw, options_.radar));
    }
    EgoVelocityRansac(options_.frontend).estimate(scan_, predicted, &seen_.ego_velocity);
    seen_.scan = &scan_;
    return seen_;
  }
  static RadarVelocity velocity(const Vector3d& v_S, double sigma) {
    return {v_S, sigma * sigma * Matrix3d::Identity()};
  }

  test::Random random_{11};
  Options options_;
  VelocityMonitor monitor_{options_};
  DetectionList scan_;
  Observations seen_;
  const Vector3d truth_{0.3, -0.2, 0.1};
  const RadarVelocity wrong_ = velocity(Vector3d(2.0, 1.5, -1.0), 0.05);
  const RadarVelocity right_ = velocity(truth_, 0.05);
};

TEST_F(MonitorTest, TheVerdictTakesContradictionsInARow) {
  monitor_.reset(Time(5));
  for (int i = 1; i < kScans; ++i) {
    EXPECT_FALSE(monitor_.contradicts(see(truth_, wrong_), wrong_)) << i;
    EXPECT_EQ(monitor_.agreed(), Time(5));
  }
  EXPECT_TRUE(monitor_.contradicts(see(truth_, wrong_), wrong_));
  monitor_.reset(scan_.time);  // starts over
  EXPECT_FALSE(monitor_.contradicts(see(truth_, wrong_), wrong_));
}

TEST_F(MonitorTest, OneScanThatAgreesEndsTheRow) {
  for (int i = 1; i < 5 * kScans; ++i) {
    const RadarVelocity& predicted = i % kScans == 0 ? right_ : wrong_;
    EXPECT_FALSE(monitor_.contradicts(see(truth_, predicted), predicted)) << i;
    if (i % kScans == 0) {
      EXPECT_EQ(monitor_.agreed(), scan_.time);
    }
  }
}

TEST_F(MonitorTest, RightOrHonestPredictionsAreNotContradicted) {
  for (int i = 0; i < 200; ++i) {
    const RadarVelocity near = velocity(truth_ + random_.normal_vector(0.05), 0.05);
    EXPECT_FALSE(monitor_.contradicts(see(truth_, near), near));
  }
  const RadarVelocity honest = velocity(wrong_.v_S, 2.0);
  for (int i = 0; i < 2 * kScans; ++i) {
    EXPECT_FALSE(monitor_.contradicts(see(truth_, honest), honest));
  }
}

TEST_F(MonitorTest, ACrowdHasNoSayWhileTheStaticWorldIsSeen) {
  const Vector3d crowd = truth_ + Vector3d(1.5, 1.0, 0.5);
  // 60 % of the scan walk in step: the consensus is theirs, but half as many know the prediction
  for (int i = 0; i < 50; ++i) {
    EXPECT_FALSE(monitor_.contradicts(see(truth_, right_, 16, 24, crowd), right_));
  }
}

TEST_F(MonitorTest, AConsensusThatIsNoMajorityHasNoSay) {
  test::Random noise(12);
  for (int i = 0; i < 50; ++i) {
    see(truth_, wrong_, 12, 28);
    for (std::size_t k = 12; k < 40; ++k) scan_.items[k].range_rate = noise.uniform(-8.0, 8.0);
    EgoVelocityRansac(options_.frontend).estimate(scan_, wrong_, &seen_.ego_velocity);
    EXPECT_FALSE(monitor_.contradicts(seen_, wrong_)) << seen_.ego_velocity.inliers;
  }
}

TEST_F(MonitorTest, FewPointsHaveNoSay) {
  for (int i = 0; i < 50; ++i) EXPECT_FALSE(monitor_.contradicts(see(truth_, wrong_, 9), wrong_));
}

TEST_F(MonitorTest, CanBeSwitchedOff) {
  options_.frontend.velocity_recovery = false;
  VelocityMonitor off(options_);
  for (int i = 0; i < 2 * kScans; ++i) EXPECT_FALSE(off.contradicts(see(truth_, wrong_), wrong_));
}

}  // namespace
}  // namespace rio
