// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_buffer.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "rio/propagate/strapdown.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

ImuBuffer empty_buffer(int capacity = 2048, double max_gap = 0.1) {
  TimingOptions timing;
  timing.imu_buffer = capacity;
  ImuOptions imu;
  imu.max_gap = max_gap;
  return ImuBuffer(timing, imu);
}

std::vector<ImuStep> steps_of(const ImuBuffer& buffer, Time from, Time to) {
  std::vector<ImuStep> steps;
  buffer.for_each_step(from, to, [&steps](const ImuStep& step) { steps.push_back(step); });
  return steps;
}

// Rates and specific forces linear in time: interpolation between samples is exact.
const Vector3d kGyro(0.4, -0.9, 0.7);
const Vector3d kGyroSlope(0.8, 0.5, -1.1);
const Vector3d kAccel(1.0, -2.0, 9.5);
const Vector3d kAccelSlope(-3.0, 2.0, 1.5);

ImuSample linear_sample(Time time) {
  const double t = to_seconds(time);
  return {time, kGyro + t * kGyroSlope, kAccel + t * kAccelSlope};
}

TEST(ImuBuffer, StepsTileTheIntervalToTheNanosecond) {
  test::Random random(1);
  for (int run = 0; run < 200; ++run) {
    ImuBuffer buffer = empty_buffer();
    Time time = from_seconds(random.uniform(-2.0, 2.0)) + Time(1'700'000'000'000'000'000);
    const Time first = time;
    for (int i = 0; i < 30; ++i) {
      buffer.push_back({time, random.normal_vector(), random.normal_vector()});
      time += Time(1 + static_cast<Time::rep>(random.index(9'000'000)));
    }
    const auto span = static_cast<std::size_t>((buffer.newest().time - first).count());
    Time from = first + Time(static_cast<Time::rep>(random.index(span)));
    Time to = first + Time(static_cast<Time::rep>(random.index(span)));
    if (run % 4 == 0) from = buffer[random.index(buffer.size())].time;
    if (run % 3 == 0) to = buffer[random.index(buffer.size())].time;
    if (from > to) std::swap(from, to);
    const std::vector<ImuStep> steps = steps_of(buffer, from, to);
    EXPECT_EQ(steps.empty(), from == to);
    Time end = from;
    for (const ImuStep& step : steps) {
      EXPECT_EQ(step.begin, end);
      EXPECT_LT(step.begin, step.end);
      end = step.end;
    }
    EXPECT_EQ(end, to);
  }
}

TEST(ImuBuffer, EdgesAreInterpolated) {
  ImuBuffer buffer = empty_buffer();
  for (int i = 0; i < 5; ++i) buffer.push_back(linear_sample(milliseconds(10 * i)));
  // from 12 ms to 37 ms: a piece of each edge interval and one whole one
  const std::vector<ImuStep> steps = steps_of(buffer, milliseconds(12), milliseconds(37));
  ASSERT_EQ(steps.size(), 3U);
  const double middles[] = {0.016, 0.025, 0.0335};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR((steps[i].gyro_B - kGyro - middles[i] * kGyroSlope).norm(), 0.0, 1e-14);
    EXPECT_NEAR((steps[i].accel_B - kAccel - middles[i] * kAccelSlope).norm(), 0.0, 1e-14);
    EXPECT_EQ(steps[i].gap, 0.0);
  }
  // both ends inside one interval
  const std::vector<ImuStep> inside = steps_of(buffer, milliseconds(22), milliseconds(24));
  ASSERT_EQ(inside.size(), 1U);
  EXPECT_NEAR((inside[0].gyro_B - kGyro - 0.023 * kGyroSlope).norm(), 0.0, 1e-14);
}

TEST(ImuBuffer, FlagsOnlyTheStepsOfAGap) {
  ImuBuffer buffer = empty_buffer(64, 0.1);
  for (const int ms : {0, 10, 110, 211, 221}) buffer.push_back(linear_sample(milliseconds(ms)));
  const std::vector<ImuStep> steps = steps_of(buffer, milliseconds(5), milliseconds(221));
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps[0].gap, 0.0);
  EXPECT_EQ(steps[1].gap, 0.0);  // just max_gap
  EXPECT_GT(steps[2].gap, 0.1);  // 101 ms
  EXPECT_EQ(steps[3].gap, 0.0);
  // a short piece of the gap is still unknown motion
  const std::vector<ImuStep> piece = steps_of(buffer, milliseconds(150), milliseconds(160));
  ASSERT_EQ(piece.size(), 1U);
  EXPECT_GT(piece[0].gap, 0.1);
}

TEST(ImuBuffer, HoldsTheFirstSampleBeforeIt) {
  ImuBuffer buffer = empty_buffer(64, 0.1);
  for (const int ms : {100, 110, 120}) buffer.push_back(linear_sample(milliseconds(ms)));
  const std::vector<ImuStep> steps = steps_of(buffer, milliseconds(70), milliseconds(115));
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0].begin, milliseconds(70));
  EXPECT_EQ(steps[0].end, milliseconds(100));
  EXPECT_EQ(steps[0].gyro_B, buffer[0].gyro_B);
  EXPECT_EQ(steps[0].accel_B, buffer[0].accel_B);
  EXPECT_EQ(steps[0].gap, 0.0);
  EXPECT_EQ(steps[2].end, milliseconds(115));
  // all of it before the first sample, and farther from it than max_gap
  const std::vector<ImuStep> early = steps_of(buffer, milliseconds(-50), milliseconds(80));
  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0].end, milliseconds(80));
  EXPECT_GT(early[0].gap, 0.1);
  // a short piece of a long hold is still unknown motion
  const std::vector<ImuStep> piece = steps_of(buffer, milliseconds(-50), milliseconds(-20));
  ASSERT_EQ(piece.size(), 1U);
  EXPECT_GT(piece[0].gap, 0.1);
}

