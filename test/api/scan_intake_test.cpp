// SPDX-License-Identifier: BSD-3-Clause
#include "odometry/scan_intake.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

using std::chrono::milliseconds;

class ScanIntakeTest : public testing::Test {
 protected:
  /// An IMU that has reached 0.9 s; no scan yet.
  void start(std::size_t radars) {
    if (radars == 2)
      options_.other_radars.push_back({options_.radar.T_BS, 0.0, 0.0, options_.radar});
    imu_.emplace(options_.timing, options_.imu);
    intake_.emplace(options_);
    reach(900);
    intake_->forget(*imu_);
  }
  void reach(int ms) { imu_->push_back({milliseconds(ms), {}, {}}); }

  /// A scan of other range rates than those before.
  Status add(int ms, std::size_t radar = 0) {
    RadarScan scan;
    scan.detections.resize(1);
    scan.detections[0].point_S = {1.0, 0.2, 0.3};
    scan.detections[0].range_rate = 0.01 * ++count_;
    const Time stamp = intake_->corrected(milliseconds(ms), radar, *imu_);
    return intake_->accept(scan, {radar, stamp, stamp}, Time{0}, *imu_, &counters_);
  }

  Options options_;
  std::optional<ImuBuffer> imu_;
  std::optional<ScanIntake> intake_;
  Counters counters_;
  int count_ = 0;
};

TEST_F(ScanIntakeTest, AScanWaitsWhereAnEarlierOneOfAnotherRadarDoes) {
  start(2);
  EXPECT_EQ(add(910), Status::kWaiting);
  EXPECT_EQ(add(930), Status::kWaiting);
  reach(950);
  EXPECT_EQ(add(920, 1), Status::kWaiting);  // by itself it would be ready
  EXPECT_TRUE(intake_->is_ready(milliseconds(920), 1, *imu_));
  ASSERT_EQ(intake_->queue().size(), 3U);
  EXPECT_EQ(intake_->queue().front().time, milliseconds(910));
}

TEST_F(ScanIntakeTest, OfOneRadarAnOlderScanOvertakesThoseThatWait) {
  start(1);
  EXPECT_EQ(add(910), Status::kWaiting);
  EXPECT_EQ(add(910), Status::kDuplicate);
  EXPECT_EQ(add(890), Status::kOk);
  EXPECT_EQ(intake_->accepted().time, milliseconds(890));
  EXPECT_EQ(intake_->queue().size(), 1U);
  intake_->processed(intake_->accepted(), milliseconds(890));
  EXPECT_EQ(add(890), Status::kDuplicate);
  EXPECT_EQ(counters_.scans_duplicate, 2U);
}

}  // namespace
}  // namespace rio
