// SPDX-License-Identifier: BSD-3-Clause
// Real drives of a rough vehicle with sparse radars and lost IMU samples, on a flat floor: no
// option set, static start, both back-ends. Skipped without RIO_TEST_DATA, a folder with `kart`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/recording.hpp"
#include "support/measured.hpp"

namespace rio::test {
namespace {

namespace fs = std::filesystem;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// What must be reached, in percent of the way.
struct Bounds {
  BackEnd backend;
  const char* name;
  double height_median;
};

class Kart : public testing::TestWithParam<Bounds> {};

TEST_P(Kart, FindsItsWay) {
  const Bounds& bounds = GetParam();
  const char* data = std::getenv("RIO_TEST_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : "") / "kart";
  if (data == nullptr || !fs::exists(folder)) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recordings kart";
  }
  std::vector<double> horizontal;
  std::vector<double> height;
  double honest = 100.0;  // of the worst recording
  const std::vector<experiment::Recording> recordings = experiment::find_recordings(folder);
  for (const experiment::Recording& recording : recordings) {
    ASSERT_TRUE(recording.flat()) << recording.name;
    Options options;
    io::apply_sensor_info(recording.data, &options);
    options.backend = bounds.backend;
    const experiment::RealScore score =
        experiment::judge(recording, experiment::replay(recording.data, options));
    ASSERT_TRUE(score.started) << recording.name;
    horizontal.push_back(100.0 * score.horizontal / score.distance);
    height.push_back(100.0 * score.height / score.distance);
    honest = std::min(honest, 100.0 * score.honest);
  }
  const auto expect_below = [&](const char* what, double value, double bound) {
    measured(std::string(bounds.name) + ": " + what, value, "below " + std::to_string(bound));
    EXPECT_LT(value, bound) << what;
  };
  expect_below("horizontal, median [%]", median(horizontal), 2.0);
  expect_below("horizontal, worst [%]", *std::max_element(horizontal.begin(), horizontal.end()),
               4.0);
  expect_below("height, median [%]", median(height), bounds.height_median);
  expect_below("height, worst [%]", *std::max_element(height.begin(), height.end()), 4.0);
  measured(std::string(bounds.name) + ": height zero within 3 sigmas, worst [%]", honest,
           "above 95");
  EXPECT_GT(honest, 95.0);
}

TEST_P(Kart, TwoRadarsOfADriveAreBetterThanOne) {
  const char* data = std::getenv("RIO_TEST_DATA");
  const fs::path folder = fs::path(data != nullptr ? data : "") / "kart";
  if (data == nullptr || !fs::exists(folder)) {
    GTEST_SKIP() << "needs RIO_TEST_DATA, a folder with the recordings kart";
  }
  std::vector<double> horizontal;
  std::vector<double> height;
  const std::vector<experiment::Recording> recordings = experiment::find_recordings(folder);
  for (std::size_t i = 0; i + 1 < recordings.size(); i += 2) {  // NAME_A, NAME_B
    experiment::Recording both = recordings[i];
    const io::Dataset& other = recordings[i + 1].data;
    both.data.other_radars.push_back({other.scans, other.radar_info});
    Options options;
    io::apply_sensor_info(both.data, &options);
    options.backend = GetParam().backend;
    const experiment::RealScore score =
        experiment::judge(both, experiment::replay(both.data, options));
    ASSERT_TRUE(score.started) << both.name;
    horizontal.push_back(100.0 * score.horizontal / score.distance);
    height.push_back(100.0 * score.height / score.distance);
  }
  const std::string name = GetParam().name;  // one radar: 1.4 and 0.9 to 1.0
  measured(name + ", both radars: horizontal, median [%]", median(horizontal), "below 1");
  measured(name + ", both radars: height, median [%]", median(height), "below 1.4");
  EXPECT_LT(median(horizontal), 1.0);
  EXPECT_LT(median(height), 1.4);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Kart,
                         testing::Values(Bounds{BackEnd::kEkf, "filter", 1.2},
                                         Bounds{BackEnd::kSmoother, "window", 1.3}),
                         [](const auto& b) { return std::string(b.param.name); });

}  // namespace
}  // namespace rio::test
