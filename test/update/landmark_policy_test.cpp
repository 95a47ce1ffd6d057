// SPDX-License-Identifier: BSD-3-Clause
// Who stays, who leaves and who gives way, with a back-end that only keeps the list.
#include "rio/update/landmark_policy.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "support/scan_case.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Landmarks 0, 1, ... at x = 0, 1, ..., last seen 1 s, 2 s, ... ago.
class LandmarkPolicyTest : public test::ScanCase {
 protected:
  LandmarkPolicyTest() {
    x_.nav.time = seconds(100);
    x_.distance_travelled = 12.0;
    for (int i = 0; i < 4; ++i) {
      LandmarkState landmark;
      landmark.p_W.x() = i;
      landmark.last_seen = x_.nav.time - seconds(1 + i);
      x_.landmarks.push_back(landmark);
    }
    options_.update.max_landmarks = 4;
  }
  void maintain(const ScanRows& rows) {
    report_ = UpdateReport{};
    maintain_landmarks(
        seen_, rows, promotions_, options_, &x_, &report_,
        [this](std::size_t i) {
          x_.landmarks[i] = x_.landmarks.back();
          x_.landmarks.pop_back();
        },
        [this](std::size_t i) { return x_.landmarks[i].p_W.x() == needed_; },
        [this](const Detection& d) {
          LandmarkState landmark;
          landmark.p_W = d.point_S;
          landmark.last_seen = x_.nav.time;
          x_.landmarks.push_back(landmark);
        });
  }
  /// That stand at this x.
  int count(double at) const {
    int n = 0;
    for (const LandmarkState& l : x_.landmarks) n += l.p_W.x() == at ? 1 : 0;
    return n;
  }
  void bear(double at) {
    Detection d;
    d.point_S = Vector3d(at, 0.0, 0.0);
    promotions_.births.push_back(d);
  }

  Estimate x_;
  Promotions promotions_;
  double needed_ = -1.0;  ///< x of the landmark that a window needs
};

TEST_F(LandmarkPolicyTest, TheStalestIsTheOneUnseenForLongest) {
  EXPECT_EQ(stalest_landmark(x_), 3U);
  x_.landmarks[1].last_seen = Time(0);
  EXPECT_EQ(stalest_landmark(x_), 1U);
}

TEST_F(LandmarkPolicyTest, RoomIsWhatIsNotInView) {
  options_.update.max_landmarks = 10;
  EXPECT_EQ(landmark_room(x_, seen_, options_), 6U);  // all seen less than eight seconds ago
  x_.landmarks[2].last_seen = x_.nav.time - seconds(8);
  EXPECT_EQ(landmark_room(x_, seen_, options_), 7U);
  match_landmark(2, 0);  // matched now, used or not
  EXPECT_EQ(landmark_room(x_, seen_, options_), 6U);
  options_.frontend.landmark_timeout = 2.5;
  EXPECT_EQ(landmark_room(x_, seen_, options_), 7U);  // 0, 1 and the matched one
}

TEST_F(LandmarkPolicyTest, OnlyAUsedMatchKeepsALandmarkAlive) {
  match_landmark(0, 0);
  match_landmark(1, 2);  // far off: gated
  ScanRows rows(options_);
  build(rows, state_estimate(2));
  const Time before = x_.landmarks[1].last_seen;
  maintain(rows);
  EXPECT_EQ(x_.landmarks[0].last_seen, x_.nav.time);
  EXPECT_EQ(x_.landmarks[0].distance_seen, x_.distance_travelled);
  EXPECT_EQ(x_.landmarks[1].last_seen, before);
  EXPECT_EQ(x_.landmarks[1].distance_seen, 0.0);
}

TEST_F(LandmarkPolicyTest, TheUnseenLeaveAfterTheTimeout) {
  options_.frontend.landmark_timeout = 2.0;
  const ScanRows rows(options_);
  maintain(rows);
  EXPECT_EQ(report_.landmarks_removed, 2);  // of one, two, three and four seconds
  ASSERT_EQ(x_.landmarks.size(), 2U);
  EXPECT_EQ(count(0.0) + count(1.0), 2);
  x_.nav.time += milliseconds(1);
  maintain(rows);
  EXPECT_EQ(count(0.0), 1);
  EXPECT_EQ(x_.landmarks.size(), 1U);
}

TEST_F(LandmarkPolicyTest, ANeededOneRetiresInsteadOfLeaving) {
  options_.frontend.landmark_timeout = 2.0;
  needed_ = 3.0;
  const ScanRows rows(options_);
  maintain(rows);
  EXPECT_EQ(report_.landmarks_removed, 1);
  ASSERT_EQ(count(3.0), 1);
  for (const LandmarkState& l : x_.landmarks) EXPECT_EQ(l.retired, l.p_W.x() == 3.0);
  needed_ = -1.0;
  maintain(rows);
  EXPECT_EQ(report_.landmarks_removed, 1);
  EXPECT_EQ(count(3.0), 0);
}

TEST_F(LandmarkPolicyTest, OfTooManyTheStalestGivesWay) {
  options_.update.max_landmarks = 5;
  bear(10.0);
  bear(11.0);
  maintain(ScanRows(options_));
  EXPECT_EQ(report_.landmarks_added, 2);
  EXPECT_EQ(report_.landmarks_removed, 1);
  EXPECT_EQ(x_.landmarks.size(), 5U);
  EXPECT_EQ(count(3.0), 0);
  EXPECT_EQ(count(10.0) + count(11.0), 2);
}

}  // namespace
}  // namespace rio
