// SPDX-License-Identifier: BSD-3-Clause
#include "rio/propagate/imu_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "support/random_state.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

ImuBuffer empty_buffer(int capacity = 2048) {
  TimingOptions timing;
  timing.imu_buffer = capacity;
  ImuOptions imu;
  imu.max_gap = 0.1;
  return ImuBuffer(timing, imu);
}

std::vector<ImuStep> steps_of(const ImuBuffer& buffer, Time from, Time to) {
  std::vector<ImuStep> steps;
  buffer.for_each_step(from, to, [&steps](const ImuStep& step) { steps.push_back(step); });
  return steps;
}
std::vector<ImuStep> steps_of(const ImuBuffer& buffer, int from_ms, int to_ms) {
  return steps_of(buffer, Time(milliseconds(from_ms)), Time(milliseconds(to_ms)));
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

/// Samples at these milliseconds; 0.1 s is the largest gap.
ImuBuffer buffer_at(std::initializer_list<int> all_ms) {
  ImuBuffer buffer = empty_buffer();
  for (const int ms : all_ms) buffer.push_back(linear_sample(milliseconds(ms)));
  return buffer;
}

/// Off the true readings at a time, which interpolation must meet.
double error_at(double seconds, const Vector3d& gyro_B, const Vector3d& accel_B) {
  return (gyro_B - kGyro - seconds * kGyroSlope).norm() +
         (accel_B - kAccel - seconds * kAccelSlope).norm();
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
  const ImuBuffer buffer = buffer_at({0, 10, 20, 30, 40});
  // a piece of each edge interval and one whole one
  const std::vector<ImuStep> steps = steps_of(buffer, 12, 37);
  ASSERT_EQ(steps.size(), 3U);
  const double middles[] = {0.016, 0.025, 0.0335};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(error_at(middles[i], steps[i].gyro_B, steps[i].accel_B), 1e-14);
    EXPECT_EQ(steps[i].gap, 0.0);
  }
  const std::vector<ImuStep> inside = steps_of(buffer, 22, 24);
  ASSERT_EQ(inside.size(), 1U);
  EXPECT_LT(error_at(0.023, inside[0].gyro_B, inside[0].accel_B), 1e-14);
}

TEST(ImuBuffer, FlagsOnlyTheStepsOfAGap) {
  const ImuBuffer buffer = buffer_at({0, 10, 110, 211, 221});
  const std::vector<ImuStep> steps = steps_of(buffer, 5, 221);
  ASSERT_EQ(steps.size(), 4U);
  EXPECT_EQ(steps[0].gap, 0.0);
  EXPECT_EQ(steps[1].gap, 0.0);  // just max_gap
  EXPECT_GT(steps[2].gap, 0.1);  // 101 ms
  EXPECT_EQ(steps[3].gap, 0.0);
  // a short piece of the gap is still unknown motion
  const std::vector<ImuStep> piece = steps_of(buffer, 150, 160);
  ASSERT_EQ(piece.size(), 1U);
  EXPECT_GT(piece[0].gap, 0.1);
}

TEST(ImuBuffer, HoldsTheFirstSampleBeforeIt) {
  const ImuBuffer buffer = buffer_at({100, 110, 120});
  const std::vector<ImuStep> steps = steps_of(buffer, 70, 115);
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0].begin, milliseconds(70));
  EXPECT_EQ(steps[0].end, milliseconds(100));
  EXPECT_EQ(steps[0].gyro_B, buffer[0].gyro_B);
  EXPECT_EQ(steps[0].accel_B, buffer[0].accel_B);
  EXPECT_EQ(steps[0].gap, 0.0);
  EXPECT_EQ(steps[2].end, milliseconds(115));
  // all of it before the first sample, and farther from it than max_gap, be it a short piece
  for (const int end : {80, -20}) {
    const std::vector<ImuStep> early = steps_of(buffer, -50, end);
    ASSERT_EQ(early.size(), 1U);
    EXPECT_EQ(early[0].end, milliseconds(end));
    EXPECT_GT(early[0].gap, 0.1);
  }
}

TEST(ImuBuffer, NothingToIntegrate) {
  EXPECT_TRUE(steps_of(empty_buffer(), 0, 10).empty());
  const ImuBuffer buffer = buffer_at({5});
  EXPECT_TRUE(steps_of(buffer, 5, 5).empty());
  EXPECT_TRUE(steps_of(buffer, 7, 3).empty());
  EXPECT_TRUE(steps_of(buffer, 5, 9).empty());  // beyond the newest sample nothing is known
  EXPECT_EQ(steps_of(buffer, 2, 9).size(), 1U);
}

TEST(ImuBuffer, AtInterpolatesAndHolds) {
  const ImuBuffer buffer = buffer_at({10, 20, 50});
  for (const int ms :
       {-5, 10, 13, 20, 35, 50, 60}) {  // outside, on a sample, between, at both ends
    const ImuSample sample = buffer.at(milliseconds(ms));
    EXPECT_EQ(sample.time, milliseconds(ms));
    EXPECT_LT(error_at(1e-3 * std::clamp(ms, 10, 50), sample.gyro_B, sample.accel_B), 1e-14) << ms;
  }
}

TEST(ImuBuffer, ForgetBeforeKeepsWhatIntegrationNeeds) {
  for (const int from : {-5, 0, 3, 10, 14, 40, 45}) {
    ImuBuffer buffer = buffer_at({0, 10, 20, 30, 40});
    const std::vector<ImuStep> before = steps_of(buffer, from, 40);
    const ImuSample sample = buffer.at(milliseconds(from));
    buffer.forget_before(milliseconds(from));
    const std::vector<ImuStep> after = steps_of(buffer, from, 40);
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
  EXPECT_EQ(steps_of(buffer, 245, 390).size(), 15U);
  buffer.clear();
  EXPECT_TRUE(buffer.empty());
}

}  // namespace
}  // namespace rio
