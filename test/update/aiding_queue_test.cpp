// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors come in any order and leave in that of their time.
#include "rio/update/aiding_queue.hpp"

#include <gtest/gtest.h>

#include "rio/models/aids.hpp"

namespace rio::test {
namespace {

using std::chrono::milliseconds;

AidingMeasurement measured(int ms) {
  return {milliseconds(ms), GroundRangeModel{}, {1.0, 0.1}};
}

class AidingQueueTest : public testing::Test {
 protected:
  AidingQueueTest() { x_.time = milliseconds(1000); }
  /// Takes those up to `ms`; the state 7 ms later keeps each.
  std::vector<int> take(int ms) {
    queue_.take(milliseconds(ms), x_, imu_, [](Time t) { return t + milliseconds(7); });
    std::vector<int> times;
    for (const AidingObservation& seen : queue_.taken()) {
      times.push_back(static_cast<int>(seen.measurement.time() / milliseconds(1)));
      EXPECT_EQ(seen.anchor, seen.measurement.time() + milliseconds(7));
    }
    return times;
  }

  AidingQueue queue_;
  NavState x_;
  ImuBuffer imu_{TimingOptions{}, ImuOptions{}};
};

TEST_F(AidingQueueTest, TakesTheOldestInTheOrderOfTheirTime) {
  for (const int ms : {30, 10, 40, 20}) EXPECT_TRUE(queue_.add(measured(ms)));
  EXPECT_EQ(queue_.next(), milliseconds(10));
  EXPECT_EQ(take(30), (std::vector<int>{10, 20, 30}));
  EXPECT_EQ(queue_.next(), milliseconds(40));
  EXPECT_TRUE(take(39).empty());
  EXPECT_EQ(take(40), std::vector<int>{40});
  EXPECT_FALSE(queue_.next());
}

TEST_F(AidingQueueTest, MoreThanAnUpdateTakesAreABatchOfTheirOwn) {
  const int most = static_cast<int>(kMaxAiding);
  for (int i = 0; i < most; ++i) EXPECT_TRUE(queue_.add(measured(i)));
  EXPECT_FALSE(queue_.full_batch(milliseconds(500)));
  EXPECT_TRUE(queue_.add(measured(most)));
  EXPECT_FALSE(queue_.full_batch(milliseconds(most - 1)));  // the last is of later
  EXPECT_EQ(queue_.full_batch(milliseconds(500)), milliseconds(most - 1));
  EXPECT_EQ(take(500).size(), kMaxAiding);
  EXPECT_EQ(take(500), std::vector<int>{most});
}

TEST_F(AidingQueueTest, RefusesWhatItHasNoRoomFor) {
  int taken = 0;
  while (taken < 1000 && queue_.add(measured(taken))) ++taken;
  EXPECT_EQ(taken, 256);
  queue_.clear();
  EXPECT_FALSE(queue_.next());
  EXPECT_TRUE(queue_.taken().empty());
}

}  // namespace
}  // namespace rio::test
