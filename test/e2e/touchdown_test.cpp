// SPDX-License-Identifier: BSD-3-Clause
// A sensor carried through a room and set down, where it is touched and tilted for some seconds: it
// stays where it is, in the recording and in perturbed copies of it. No option set, static start,
// both back-ends. Skipped without RIO_TEST_DATA, a folder with `ti_demo`.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/recording.hpp"
#include "support/measured.hpp"
#include "support/real_data.hpp"

namespace rio::test {
namespace {

class Touchdown : public testing::TestWithParam<BackEnd> {};

TEST_P(Touchdown, StaysWhereItIs) {
  const std::filesystem::path folder = real_data("ti_demo");
  if (folder.empty()) GTEST_SKIP() << kNoRealData;
  const experiment::Recording recording = experiment::find_recordings(folder).front();
  std::vector<double> creep;
  double creep_sigmas = 0.0;
  const auto fly = [&](const experiment::Recording& one) {
    Options options;
    io::apply_sensor_info(one.data, &options);
    options.backend = GetParam();
    const experiment::RealScore score =
        experiment::judge(one, experiment::replay(one.data, options));
    if (!score.started) return;
    creep.push_back(score.creep);
    creep_sigmas = std::max(creep_sigmas, score.creep_sigmas);
  };
  fly(recording);
  ASSERT_EQ(creep.size(), 1U);
  const double unchanged = creep.front();
  const int draws = GetParam() == BackEnd::kEkf ? 18 : 2;  // the window takes six times as long
  const std::vector<experiment::Copy> copies = experiment::perturbed(recording, draws, 1);
  for (const experiment::Copy& copy : copies) fly(copy.recording);
  ASSERT_GE(creep.size(), copies.size());  // one has too little rest before the start
  std::sort(creep.begin(), creep.end());
  const double median = creep[creep.size() / 2];
  const std::string name = GetParam() == BackEnd::kEkf ? "filter" : "window";
  measured(name + ": creep of the height, of the recording itself [m]", unchanged, "");
  measured(name + ": creep of the height after touchdown, median [m]", median, "at most 0.03");
  measured(name + ": creep in its sigmas, worst", creep_sigmas, "below 1");
  EXPECT_LE(median, 0.03);
  EXPECT_LT(creep_sigmas, 1.0);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Touchdown, testing::Values(BackEnd::kEkf, BackEnd::kSmoother),
                         [](const auto& b) {
                           return std::string(b.param == BackEnd::kEkf ? "filter" : "window");
                         });

}  // namespace
}  // namespace rio::test
