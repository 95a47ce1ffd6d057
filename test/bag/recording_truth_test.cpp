// SPDX-License-Identifier: BSD-3-Clause
// Ground truth and barometer of a recording.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "bag/driver_recording.hpp"

namespace rio::bag {
namespace {

class RecordingTruth : public DriverRecording {};

/// at_rest() with a pressure and a pose at each message of the IMU, `by` behind it on their own
/// clock, or without stamps; both rise with the number of the message.
std::vector<Written> with_others(std::optional<Time> by, double pressure, const Quaternion& q,
                                 bool odometry = false) {
  int i = 0;
  const auto more = [&](const Written& m, Time of_imu, std::vector<Written>* messages) {
    messages->push_back(m);
    const Time stamp = by ? of_imu + *by : Time(0);
    Wire pose(Wire::kRos1);
    pose.header(stamp, "map");
    if (odometry) pose.text("imu_link");
    pose.all({0.01 * i, 2.0, 3.0}).all(q.coeffs());
    if (odometry) pose.repeat(36, 0.0).put(5.0).repeat(5 + 36, 0.0);
    messages->push_back({"/truth", odometry ? kOdometryType : kPoseType, m.received, pose.bytes});
    messages->push_back({"/baro", kPressureType, m.received,
                         pressure_message(Wire::kRos1, stamp, pressure * (1.0 + 1e-5 * i++))});
  };
  return replaced(Wire::kRos1, 20, "/imu", more);
}

TEST_F(RecordingTruth, PosesAreTheTruthAndPressuresTheBarometer) {
  const Quaternion quarter(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()));
  for (const bool odometry : {false, true}) {
    const std::vector<Written> messages = with_others(Time(0), 1e5, quarter, odometry);
    RecordingRequest request;
    EXPECT_TRUE(read(messages).dataset.ground_truth.empty());  // only if it is asked for
    request.truth = true;
    const io::Dataset data = read(messages, request).dataset;
    ASSERT_EQ(data.ground_truth.size(), 200U);
    ASSERT_EQ(data.baro.size(), 200U);
    const NavState& state = data.ground_truth[7];
    EXPECT_EQ(state.time, data.imu[7].time);
    EXPECT_EQ(state.p_WB, Vector3d(0.07, 2.0, 3.0));
    const Vector3d v = odometry ? Vector3d(0.0, 5.0, 0.0) : Vector3d(1.0, 0.0, 0.0);
    EXPECT_LT((state.v_WB - v).norm(), 1e-9) << state.v_WB.transpose();
    EXPECT_EQ(data.baro[7].time, data.imu[7].time);
    EXPECT_NEAR(data.baro[7].pressure, 1e5 + 7, 1e-9);
    EXPECT_EQ(read_truth(dir_.path() / "a").size(), 200U);
  }
}

TEST_F(RecordingTruth, TruthAndBarometerOnAnotherClockAreOnThatOfTheImu) {
  RecordingRequest request;
  request.truth = true;
  for (const std::optional<Time> by :
       {std::optional(-1'500'000'000 * kSecond), std::optional<Time>()}) {
    const io::Dataset data = read(with_others(by, 1e5, Quaternion::Identity()), request).dataset;
    ASSERT_EQ(data.ground_truth.size(), 200U);
    ASSERT_EQ(data.baro.size(), 200U);
    EXPECT_LT(std::abs(to_seconds(data.ground_truth[7].time - data.imu[7].time)), 1e-6);
    EXPECT_LT(std::abs(to_seconds(data.baro[7].time - data.imu[7].time)), 1e-6);
  }
}

TEST_F(RecordingTruth, ATruthThatWasAddedLaterKeepsItsHeaders) {
  RecordingRequest request;
  request.truth = true;
  std::vector<Written> messages = with_others(Time(0), 1e5, Quaternion::Identity());
  std::erase_if(messages, [](const Written& m) { return m.topic == "/truth"; });
  for (const Written& m : with_others(Time(0), 1e5, Quaternion::Identity())) {  // from 1.2 s on
    if (m.topic != "/truth" || m.received < messages[0].received + 6 * kSecond / 5) continue;
    messages.push_back(m);
    messages.back().received += 1'000'000 * kSecond;
  }
  const io::Dataset data = read(messages, request).dataset;
  EXPECT_EQ(data.ground_truth.at(0).time, data.imu[120].time);
}

TEST_F(RecordingTruth, WithoutAFlightItIsReadAlone) {
  const auto truth_of = [this](const std::vector<Written>& messages) {
    return read_truth(dir_.write("a", test::ros1_bag(messages, "none", 20)));
  };
  std::vector<Written> messages = with_others(Time(0), 1e5, Quaternion::Identity());
  std::erase_if(messages, [](const Written& m) { return m.topic != "/truth"; });
  EXPECT_EQ(truth_of(messages).at(7).time, kBegin + Time(70'000'000));
  messages.push_back(messages[0]);
  messages.back().topic = "/other";
  EXPECT_ERROR(truth_of(messages), "a: several topics with poses, /truth and /other");
  EXPECT_ERROR(truth_of(test::at_rest(Wire::kRos1, 2)),
               "a: no topic of type geometry_msgs/PoseStamped or nav_msgs/Odometry");
}

TEST_F(RecordingTruth, ATruthOrBarometerThatCannotBeReadIsTold) {
  RecordingRequest request;
  request.truth = true;
  for (const double pressure : {0.0, std::nan("")}) {
    const Recording recording =
        read(with_others(Time(0), pressure, Quaternion(0.0, 0.0, 0.0, 0.0)), request);
    EXPECT_TRUE(recording.dataset.ground_truth.empty());
    EXPECT_TRUE(recording.dataset.baro.empty());
    for (const char* text : {"/truth: 200 messages cannot be read and are left out; the first one, "
                             "byte 75: no unit quaternion, which a pose needs",
                             "/baro: 200 messages cannot be read and are left out; the first one, "
                             "byte 24: a pressure that is not above zero"}) {
      EXPECT_PRED2(test::contains, notes_of(recording), text);
    }
  }
  EXPECT_ERROR(read_truth(dir_.path() / "a"),
               "no readable message on /truth; the first one, byte 75: no unit quaternion, which a "
               "pose needs");
}

}  // namespace
}  // namespace rio::bag
