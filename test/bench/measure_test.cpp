// SPDX-License-Identifier: BSD-3-Clause
// What `rio bench` measures: the load is as asked for, the figures are those of the options.
#include "bench/measure.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "rio/testing/allocation_guard.hpp"

namespace rio::bench {
namespace {

TEST(Load, HoldsTheDetectionsAskedForAndRepeats) {
  for (const std::size_t wanted : {17U, 30U, 128U, 500U}) {
    const io::Dataset load = make_load(wanted, 6.0);
    std::size_t sum = 0;
    std::size_t flown = 0;
    for (const RadarScan& scan : load.scans) {
      EXPECT_LE(scan.detections.size(), wanted);
      if (to_seconds(scan.time - load.imu.front().time) < 5.0) continue;  // on the ground
      sum += scan.detections.size();
      ++flown;
    }
    EXPECT_GT(static_cast<double>(sum), 0.9 * static_cast<double>(wanted * flown)) << wanted;
  }
  const io::Dataset once = make_load(30, 3.0);
  const io::Dataset twice = make_load(30, 3.0);
  ASSERT_EQ(once.scans.size(), twice.scans.size());
  EXPECT_EQ(once.scans.back().detections.back().point_S,
            twice.scans.back().detections.back().point_S);
}

TEST(Measure, FiguresAreThoseOfTheOptions) {
  const io::Dataset load = make_load(30, 6.0);
  Options options = options_for(load, "default", BackEnd::kEkf);
  options.update.max_landmarks = 5;
  const Figures few = measure(load, options);
  EXPECT_GT(few.updates, 60U);  // 6 s at 15 Hz
  EXPECT_LE(few.landmarks, 5.0);
  EXPECT_GT(few.landmarks, 1.0);
  EXPECT_GT(few.detections, 20.0);
  EXPECT_GT(few.update.median, 0.0);
  EXPECT_LE(few.update.median, few.update.p99);
  EXPECT_GT(few.imu_step, 0.0);
  EXPECT_GT(few.create, 0.0);
  EXPECT_GT(few.real_time, 0.0);
#if defined(__GLIBC__)
  if (test::AllocationGuard::kWorks) {  // else a sanitizer owns malloc, which tells nothing
    EXPECT_GT(few.memory, 100'000U);
    EXPECT_LT(few.memory, 100'000'000U);
  }
#endif
}

TEST(Measure, RefusesWhatCannotBeMeasured) {
  io::Dataset load = make_load(30, 2.0);
  EXPECT_THROW(options_for(load, "none", BackEnd::kEkf), std::runtime_error);
  Options options = options_for(load, "default", BackEnd::kEkf);
  load.scans.clear();
  EXPECT_THROW(measure(load, options), std::runtime_error);
  options.frontend.max_detections = -1;
  EXPECT_THROW(measure(load, options), std::runtime_error);
}

TEST(Growth, DrawsAPanelAnAxisAndACurveAnEstimator) {
  const std::vector<Growth> growths = {{"Detections",
                                        "detections in a scan",
                                        {{"filter", {{17.0, 200.0, 300.0}, {30.0, 250.0, 400.0}}}}},
                                       {"Window",
                                        "states in the window",
                                        {{"smoother", {{3.0, 800.0, 900.0}, {10.0, 950.0, 1e3}}}}}};
  const std::string svg = growth_chart(growths);
  for (const char* text : {"Detections", "states in the window", "filter", "smoother", "[ms]"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace rio::bench