TEST(ImuBuffer, NothingToIntegrate) {
  ImuBuffer buffer = empty_buffer();
  EXPECT_TRUE(steps_of(buffer, Time{0}, milliseconds(10)).empty());
  buffer.push_back(linear_sample(milliseconds(5)));
  EXPECT_TRUE(steps_of(buffer, milliseconds(5), milliseconds(5)).empty());
  EXPECT_TRUE(steps_of(buffer, milliseconds(7), milliseconds(3)).empty());
  // beyond the newest sample nothing is known
  EXPECT_TRUE(steps_of(buffer, milliseconds(5), milliseconds(9)).empty());
  EXPECT_EQ(steps_of(buffer, milliseconds(2), milliseconds(9)).size(), 1U);
}

TEST(ImuBuffer, AtInterpolatesAndHolds) {
  ImuBuffer buffer = empty_buffer();
  for (const int ms : {10, 20, 50}) buffer.push_back(linear_sample(milliseconds(ms)));
  for (const int ms : {10, 13, 20, 35, 50}) {  // on a sample, between, at both ends
    const ImuSample sample = buffer.at(milliseconds(ms));
    EXPECT_EQ(sample.time, milliseconds(ms));
    EXPECT_NEAR((sample.gyro_B - linear_sample(milliseconds(ms)).gyro_B).norm(), 0.0, 1e-14) << ms;
    EXPECT_NEAR((sample.accel_B - linear_sample(milliseconds(ms)).accel_B).norm(), 0.0, 1e-14)
        << ms;
  }
  EXPECT_EQ(buffer.at(milliseconds(-5)).time, milliseconds(-5));
  EXPECT_EQ(buffer.at(milliseconds(-5)).gyro_B, buffer[0].gyro_B);
  EXPECT_EQ(buffer.at(milliseconds(60)).time, milliseconds(60));
  EXPECT_EQ(buffer.at(milliseconds(60)).accel_B, buffer.newest().accel_B);
}

TEST(ImuBuffer, ForgetBeforeKeepsWhatIntegrationNeeds) {
  for (const int from : {-5, 0, 3, 10, 14, 40, 45}) {
    ImuBuffer buffer = empty_buffer();
    for (int i = 0; i < 5; ++i) buffer.push_back(linear_sample(milliseconds(10 * i)));
    const std::vector<ImuStep> before = steps_of(buffer, milliseconds(from), milliseconds(40));
    const ImuSample sample = buffer.at(milliseconds(from));
    buffer.forget_before(milliseconds(from));
    const std::vector<ImuStep> after = steps_of(buffer, milliseconds(from), milliseconds(40));
    ASSERT_EQ(after.size(), before.size()) << from;
    for (std::size_t i = 0; i < after.size(); ++i) {
      EXPECT_EQ(after[i].end, before[i].end);
      EXPECT_EQ(after[i].gyro_B, before[i].gyro_B);
    }
    EXPECT_EQ(buffer.at(milliseconds(from)).gyro_B, sample.gyro_B) << from;
    // no more than one sample at or before the time
    EXPECT_TRUE(buffer.size() == 1 || buffer[1].time > milliseconds(from)) << from;
  }
}

TEST(ImuBuffer, DropsTheOldestWhenFull) {
  ImuBuffer buffer = empty_buffer(16);
  EXPECT_TRUE(buffer.empty());
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(buffer.full(), i >= 16);
    buffer.push_back(linear_sample(milliseconds(10 * i)));
  }
  EXPECT_EQ(buffer.size(), 16U);
  EXPECT_EQ(buffer[0].time, milliseconds(240));
  EXPECT_EQ(steps_of(buffer, milliseconds(245), milliseconds(390)).size(), 15U);
  buffer.clear();
  EXPECT_TRUE(buffer.empty());
}

// Difference between integrating five sample intervals at once and cut inside the third.
double split_error(Time interval) {
  ImuBuffer buffer = empty_buffer();
  for (Time t{0}; t <= milliseconds(160); t += interval) buffer.push_back(linear_sample(t));
  test::Random random(3);
  NavState once = random.state();
  once.time = Time{0};
  NavState split = once;
  const auto run = [&buffer](Time to, NavState& x) {
    buffer.for_each_step(x.time, to, [&x](const ImuStep& step) { integrate(step, 9.81, x); });
  };
  run(5 * interval, once);
  run(2 * interval + interval / 3, split);
  run(5 * interval, split);
  EXPECT_EQ(split.time, once.time);
  return test::error_of(split, once).norm();
}

TEST(ImuBuffer, SplittingAnIntervalChangesOnlyThirdOrderTerms) {
  const double coarse = split_error(milliseconds(32));
  const double middle = split_error(milliseconds(16));
  const double fine = split_error(milliseconds(8));
  // slopes of 4 m/s^3 over 32 ms: 4 * 0.032^3 = 1.3e-4
  EXPECT_LT(coarse, 1.3e-4);
  EXPECT_GT(fine, 1e-9);
  EXPECT_NEAR(coarse / middle, 8.0, 1.0);
  EXPECT_NEAR(middle / fine, 8.0, 1.0);
}

}  // namespace
}  // namespace rio
