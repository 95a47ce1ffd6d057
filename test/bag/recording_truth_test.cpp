// SPDX-License-Identifier: BSD-3-Clause
// Ground truth and barometer of a recording: on which clock, and what is none.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "bag/driver_recording.hpp"

namespace rio::bag {
namespace {

class RecordingTruth : public DriverRecording {
 protected:
  RecordingTruth() { with_truth_.truth = true; }
  std::vector<NavState> truth_of(const std::vector<Written>& messages, bool positions = false) {
    return read_truth(dir_.write("a", test::ros1_bag(messages, "none", 20)), positions);
  }
  RecordingRequest with_truth_;
};

/// at_rest() with a pressure and a pose at each message of the IMU, `by` behind it on their own
/// clock, or without stamps; both rise with the number of the message.
std::vector<Written> with_others(std::optional<Time> by = Time(0), double pressure = 1e5,
                                 const Quaternion& q = Quaternion::Identity(),
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
    EXPECT_TRUE(read(messages).ground_truth.empty());  // only if it is asked for
    const io::Dataset data = read(messages, with_truth_);
    ASSERT_EQ(data.ground_truth.size(), 200U);
    ASSERT_EQ(data.baro.size(), 200U);
    const NavState& state = data.ground_truth[7];
    EXPECT_EQ(state.time, data.imu[7].time);
    EXPECT_EQ(state.p_WB, Vector3d(0.07, 2.0, 3.0));
    const Vector3d v = odometry ? Vector3d(0.0, 5.0, 0.0) : Vector3d(1.0, 0.0, 0.0);
    EXPECT_LT((state.v_WB - v).norm(), 1e-9) << state.v_WB.transpose();
    EXPECT_EQ(data.baro[7].time, data.imu[7].time);
    EXPECT_NEAR(data.baro[7].pressure, 1e5 + 7, 1e-9);
    EXPECT_EQ(truth_of(messages).size(), 200U);
  }
}

TEST_F(RecordingTruth, TruthAndBarometerOnAnotherClockAreOnThatOfTheImu) {
  for (const std::optional<Time> by :
       {std::optional(-1'500'000'000 * kSecond), std::optional<Time>()}) {
    const io::Dataset data = read(with_others(by), with_truth_);
    ASSERT_EQ(data.ground_truth.size(), 200U);
    ASSERT_EQ(data.baro.size(), 200U);
    EXPECT_LT(std::abs(to_seconds(data.ground_truth[7].time - data.imu[7].time)), 1e-6);
    EXPECT_LT(std::abs(to_seconds(data.baro[7].time - data.imu[7].time)), 1e-6);
  }
}

TEST_F(RecordingTruth, ATruthThatWasAddedLaterKeepsItsHeaders) {
  std::vector<Written> messages = without(with_others(), "/truth");
  for (const Written& m : with_others()) {  // from 1.2 s on
    if (m.topic != "/truth" || m.received < messages[0].received + 6 * kSecond / 5) continue;
    messages.push_back(m);
    messages.back().received += 1'000'000 * kSecond;
  }
  const io::Dataset data = read(messages, with_truth_);
  EXPECT_EQ(data.ground_truth.at(0).time, data.imu[120].time);
}

TEST_F(RecordingTruth, WithoutAFlightItIsReadAlone) {
  std::vector<Written> messages = with_others();
  std::erase_if(messages, [](const Written& m) { return m.topic != "/truth"; });
  EXPECT_EQ(truth_of(messages).at(7).time, kBegin + Time(70'000'000));
  std::vector<Written> twice = messages;  // the same poses on two topics
  for (const Written& m : messages) twice.emplace_back(m).topic = "/again";
  EXPECT_EQ(truth_of(twice).size(), truth_of(messages).size());
  messages.push_back(messages[0]);
  messages.back().topic = "/other";
  EXPECT_ERROR(
      truth_of(messages),
      "a: several topics with poses, /truth and /other; choose with --truth-topic, or --topic");
  EXPECT_EQ(read_truth(dir_.path() / "a", false, "/other").size(), 1U);
  EXPECT_ERROR(read_truth(dir_.path() / "a", false, "/none"), "a: no topic /none of type ");
  EXPECT_ERROR(truth_of(test::at_rest(Wire::kRos1, 2)),
               "a: no topic of type geometry_msgs/PoseStamped or nav_msgs/Odometry");
}

TEST_F(RecordingTruth, ATruthOrBarometerThatCannotBeReadIsTold) {
  for (const double pressure : {0.0, std::nan("")}) {
    const io::Dataset recording =
        read(with_others(Time(0), pressure, Quaternion(0.0, 0.0, 0.0, 0.0)), with_truth_);
    EXPECT_TRUE(recording.ground_truth.empty());
    EXPECT_TRUE(recording.baro.empty());
    for (const char* text : {"/truth: 200 messages cannot be read and are left out; the first one, "
                             "byte 75: no unit quaternion, which a pose needs",
                             "/baro: 200 messages cannot be read and are left out; the first one, "
                             "byte 24: a pressure that is not above zero"}) {
      expect_told(recording, text);
    }
  }
  EXPECT_ERROR(read_truth(dir_.path() / "a"),
               "no readable message on /truth; the first one, byte 75: no unit quaternion, which a "
               "pose needs");
}

/// Position of a point above the ellipsoid WGS 84 in the axes of the earth [m]; angles in degrees.
Vector3d earth_fixed(double latitude, double longitude, double altitude) {
  constexpr double kEquator = 6378137.0;
  constexpr double kPole = 6356752.314245;
  const double phi = latitude * std::numbers::pi / 180.0;
  const double lambda = longitude * std::numbers::pi / 180.0;
  const double across = kEquator * kEquator * std::cos(phi);
  const double along = kPole * kPole * std::sin(phi);
  const double n = std::hypot(kEquator * std::cos(phi), kPole * std::sin(phi));
  const Vector3d on_equator(std::cos(lambda), std::sin(lambda), 0.0);
  const Vector3d normal = std::cos(phi) * on_equator + std::sin(phi) * Vector3d::UnitZ();
  return across / n * on_equator + along / n * Vector3d::UnitZ() + altitude * normal;
}

/// The same in east, north and up of another such point.
Vector3d local(const Vector3d& of, const Vector3d& first) {
  const double phi = first[0] * std::numbers::pi / 180.0;
  const double lambda = first[1] * std::numbers::pi / 180.0;
  const Matrix3d to_earth =
      (Eigen::AngleAxisd(lambda, Vector3d::UnitZ()) * Eigen::AngleAxisd(-phi, Vector3d::UnitY()))
          .toRotationMatrix();  // up, east, north
  const Vector3d there = to_earth.transpose() * (earth_fixed(of[0], of[1], of[2]) -
                                                 earth_fixed(first[0], first[1], first[2]));
  return {there[1], there[2], there[0]};
}

Written fix(int i, const Vector3d& place, bool valid = true) {
  const Time stamp = kBegin + i * kSecond;
  Wire message(Wire::kRos1);
  message.header(stamp, "gnss");
  message.put(static_cast<std::int8_t>(valid ? 0 : -1)).put(std::uint16_t{1}).all(place);
  message.repeat(9, 0.0).put(std::uint8_t{0});
  return {"/fix", kFixType, stamp, message.bytes};
}

TEST_F(RecordingTruth, FixesOfGnssAreEastNorthAndUpOfTheFirst) {
  for (const Vector3d& first : {Vector3d(48.2, 16.4, 170.0), Vector3d(-33.9, 179.9999, 20.0)}) {
    const Vector3d near = first + Vector3d(9e-4, 9e-4, 12.0);
    const Vector3d far = first + Vector3d(-5e-3, 9e-3, -40.0);
    Vector3d beyond = near;  // the date line
    if (beyond[1] > 180.0) beyond[1] -= 360.0;
    const std::vector<NavState> truth =
        truth_of({fix(0, near, false), fix(1, first), fix(2, beyond), fix(3, far)}, true);
    ASSERT_EQ(truth.size(), 3U);  // the one that is none is left out
    EXPECT_EQ(truth[0].time, kBegin + kSecond);
    EXPECT_EQ(truth[0].p_WB, Vector3d::Zero());
    EXPECT_TRUE(truth[0].q_WB.coeffs().array().isNaN().all());
    EXPECT_LT((truth[1].p_WB - local(near, first)).norm(), 2e-3) << local(near, first).transpose();
    EXPECT_LT((truth[2].p_WB - local(far, first)).norm(), 0.2) << local(far, first).transpose();
  }
}

TEST_F(RecordingTruth, PositionsAreReadWhereTheyWillDoAndThereIsNoPose) {
  int i = 0;
  const auto beside = [&](const Written& m, Time of_imu, std::vector<Written>* messages) {
    Wire point(Wire::kRos1);
    point.header(of_imu, "station").all({0.01 * i++, 2.0, 3.0});
    messages->push_back(m);
    messages->push_back({"/prism", kPointType, m.received, point.bytes});
  };
  std::vector<Written> messages = replaced(Wire::kRos1, 20, "/imu", beside);
  const std::vector<NavState> truth = truth_of(messages, true);
  ASSERT_EQ(truth.size(), 200U);
  EXPECT_EQ(truth[7].p_WB, Vector3d(0.07, 2.0, 3.0));
  EXPECT_TRUE(truth[7].q_WB.coeffs().array().isNaN().all());
  EXPECT_ERROR(truth_of(messages), "a: no topic of type geometry_msgs/PoseStamped");
  EXPECT_TRUE(read(messages, with_truth_).ground_truth.empty());  // a start needs an attitude
  messages.push_back(fix(0, Vector3d(48.2, 16.4, 170.0)));
  EXPECT_ERROR(truth_of(messages, true), "several topics with positions, ");
  EXPECT_TRUE(truth_of(with_others(), true).at(0).q_WB.coeffs().allFinite());
}

}  // namespace
}  // namespace rio::bag
