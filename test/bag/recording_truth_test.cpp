// SPDX-License-Identifier: BSD-3-Clause
// Ground truth and barometer of a recording.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "bag/driver_recording.hpp"

namespace rio::bag {
namespace {

class RecordingTruth : public DriverRecording {};

TEST_F(RecordingTruth, PosesAreTheTruthAndPressuresTheBarometer) {
  for (const bool odometry : {false, true}) {
    std::vector<Written> messages;
    int i = 0;
    for (const Written& m : test::at_rest(Wire::kRos1, 10)) {
      messages.push_back(m);
      if (m.topic != "/imu") continue;
      const Time stamp = m.received - Time(250'000'000);
      Wire pose(Wire::kRos1);
      pose.header(stamp, "map");
      if (odometry) pose.text("imu_link");
      for (const double value : {0.01 * i, 2.0, 3.0}) pose.put(value);
      const double half = std::sqrt(0.5);  // a quarter turn about z
      for (const double value : {0.0, 0.0, half, half}) pose.put(value);
      for (int k = 0; odometry && k < 36; ++k) pose.put(0.0);
      for (const double value : {5.0, 0.0, 0.0, 0.0, 0.0, 0.0}) {
        if (odometry) pose.put(value);
      }
      messages.push_back({"/truth", odometry ? kOdometryType : kPoseType, m.received, pose.bytes});
      messages.push_back({"/baro", kPressureType, m.received,
                          Wire(Wire::kRos1).header(stamp, "imu_link").put(1e5 + i).put(0.0).bytes});
      ++i;
    }
    RecordingRequest request;
    EXPECT_TRUE(read(messages).dataset.ground_truth.empty());  // only if it is asked for
    request.truth = true;
    const io::Dataset data = read(messages, request).dataset;
    ASSERT_EQ(data.ground_truth.size(), 100U);
    ASSERT_EQ(data.baro.size(), 100U);
    const NavState& state = data.ground_truth[7];
    EXPECT_EQ(state.time, data.imu[7].time);
    EXPECT_EQ(state.p_WB, Vector3d(0.07, 2.0, 3.0));
    const Vector3d v = odometry ? Vector3d(0.0, 5.0, 0.0) : Vector3d(1.0, 0.0, 0.0);
    EXPECT_LT((state.v_WB - v).norm(), 1e-9) << state.v_WB.transpose();
    EXPECT_EQ(data.baro[7].time, data.imu[7].time);
    EXPECT_EQ(data.baro[7].pressure, 1e5 + 7);
    EXPECT_EQ(read_truth(dir_.path() / "a").size(), 100U);
  }
}

/// at_rest() with a pressure and a pose of `orientation` at each message of the IMU, `by` behind it
/// on their own clock, or without stamps.
std::vector<Written> with_others(std::optional<Time> by, double pressure, double orientation) {
  std::vector<Written> messages;
  for (const Written& m : test::at_rest(Wire::kRos1, 20)) {
    messages.push_back(m);
    if (m.topic != "/imu") continue;
    const Time stamp = by ? m.received - Time(250'000'000) + *by : Time(0);
    Wire pose(Wire::kRos1);
    pose.header(stamp, "map");
    for (const double value : {1.0, 2.0, 3.0, 0.0, 0.0, 0.0, orientation}) pose.put(value);
    messages.push_back({"/truth", kPoseType, m.received, pose.bytes});
    messages.push_back({"/baro", kPressureType, m.received,
                        Wire(Wire::kRos1).header(stamp, "b").put(pressure).put(0.0).bytes});
  }
  return messages;
}

TEST_F(RecordingTruth, TruthAndBarometerOnAnotherClockAreOnThatOfTheImu) {
  RecordingRequest request;
  request.truth = true;
  for (const std::optional<Time> by :
       {std::optional(-1'500'000'000 * kSecond), std::optional<Time>()}) {
    const io::Dataset data = read(with_others(by, 1e5, 1.0), request).dataset;
    ASSERT_EQ(data.ground_truth.size(), 200U);
    ASSERT_EQ(data.baro.size(), 200U);
    EXPECT_LT(std::abs(to_seconds(data.ground_truth[7].time - data.imu[7].time)), 1e-6);
    EXPECT_LT(std::abs(to_seconds(data.baro[7].time - data.imu[7].time)), 1e-6);
  }
}

TEST_F(RecordingTruth, ATruthThatWasAddedLaterKeepsItsHeaders) {
  RecordingRequest request;
  request.truth = true;
  std::vector<Written> messages = with_others(Time(0), 1e5, 1.0);
  std::erase_if(messages, [](const Written& m) { return m.topic == "/truth"; });
  for (const Written& m : with_others(Time(0), 1e5, 1.0)) {  // from 1.2 s on
    if (m.topic != "/truth" || m.received < messages[0].received + 6 * kSecond / 5) continue;
    messages.push_back(m);
    messages.back().received += 1'000'000 * kSecond;
  }
  const io::Dataset data = read(messages, request).dataset;
  EXPECT_EQ(data.ground_truth.at(0).time, data.imu[120].time);
}

TEST_F(RecordingTruth, ATruthOrBarometerThatCannotBeReadIsTold) {
  RecordingRequest request;
  request.truth = true;
  for (const double pressure : {0.0, std::nan("")}) {
    const Recording recording = read(with_others(Time(0), pressure, 0.0), request);
    EXPECT_TRUE(recording.dataset.ground_truth.empty());
    EXPECT_TRUE(recording.dataset.baro.empty());
    for (const char* text : {"/truth: 200 messages cannot be read and are left out; the first one, "
                             "byte 75: no unit quaternion, which a pose needs",
                             "/baro: 200 messages cannot be read and are left out; the first one, "
                             "byte 17: a pressure that is not above zero"}) {
      EXPECT_PRED2(test::contains, notes_of(recording), text);
    }
  }
  EXPECT_ERROR(read_truth(dir_.path() / "a"),
               "no readable message on /truth; the first one, byte 75: no unit quaternion, which a "
               "pose needs");
}

}  // namespace
}  // namespace rio::bag
