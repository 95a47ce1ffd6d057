// SPDX-License-Identifier: BSD-3-Clause
// What drivers and recorders make of a recording: halves of an IMU, other message types, several
// radars, parts of a recording. Each reads as the plain one does.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "bag/driver_recording.hpp"
#include "rio/bag/summary.hpp"

namespace rio::bag {
namespace {

TEST_F(DriverRecording, ACovarianceThatDeniesValuesThatAreThereIsNotBelieved) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 5);
  const io::Dataset good = read(messages);
  for (Written& m : messages) {
    if (m.topic != "/imu") continue;
    const Topic imu{"", kImuType, Encoding::kRos1, ""};
    m.data = imu_message(Wire::kRos1, decode_imu_of(imu, test::bytes_of(m.data)).sample, -1.0);
  }
  const io::Dataset recording = read(messages);
  expect_same(recording, good);
  expect_told(recording, "/imu: 50 messages have values and a covariance of -1");
}

/// at_rest() with the IMU of a camera: rates on one topic, forces at a third of the rate on
/// another, linear in time.
/// @param covariance -1 says that a half is missing (REP 145)
std::vector<Written> halves(double covariance = 0.0) {
  int i = 0;
  const auto half = [&](const Written& m, Time stamp, std::vector<Written>* messages) {
    const ImuSample gyro{stamp, {0.001 * i, 0.2, 0.3}, Vector3d::Zero()};
    const ImuSample accel{stamp, Vector3d::Zero(), {0.01 * i, 0.0, 9.81}};
    messages->push_back({"/gyro", m.type, m.received, imu_message(Wire::kRos1, gyro, covariance)});
    if (i++ % 3 > 0) return;
    messages->push_back(
        {"/accel", m.type, m.received, imu_message(Wire::kRos1, accel, covariance)});
  };
  return replaced(Wire::kRos1, 20, "/imu", half);
}

TEST_F(DriverRecording, HalvesOfAnImuAreOne) {
  for (const char* name : {"", "/accel", "/gyro"}) {
    SCOPED_TRACE(name);
    RecordingRequest request;
    request.imu_topic = name;
    const io::Dataset recording = read(halves(), request);
    const std::vector<ImuSample>& imu = recording.imu;
    ASSERT_EQ(imu.size(), 199U);  // up to the last force
    for (std::size_t i = 0; i < imu.size(); ++i) {
      EXPECT_NEAR(imu[i].gyro_B.x(), 1e-3 * static_cast<double>(i), 1e-12);
      EXPECT_NEAR(imu[i].accel_B.x(), 1e-2 * static_cast<double>(i), 1e-9);
      EXPECT_EQ(imu[i].accel_B.z(), 9.81);
    }
    expect_told(recording, "gyroscope /gyro, accelerometer /accel");
  }
  expect_same(read(halves(-1.0)), read(halves()));
  EXPECT_ERROR(read(without(halves(), "/accel")),
               "/gyro has no accelerometer, and no other topic has it");
}

TEST_F(DriverRecording, AnAccelerometerOnAnotherClockIsOnThatOfTheRecorder) {
  const io::Dataset good = read(halves());
  std::vector<Written> messages = halves();
  for (Written& m : messages) {
    if (m.topic == "/accel") move_header(&m, -1'000'000 * kSecond);
  }
  const io::Dataset recording = read(messages);
  ASSERT_EQ(recording.imu.size(), good.imu.size());
  EXPECT_EQ(recording.imu[20].accel_B, good.imu[20].accel_B);
  expect_told(recording, "clocks of IMU and accelerometer are 1000000.");
}

TEST_F(DriverRecording, ForcesThatAreMissingAreNotMadeUp) {
  const std::vector<ImuSample> imu = read(without(halves(), "/accel", kSecond / 2, kSecond)).imu;
  Time longest{0};
  for (std::size_t i = 1; i < imu.size(); ++i) {
    longest = std::max(longest, imu[i].time - imu[i - 1].time);
  }
  EXPECT_GT(longest, kSecond / 2);
}

