// SPDX-License-Identifier: BSD-3-Clause
// The ring of states of the sliding window.
#include "rio/smoother/window.hpp"

#include <gtest/gtest.h>

namespace rio {
namespace {

constexpr Time kPeriod = std::chrono::milliseconds(100);

class WindowTest : public testing::Test {
 protected:
  /// States at 5, 6 and 7 periods, scans 50, 60 and 70; the oldest slot is not the first.
  WindowTest() {
    for (int i = 4; i < 8; ++i) {
      if (i == 7) window_.pop_oldest();
      WindowState& state = window_.push();
      state.nav.time = i * kPeriod;
      state.scan = static_cast<ScanId>(10 * i);
    }
  }
  Window window_{3, Options{}};
};

TEST_F(WindowTest, FindsTheFirstStateFromATimeOn) {
  EXPECT_EQ(window_.first_from(Time{0}), 0U);
  for (int k = 0; k < 3; ++k) {
    const auto index = static_cast<std::size_t>(k);
    EXPECT_EQ(window_.first_from((5 + k) * kPeriod), index);
    EXPECT_EQ(window_.first_from((5 + k) * kPeriod + Time(1)), index + 1);
  }
}

TEST_F(WindowTest, FindsTheStateOfAScan) {
  EXPECT_EQ(window_.find(60), 1);
  EXPECT_EQ(window_.find(40), -1);
  EXPECT_EQ(window_.newest().scan, 70U);
}

TEST_F(WindowTest, CutsWhatAScanAdded) {
  WindowState& state = window_.newest();
  state.measurements.add(Measured<DopplerModel>{});
  state.scanned[0].time_offset = 0.1;
  const WindowState::Mark mark = state.mark();
  EXPECT_FALSE(state.at_rest());
  state.measurements.add(Measured<RestModel>{});
  state.scanned[0].time_offset = 0.2;
  EXPECT_TRUE(state.at_rest());
  state.cut(mark);
  EXPECT_FALSE(state.at_rest());
  EXPECT_EQ(state.measurements.size(), 1U);
  EXPECT_EQ(state.scanned[0].time_offset, 0.1);
  window_.pop_newest();
  EXPECT_EQ(window_.push().measurements.size(), 0U);  // a used slot is cleared
}

}  // namespace
}  // namespace rio
