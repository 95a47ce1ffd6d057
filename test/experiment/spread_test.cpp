// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/spread.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace rio::experiment {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Spread, MeanWorstAndSampleDeviation) {
  const Spread s = Spread::of(std::vector<double>{1.0, 4.0, 1.0});
  EXPECT_DOUBLE_EQ(s.mean, 2.0);
  EXPECT_DOUBLE_EQ(s.worst, 4.0);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(3.0));
  EXPECT_EQ(s.text(2), "2.00 (4.00) ± 1.73");
  EXPECT_EQ(Spread::of(std::vector<double>{0.5}).text(1), "0.5 (0.5) ± 0.0");
  EXPECT_EQ(Spread::of(std::vector<double>{}).text(1), "- (-) ± -");
  EXPECT_EQ(number(999.96, 1), "1000.0");
  EXPECT_EQ(number(-12345.6, 2), "-12346");  // large figures have no decimals
}

TEST(Spread, OneMissingFigureIsTheWorst) {
  for (const auto& values :
       {std::vector<double>{kNan, 1.0, 2.0}, {1.0, kNan, 2.0}, {1.0, 2.0, kNan}}) {
    EXPECT_TRUE(std::isnan(Spread::of(values).worst));
    EXPECT_TRUE(std::isnan(Spread::of(values).mean));
  }
}

TEST(MarkdownTable, HeadRuleAndRows) {
  MarkdownTable table({"a", "b"});
  table.add({"1", "2"});
  EXPECT_EQ(table.text(), "| a | b |\n| --- | --- |\n| 1 | 2 |\n");
  EXPECT_THROW(table.add({"1"}), std::logic_error);
}

}  // namespace
}  // namespace rio::experiment