TEST_F(DriverRecording, Px4SensorsAreAnImu) {
  const auto px4 = [](const Written& m, Time, std::vector<Written>* messages) {
    Wire wire(Wire::kCdr);
    wire.put(static_cast<std::uint64_t>((m.received.count() - 1'600'000'000'000'000'000) / 1000));
    wire.all({0.5F, 0.25F, -0.125F}).put(std::uint32_t{5000}).put(std::int32_t{0});
    wire.all({1.0F, 2.0F, -9.75F}).put(std::uint32_t{5000}).repeat(2, std::uint8_t{0});
    messages->push_back({"/fmu", kPx4ImuType, m.received, wire.bytes});
  };
  const io::Dataset recording = read_ros2(replaced(Wire::kCdr, 5, "/imu", px4));
  ASSERT_EQ(recording.imu.size(), 50U);
  EXPECT_EQ(recording.imu[3].gyro_B, Vector3d(0.5, -0.25, 0.125));
  EXPECT_EQ(recording.imu[3].accel_B, Vector3d(1.0, -2.0, 9.75));
  expect_told(recording, "/fmu: axes frd, those of PX4, turned");
  for (const Axes axes : {Axes::kFrd, Axes::kFlu}) {  // what is said of them wins
    RecordingRequest request;
    request.imu_axes = axes;
    const io::Dataset said = read_ros2(replaced(Wire::kCdr, 5, "/imu", px4), request);
    EXPECT_EQ(said.imu[3].accel_B, to_flu(axes, Vector3d(1.0, 2.0, -9.75)));
  }
  // both on the clock of the recorder
  const Time apart = recording.scans[1].time - recording.imu[19].time;
  EXPECT_LE(std::abs(apart.count()), 2000);
}

