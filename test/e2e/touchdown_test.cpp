// SPDX-License-Identifier: BSD-3-Clause
// A sensor carried through a room and set down, where it is touched and tilted for some seconds: it
// stays where it is. No option set, static start, both back-ends. Skipped without RIO_TEST_DATA, a
// folder with `ti_demo`.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "experiment/recording.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

namespace fs = std::filesystem;

class Touchdown : public testing::TestWithParam<BackEnd> {};

TEST_P(Touchdown, StaysWhereItIs) {
  const char* data = std::getenv("RIO_TEST_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : "") / "ti_demo";
  if (data == nullptr || !fs::exists(folder)) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recording ti_demo";
  }
  const experiment::Recording recording = experiment::find_recordings(folder).front();
  Options options;
  io::apply_sensor_info(recording.data, &options);
  options.backend = GetParam();
  const experiment::Replay replay = experiment::replay(recording.data, options);
  const experiment::RealScore score = experiment::judge(recording, replay);
  ASSERT_TRUE(score.started);
  const std::string name = GetParam() == BackEnd::kEkf ? "filter" : "window";
  measured(name + ": creep of the height after touchdown [m]", score.creep, "at most 0.02");
  measured(name + ": creep in its sigmas", score.creep_sigmas, "below 1");
  EXPECT_LE(score.creep, 0.02);
  EXPECT_LT(score.creep_sigmas, 1.0);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Touchdown, testing::Values(BackEnd::kEkf, BackEnd::kSmoother),
                         [](const auto& b) {
                           return std::string(b.param == BackEnd::kEkf ? "filter" : "window");
                         });

}  // namespace
}  // namespace rio::test
