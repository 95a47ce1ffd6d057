// SPDX-License-Identifier: BSD-3-Clause
// Which items of a recording are in the order of time: corrupt stamps cost their own items alone.
#include "check/order.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

namespace rio::check {
namespace {

struct Item {
  Time time{0};
};
using Order = std::vector<std::size_t>;

std::vector<Item> items(const std::vector<Time>& times) {
  std::vector<Item> out;
  for (const Time time : times) out.push_back({time});
  return out;
}

TEST(InOrder, TakesTheLongestRisingSequence) {
  EXPECT_EQ(in_order(items({Time{1}, Time{2}, Time{3}, Time{4}})), (Order{0, 1, 2, 3}));
  EXPECT_EQ(in_order(items({Time{1}, Time{3}, Time{2}, Time{3}, Time{4}})), (Order{0, 2, 3, 4}));
  EXPECT_EQ(in_order(items({Time{1}, Time{2}, Time{2}, Time{3}})), (Order{0, 1, 3}));
  EXPECT_EQ(in_order(items({Time{1}, Time{2}, Time{90}, Time{3}, Time{4}})), (Order{0, 1, 3, 4}));
  EXPECT_EQ(in_order(items({Time{1}, Time{2}, Time{3}, Time{90}})), (Order{0, 1, 2}));
  EXPECT_EQ(in_order(items({Time{5}, Time{6}, Time{7}, Time{8}, Time{1}})), (Order{0, 1, 2, 3}));
  EXPECT_TRUE(in_order(items({})).empty());
}

// The differences of what is left cannot overflow.
TEST(InOrder, LeavesOutWhatIsNoStamp) {
  EXPECT_EQ(in_order(items({Time::min(), Time::min() + Time{1}, Time{1}, Time{2}, Time::max()})),
            (Order{2, 3}));
  EXPECT_EQ(in_order(items({Time{1}, Time::min(), Time::max(), Time{2}, Time{3}})),
            (Order{0, 3, 4}));
  EXPECT_EQ(in_order(items({Time::min(), Time::max()})), (Order{0}));
}

TEST(Strays, AreCountedButForRepeatedStamps) {
  const Strays found =
      strays(items({Time{1}, Time{2}, Time{2}, Time::min(), Time{3}, Time{90}, Time{4}, Time{5}}));
  EXPECT_EQ(found.count, 2U);
  EXPECT_EQ(found.first, 3U);
}

}  // namespace
}  // namespace rio::check