TEST_F(DriverRecording, PointsOfAScanInMessagesOfTheirOwnAreAScan) {
  const io::Dataset good = read(test::at_rest(Wire::kRos1, 10));
  bool counted = true;  // else the driver leaves the number of the point zero
  const auto point_by_point = [&](const Written& m, Time stamp, std::vector<Written>* messages) {
    for (std::uint16_t id = 0; id < 2; ++id) {
      Wire wire(Wire::kRos1);
      wire.header(counted ? stamp + id * Time(20'000) : stamp, "radar");
      wire.put(counted ? id : std::uint16_t{0});
      wire.all({1.5F, 2.5F + id, -0.5F, 3.0F, 0.25F}).put(std::uint16_t{3}).put(10.F).put(12.F);
      messages->push_back({"/scan", kTiScanType, m.received, wire.bytes});
    }
  };
  const io::Dataset recording = read(replaced(Wire::kRos1, 10, "/radar", point_by_point));
  expect_same(recording, good);
  const RadarDetection& d = recording.scans[9].detections.at(1);
  EXPECT_EQ(d.point_S, Vector3d(1.5, 3.5, -0.5));
  EXPECT_EQ(d.range_rate, 0.25);
  EXPECT_EQ(d.snr_db, 12.0);
  counted = false;
  expect_same(read(replaced(Wire::kRos1, 10, "/radar", point_by_point)), good);
  EXPECT_PRED2(test::contains, summary_text(summarise(open_messages(dir_.path() / "a").get())),
               "points preset ti");
}

/// radar_msgs/RadarScan: two returns, to both sides of the x axis.
std::vector<Written> radar_returns(Wire::Kind kind, float azimuth, float range = 2.F) {
  const auto returns = [&](const Written& m, Time stamp, std::vector<Written>* messages) {
    Wire wire(kind);
    wire.header(stamp, "radar").put(std::uint32_t{2});
    for (const float side : {1.F, -1.F}) wire.all({range, side * azimuth, 0.F, 0.75F, 20.F});
    messages->push_back({"/scan", kRadarScanType, m.received, wire.bytes});
  };
  return replaced(kind, 10, "/radar", returns);
}

TEST_F(DriverRecording, RadarReturnsArePoints) {
  for (const Wire::Kind kind : {Wire::kRos1, Wire::kCdr}) {
    const std::vector<Written> messages = radar_returns(kind, std::numbers::pi_v<float> / 6.F);
    const io::Dataset recording = kind == Wire::kCdr ? read_ros2(messages) : read(messages);
    ASSERT_EQ(recording.scans.size(), 10U);
    const RadarDetection& d = recording.scans[3].detections.at(0);
    EXPECT_LT((d.point_S - Vector3d(std::sqrt(3.0), 1.0, 0.0)).norm(), 1e-6);
    EXPECT_EQ(d.range_rate, 0.75);
    EXPECT_EQ(d.snr_db, 20.0);
  }
}

TEST_F(DriverRecording, AnglesInDegreesAreAnError) {
  const std::vector<Written> messages = radar_returns(Wire::kRos1, 30.F);
  EXPECT_ERROR(read(messages),
               "points: angles in degrees: --field azimuth=azimuth*0.0174533 --field "
               "elevation=elevation*0.0174533");
  RecordingRequest request;
  request.points.fields = {{"sigma_azimuth=amplitude", ""}};
  EXPECT_ERROR(read(messages, request), " --field sigma_azimuth=amplitude*0.0174533 (");
  request.points.fields = {{"azimuth=azimuth*0.0174533", ""},
                           {"elevation=elevation*0.0174533", ""}};
  const RadarDetection d = read(messages, request).scans[3].detections.at(0);
  EXPECT_LT((d.point_S - Vector3d(std::sqrt(3.0), 1.0, 0.0)).norm(), 1e-5);
}

TEST_F(DriverRecording, RangesBelowZeroAreAnError) {
  const std::vector<Written> messages = radar_returns(Wire::kRos1, 0.F, -2.F);
  EXPECT_ERROR(read(messages), "points: ranges below zero: --field range=range*-1");
  RecordingRequest request;
  request.points.fields = {{"range=range*-1", ""}};
  EXPECT_EQ(read(messages, request).scans[3].detections.at(0).point_S.x(), 2.0);
}

Written transforms(Time when, const std::vector<Transform>& all) {
  Wire wire(Wire::kRos1);
  wire.put(static_cast<std::uint32_t>(all.size()));
  for (const Transform& t : all) {
    wire.header(when, t.parent).text(t.child);
    wire.all(t.pose.translation).all(t.pose.rotation.coeffs());
  }
  return {"/tf_static", "tf2_msgs/TFMessage", when, wire.bytes};
}

/// at_rest() with a second radar, whose frame is "radar_left"; at_rest() calls those of the first
/// one and of the IMU "radar" and "imu_link".
std::vector<Written> two_radars() {
  return replaced(Wire::kRos1, 10, "/radar", [](Written m, Time, std::vector<Written>* messages) {
    messages->push_back(m);
    m.topic = "/left";
    m.data.replace(m.data.find("radar") - 4, 9, test::block("radar_left"));
    messages->push_back(m);
  });
}

TEST_F(DriverRecording, SeveralRadarsHaveTheirMountingsFromTheTree) {
  const Quaternion quarter(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()));
  std::vector<Written> messages = two_radars();
  EXPECT_ERROR(read(messages),
               "choose with --radar (all at once would need the mounting of each: /radar: there is "
               "no /tf_static); if --sensors has them: --radar TOPIC,TOPIC in its order:");
  const Time when = messages[0].received;
  messages.insert(messages.begin(),
                  transforms(when, {{"base", "imu_link", {quarter, {1.0, 0.0, 0.0}}},
                                    {"base", "radar", {Quaternion::Identity(), {1.0, 2.0, 0.0}}},
                                    {"radar", "radar_left", {quarter, {0.0, 0.0, 3.0}}}}));
  const io::Dataset recording = read(messages);
  ASSERT_EQ(recording.other_radars.size(), 1U);
  EXPECT_EQ(recording.other_radars[0].scans.size(), 10U);
  const Pose& left = *recording.radar_info.T_BS;  // topics in the order of their names
  const Pose& first = *recording.other_radars[0].info.T_BS;
  EXPECT_LT((first.translation - Vector3d(2.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT(first.rotation.angularDistance(quarter.conjugate()), 1e-7);
  EXPECT_LT((left.translation - Vector3d(2.0, 0.0, 3.0)).norm(), 1e-12);
  EXPECT_LT(left.rotation.angularDistance(Quaternion::Identity()), 1e-7);
  EXPECT_TRUE(recording.radar_info.is_from_tree);
  expect_told(recording, "/left: mounting of /tf_static: T_BS: {");

  RecordingRequest request;
  request.radar_topic = "/radar,/left";
  EXPECT_LT((read(messages, request).radar_info.T_BS->translation - first.translation).norm(),
            1e-12);
  request.radar_topic = "/radar";
  EXPECT_TRUE(read(messages, request).other_radars.empty());
  // the frame is that of the points as they are sent: here in axes of the chip
  request.points.axes = "ti";
  const Quaternion turned = read(messages, request).radar_info.T_BS->rotation;
  EXPECT_LT(
      (turned * Vector3d(0.0, 1.0, 0.0) - quarter.conjugate() * Vector3d(-1.0, 0.0, 0.0)).norm(),
      1e-7);
}

TEST_F(DriverRecording, AMountingThatTheTreeDoesNotHaveIsTold) {
  const Pose same{Quaternion::Identity(), Vector3d::Zero()};
  const struct {
    std::vector<Transform> tree;
    const char* said;
    const char* topic = "/tf_static";
  } rows[] = {
      {{}, "no mounting in a recording: radar pose from the options"},
      {{{"base", "imu_link", same}, {"other", "radar", same}},
       "(/tf_static does not connect radar with imu_link)"},
      {{{"radar", "imu_link", same}, {"imu_link", "radar", same}}, "make a loop"},
      {{{"imu_link", "radar", {Quaternion(2.0, 0.0, 0.0, 0.0), Vector3d::Zero()}}},
       "a message of /tf_static cannot be read: "},
      {{{"imu_link", "radar", {Quaternion::Identity(), Vector3d::Constant(std::nan(""))}}},
       "a translation is not finite"},
      {{{"imu_link", "radar", same}},
       "(transforms on /tf are not read: a fixed one belongs on /tf_static)",
       "/tf"},
  };
  for (const auto& [tree, said, topic] : rows) {
    std::vector<Written> messages = test::at_rest(Wire::kRos1, 10);
    messages.insert(messages.begin(), transforms(messages[0].received, tree));
    messages[0].topic = topic;
    const io::Dataset recording = read(messages);
    EXPECT_FALSE(recording.radar_info.T_BS);
    expect_told(recording, said);
  }
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 10);
  for (Written& m : messages) {
    if (m.topic == "/imu") m.data.replace(m.data.find("imu_link") - 4, 12, test::block(""));
  }
  messages.insert(messages.begin(),
                  transforms(messages[0].received, {{"imu_link", "radar", same}}));
  expect_told(read(messages), "(the messages of the IMU have no frame_id)");
}

TEST_F(DriverRecording, CloudsWithoutDopplerAreNoRadar) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 10);
  messages.push_back({"/lidar", "sensor_msgs/PointCloud2", messages.back().received,
                      cloud_message(Wire::kRos1, messages.back().received,
                                    {{"x", 0}, {"y", 4}, {"z", 8}}, {{1, 2, 3}}, 12)});
  EXPECT_EQ(read(messages).scans.size(), 10U);
}

TEST_F(DriverRecording, ARadarThatEndsEarlyIsTold) {
  const io::Dataset recording = read(without(test::at_rest(Wire::kRos1, 40), "/radar", kSecond));
  expect_told(recording, "/radar ends 3.0 s before /imu");
}

}  // namespace
}  // namespace rio::bag
