// SPDX-License-Identifier: BSD-3-Clause
// Real drives of a rough vehicle with sparse radars and lost IMU samples, on a flat floor: no
// option set, static start, both back-ends. Skipped without RIO_TEST_DATA, a folder with `kart`.
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

class Kart : public testing::TestWithParam<Bounds> {
 protected:
  /// Replays it; its errors and its honesty are kept.
  void fly(const experiment::Recording& recording) {
    Options options;
    io::apply_sensor_info(recording.data, &options);
    options.backend = GetParam().backend;
    const experiment::RealScore score =
        experiment::judge(recording, experiment::replay(recording.data, options));
    ASSERT_TRUE(score.started) << recording.name;
    horizontal_.push_back(100.0 * score.horizontal / score.distance);
    height_.push_back(100.0 * score.height / score.distance);
    honest_ = std::min(honest_, 100.0 * score.honest);
  }
  static void expect_below(const std::string& what, double value, double bound) {
    const std::string name = GetParam().name;
    measured(name + ": " + what, value, "below " + std::to_string(bound));
    EXPECT_LT(value, bound) << what;
  }

  const std::filesystem::path folder_ = real_data("kart");
  std::vector<double> horizontal_;  ///< error of each drive [%]
  std::vector<double> height_;      ///< same
  double honest_ = 100.0;           ///< of the worst drive [%]
};

TEST_P(Kart, FindsItsWay) {
  if (folder_.empty()) GTEST_SKIP() << kNoRealData;
  for (const experiment::Recording& recording : experiment::find_recordings(folder_)) {
    ASSERT_TRUE(recording.flat()) << recording.name;
    ASSERT_NO_FATAL_FAILURE(fly(recording));
  }
  expect_below("horizontal, median [%]", median(horizontal_), 2.0);
  expect_below("horizontal, worst [%]", *std::max_element(horizontal_.begin(), horizontal_.end()),
               4.0);
  expect_below("height, median [%]", median(height_), GetParam().height_median);
  expect_below("height, worst [%]", *std::max_element(height_.begin(), height_.end()), 4.0);
  measured(std::string(GetParam().name) + ": height zero within 3 sigmas, worst [%]", honest_,
           "above 95");
  EXPECT_GT(honest_, 95.0);
}

TEST_P(Kart, TwoRadarsOfADriveAreBetterThanOne) {
  if (folder_.empty()) GTEST_SKIP() << kNoRealData;
  const std::vector<experiment::Recording> recordings = experiment::find_recordings(folder_);
  for (std::size_t i = 0; i + 1 < recordings.size(); i += 2) {  // NAME_A, NAME_B
    experiment::Recording both = recordings[i];
    const io::Dataset& other = recordings[i + 1].data;
    both.data.other_radars.push_back({other.scans, other.radar_info});
    ASSERT_NO_FATAL_FAILURE(fly(both));
  }
  // one radar: 1.4 and 0.9 to 1.0
  expect_below("both radars: horizontal, median [%]", median(horizontal_), 1.0);
  expect_below("both radars: height, median [%]", median(height_), 1.4);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Kart,
                         testing::Values(Bounds{BackEnd::kEkf, "filter", 1.2},
                                         Bounds{BackEnd::kSmoother, "window", 1.3}),
                         [](const auto& b) { return std::string(b.param.name); });

}  // namespace
}  // namespace rio::test
