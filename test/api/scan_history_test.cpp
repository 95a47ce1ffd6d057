// SPDX-License-Identifier: BSD-3-Clause
#include "odometry/scan_history.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

using std::chrono::milliseconds;

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
    history.take(1, at(52), at(60));
    EXPECT_TRUE(history.is_ready(at(50), 0, at(60)));
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

}  // namespace
}  // namespace rio
