// SPDX-License-Identifier: BSD-3-Clause
#include "rio/checks/stamp_guard.hpp"

#include <gtest/gtest.h>

#include <utility>

namespace rio {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr Time kPeriod = milliseconds(5);

class StampGuardTest : public testing::Test {
 protected:
  /// A healthy second of stamps, 5 ms apart.
  void SetUp() override {
    for (int i = 0; i < 200; ++i) {
      ASSERT_EQ(guard_.check(now_), StampVerdict::kFollows);
      guard_.take(now_);
      now_ += kPeriod;
    }
  }
  StampVerdict next(Time stamp) {
    const StampVerdict verdict = guard_.check(stamp);
    if (verdict == StampVerdict::kFollows || verdict == StampVerdict::kRestarted)
      guard_.take(stamp);
    return verdict;
  }
  /// Stamps from `from` on until one is taken: how many were not.
  int refused_from(Time from) {
    int refused = 0;
    for (; refused < 1000; ++refused, from += kPeriod) {
      if (next(from) == StampVerdict::kRestarted) break;
    }
    return refused;
  }

  Time now_ = seconds(1'700'000'000);
  StampGuard guard_{seconds(600)};
};

TEST_F(StampGuardTest, OddStampsAreRefusedAndNothingElse) {
  const Time newest = now_ - kPeriod;
  EXPECT_EQ(next(newest), StampVerdict::kOld);
  EXPECT_EQ(next(newest - hours(1)), StampVerdict::kOld);
  EXPECT_EQ(next(newest + hours(1)), StampVerdict::kAhead);
  EXPECT_EQ(next(Time::min()), StampVerdict::kOld);
  EXPECT_EQ(next(Time::max()), StampVerdict::kAhead);
  EXPECT_EQ(next(kFarthestStamp), StampVerdict::kAhead);
  EXPECT_EQ(next(-kFarthestStamp), StampVerdict::kOld);
  EXPECT_EQ(next(now_), StampVerdict::kFollows);
}

TEST_F(StampGuardTest, APauseUpToHalfASecondIsNotOdd) {
  EXPECT_EQ(next(now_ - kPeriod + milliseconds(500) + Time(1)), StampVerdict::kAhead);
  EXPECT_EQ(next(now_ - kPeriod + milliseconds(500)), StampVerdict::kFollows);
}

TEST_F(StampGuardTest, ALastingJumpIsTakenAfterATenthOfASecond) {
  for (const Time jump :
       {Time(-now_), Time(-milliseconds(200)), Time(hours(1)), Time(seconds(600))}) {
    now_ += jump;
    EXPECT_EQ(refused_from(now_), 20) << jump.count();
    EXPECT_EQ(guard_.newest_in_run(), now_ - kPeriod);
    now_ += 21 * kPeriod;
    EXPECT_EQ(next(now_), StampVerdict::kFollows);
    now_ += kPeriod;
  }
}

// If the stamps after a long one were wrong after all, much would be lost: it takes a second.
TEST_F(StampGuardTest, APauseIsTakenWhenTheStampsGoOnFromThere) {
  for (const auto& [pause, refused] : {std::pair(seconds(10), 4), std::pair(seconds(600), 200)}) {
    now_ += pause - kPeriod;
    for (int i = 0; i < refused; ++i, now_ += kPeriod) {
      EXPECT_EQ(next(now_), StampVerdict::kAhead);
    }
    for (int i = 0; i < 2; ++i, now_ += kPeriod) EXPECT_EQ(next(now_), StampVerdict::kFollows);
  }
}

// Frozen samples, say, which come in time.
TEST_F(StampGuardTest, SamplesThatAreNotTakenKeepTheClock) {
  for (int i = 0; i < 500; ++i, now_ += kPeriod) {
    ASSERT_EQ(guard_.check(now_), StampVerdict::kFollows) << i;
  }
  EXPECT_EQ(next(now_), StampVerdict::kFollows);
}

TEST_F(StampGuardTest, AFewStampsAreNoRunHoweverLong) {
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(next(now_ + hours(1) + i * milliseconds(100)), StampVerdict::kAhead);
  }
  EXPECT_EQ(next(now_ + hours(1) + milliseconds(400)), StampVerdict::kRestarted);
}

TEST_F(StampGuardTest, AGoodStampOrAFallEndsTheRun) {
  for (int i = 0; i < 100; ++i) {  // every other one is odd
    EXPECT_EQ(next(now_ + hours(1)), StampVerdict::kAhead);
    EXPECT_EQ(next(now_), StampVerdict::kFollows);
    now_ += kPeriod;
  }
  for (int i = 0; i < 100; ++i) {  // the same, and no sample is taken
    EXPECT_EQ(guard_.check(now_ + hours(1)), StampVerdict::kAhead);
    EXPECT_EQ(guard_.check(now_), StampVerdict::kFollows);
    now_ += kPeriod;
  }
  for (int i = 0; i < 100; ++i) {  // no clock falls
    EXPECT_EQ(next(now_ + hours(1) - i * kPeriod), StampVerdict::kAhead);
  }
}

TEST_F(StampGuardTest, AJumpNotTakenStaysOne) {
  guard_.reset();
  EXPECT_EQ(next(Time{0}), StampVerdict::kFollows);  // one stamp has no interval
  Time stamp = hours(2);
  while (guard_.check(stamp) != StampVerdict::kRestarted) stamp += kPeriod;
  EXPECT_EQ(guard_.check(stamp + kPeriod), StampVerdict::kRestarted);  // the value was refused
  EXPECT_EQ(guard_.newest_in_run(), hours(2));
}

}  // namespace
}  // namespace rio
