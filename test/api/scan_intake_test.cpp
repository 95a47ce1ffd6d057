// SPDX-License-Identifier: BSD-3-Clause
// The intake of scans: pauses told from jumps, what is late, repeated or waited for.
#include "odometry/scan_intake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace rio {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(StampRun, TellsAPauseFromAJump) {
  StampRun run(seconds(1));
  EXPECT_FALSE(run.goes_through(seconds(0), seconds(20)));
  for (Time t{0}; t <= seconds(20); t += milliseconds(100)) run.add(t);
  EXPECT_TRUE(run.goes_through(seconds(5), seconds(20)));
  EXPECT_TRUE(run.goes_through(seconds(-1) + milliseconds(1), milliseconds(20999)));
  EXPECT_FALSE(run.goes_through(seconds(-1), seconds(20))) << "it began later";
  EXPECT_FALSE(run.goes_through(seconds(5), seconds(21))) << "it has ended before";
  EXPECT_FALSE(run.goes_through(seconds(20), seconds(20))) << "nothing lies between";
  run.add(Time::min());  // no stamp
  EXPECT_TRUE(run.goes_through(seconds(5), seconds(20)));
  run.add(seconds(21));  // as far as a jump is
  EXPECT_FALSE(run.goes_through(seconds(5), seconds(21)));
}

// Scans of several radars arrive in any order.
TEST(StampRun, GoesOnBackwardsToo) {
  StampRun run(seconds(1));
  for (int i = 0; i < 100; ++i) run.add(milliseconds(100 * i + (i % 2 == 0 ? 250 : 0)));
  EXPECT_TRUE(run.goes_through(seconds(2), seconds(10)));
}

DetectionList scan_with(double range_rate, std::size_t radar = 0) {
  DetectionList scan;
  scan.radar = radar;
  scan.items.resize(1);
  scan.items[0].range_rate = range_rate;
  return scan;
}

TEST(ScanHistory, AScanIsTheLastOnceProcessed) {
  ScanHistory history(2, 0.1);
  EXPECT_FALSE(history.is_last(Time{0}, 0));
  history.process(milliseconds(70), 0, milliseconds(60));
  EXPECT_TRUE(history.is_last(milliseconds(70), 0));
  EXPECT_FALSE(history.is_last(milliseconds(70), 1));
  history.forget(Time{0});
  EXPECT_FALSE(history.is_last(milliseconds(70), 0));
}

TEST(ScanHistory, FollowsTheLastWhileTheEstimateIsOfItsTime) {
  ScanHistory history(2, 0.1);
  history.process(milliseconds(70), 0, milliseconds(60));
  EXPECT_TRUE(history.follows_last(milliseconds(71), 0, milliseconds(60)));
  EXPECT_FALSE(history.follows_last(milliseconds(70), 0, milliseconds(60)));
  EXPECT_FALSE(history.follows_last(milliseconds(71), 0, milliseconds(65))) << "it has moved on";
  EXPECT_FALSE(history.follows_last(milliseconds(71), 1, milliseconds(60)));
  history.process(milliseconds(72), 1, milliseconds(60));
  EXPECT_FALSE(history.follows_last(milliseconds(73), 0, milliseconds(60))) << "not the last";
}

TEST(ScanHistory, KnowsARepeatedScanOfEachRadar) {
  ScanHistory history(2, 0.1);
  EXPECT_FALSE(history.is_repeated(scan_with(0.5)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.5, 1)));
  EXPECT_TRUE(history.is_repeated(scan_with(0.5)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.6)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.0)));
  EXPECT_FALSE(history.is_repeated(scan_with(0.0))) << "at rest scans may be alike";
  EXPECT_TRUE(history.is_repeated(scan_with(0.5, 1)));
  history.forget(Time{0});
  EXPECT_TRUE(history.is_repeated(scan_with(0.5, 1)));
  history.forget_fingerprints();
  EXPECT_FALSE(history.is_repeated(scan_with(0.5, 1)));
}

TEST(ScanHistory, OneRadarWaitsForTheImuAlone) {
  const ScanHistory history(1, 0.1);
  EXPECT_FALSE(history.is_ready(milliseconds(50), 0, milliseconds(49)));
  EXPECT_TRUE(history.is_ready(milliseconds(50), 0, milliseconds(50)));
}

TEST(ScanHistory, OfTwoRadarsEachWaitsForTheOther) {
  for (const Time epoch : {milliseconds(0), milliseconds(-1000)}) {
    const auto at = [epoch](int ms) { return epoch + milliseconds(ms); };
    ScanHistory history(2, 0.1);
    history.forget(epoch);
    history.take(0, at(50), at(55));
    EXPECT_FALSE(history.is_ready(at(50), 0, at(60)));
    EXPECT_TRUE(history.is_ready(at(50), 0, at(150))) << "long enough";
    history.take(1, at(40), at(60));
    EXPECT_FALSE(history.is_ready(at(50), 0, at(60))) << "that was an earlier one";
    for (const int instant : {49, 52}) {  // the same one, but for errors of the time offsets
      history.take(1, at(instant), at(60));
      EXPECT_TRUE(history.is_ready(at(50), 0, at(60))) << instant;
    }
  }
}

TEST(ScanHistory, ASilentRadarIsNotWaitedFor) {
  ScanHistory history(2, 0.1);
  history.forget(milliseconds(0));
  history.take(1, milliseconds(10), milliseconds(20));
  history.take(0, milliseconds(500), milliseconds(510));
  EXPECT_FALSE(history.is_ready(milliseconds(500), 0, milliseconds(519)));
  EXPECT_TRUE(history.is_ready(milliseconds(500), 0, milliseconds(520)));
}

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

// However few they are: without its only detection it would pass for an empty one.
TEST_F(ScanIntakeTest, AScanOfNonFiniteDetectionsAloneIsRefused) {
  start(1);
  const auto accept = [this](std::size_t count) {
    RadarScan scan{milliseconds(890), {}};
    scan.detections.resize(count);
    for (RadarDetection& d : scan.detections) d.point_S.setConstant(std::nan(""));
    return intake_->accept(scan, {0, scan.time, scan.time}, Time{0}, *imu_, &counters_);
  };
  EXPECT_EQ(accept(1), Status::kNonFinite);
  EXPECT_EQ(accept(0), Status::kOk);
}

}  // namespace
}  // namespace rio
