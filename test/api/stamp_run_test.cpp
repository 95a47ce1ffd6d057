// SPDX-License-Identifier: BSD-3-Clause
#include "odometry/stamp_run.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace rio
