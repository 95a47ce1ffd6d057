// SPDX-License-Identifier: BSD-3-Clause
// The barometer of a real recording as an aid: every other sample, judged by the half held back and
// by the sensor set down where it was taken up. Skipped without RIO_TEST_DATA, a folder with
// `ti_demo`.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "experiment/recording.hpp"
#include "rio/aiding.hpp"
#include "rio/io/barometer.hpp"
#include "rio/models/aids.hpp"
#include "support/measured.hpp"
#include "support/real_data.hpp"

namespace rio::test {
namespace {

struct Heights {
  double held_back = 0.0;  ///< RMS against the mean of each second of the held-back samples [m]
  double end = 0.0;        ///< where it was set down, of the start's height [m]
  double nis = 0.0;        ///< a row
  int rows = 0;
};

class Barometer : public testing::TestWithParam<BackEnd> {
 protected:
  static Heights fly(const io::Dataset& data, bool aided) {
    Options options;
    io::apply_sensor_info(data, &options);
    options.backend = GetParam();
    EXPECT_TRUE(options.auxiliary.declare<HeightOffset>());
    const auto odometry = Odometry::create(options);
    const io::BarometricHeights heights = io::barometric_heights(data.baro);
    Heights out;
    std::size_t scan = 0;
    std::size_t height = 0;
    std::uint64_t scans = 0;
    double sum = 0.0;
    double squares = 0.0;
    int count = 0;
    int seconds = 0;
    for (const ImuSample& sample : data.imu) {
      (void)odometry->add_imu(sample);
      for (; height < heights.samples.size() && heights.samples[height].time <= sample.time;
           ++height) {
        const auto& z = heights.samples[height];
        if (height % 2 == 0) {
          if (aided) {
            (void)odometry->add_measurement({z.time, HeightModel{}, {z.height, heights.sigma}});
          }
        } else if (odometry->initialized()) {
          sum += odometry->now().p_WB.z() - z.height;
          if (++count < 25) continue;
          squares += sum * sum / 625.0;
          sum = 0.0;
          count = 0;
          ++seconds;
        }
      }
      for (; scan < data.scans.size() && data.scans[scan].time <= sample.time; ++scan) {
        (void)odometry->add_scan(data.scans[scan]);
      }
      if (odometry->counters().scans == scans) continue;
      scans = odometry->counters().scans;
      const ModelReport& of = odometry->report().models[static_cast<std::size_t>(Model::kAiding)];
      out.nis += of.nis;
      out.rows += of.rows_used;
    }
    out.held_back = std::sqrt(squares / seconds);
    out.end = std::abs(odometry->now().p_WB.z());
    out.nis /= std::max(1, out.rows);
    return out;
  }
};

TEST_P(Barometer, IsAnAid) {
  const std::filesystem::path path = real_data("ti_demo");
  if (path.empty()) GTEST_SKIP() << kNoRealData;
  const experiment::Recording recording = experiment::find_recordings(path).front();
  const Heights alone = fly(recording.data, false);
  const Heights aided = fly(recording.data, true);
  const std::string name = GetParam() == BackEnd::kEkf ? "filter" : "window";
  measured(name + " alone: height against the held-back half [m]", alone.held_back, "");
  measured(name + " with the barometer: same", aided.held_back, "at most alone");
  measured(name + " alone: height at the end [m]", alone.end, "");
  measured(name + " with the barometer: same", aided.end, "");
  measured(name + " with the barometer: NIS a row", aided.nis, "0.8 to 1.2");
  EXPECT_EQ(alone.rows, 0);
  EXPECT_GT(aided.rows, 800);
  EXPECT_LE(aided.held_back, alone.held_back);
  EXPECT_NEAR(aided.nis, 1.0, 0.2);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, Barometer, testing::Values(BackEnd::kEkf, BackEnd::kSmoother),
                         [](const auto& b) {
                           return std::string(b.param == BackEnd::kEkf ? "filter" : "window");
                         });

}  // namespace
}  // namespace rio::test
