// SPDX-License-Identifier: BSD-3-Clause
// What drivers and recorders make of a recording: clocks that jump, halves of an IMU, other message
// types, several radars, parts of a recording, compression. Each reads as the plain one does.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <optional>

#include "bag/bag_writer.hpp"
#include "rio/bag/recording.hpp"
#include "rio/bag/summary.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

using test::TempDir;
using test::Wire;
using test::Written;

constexpr Time kSecond(1'000'000'000);

std::string notes_of(const Recording& recording) {
  std::string text;
  for (const std::string& note : recording.dataset.notes) text += note + "\n";
  return text;
}

class DriverRecording : public testing::Test {
 protected:
  Recording read(const std::vector<Written>& messages, const RecordingRequest& request = {}) {
    return read_recording(dir_.write("a", test::ros1_bag(messages, "none", 20)), request);
  }
  Recording read_ros2(const std::vector<Written>& messages, const RecordingRequest& request = {}) {
    return read_recording(dir_.write("a", test::mcap(messages, "none", 20)), request);
  }
  /// Stamps, to `tolerance`, and detections.
  static void expect_same(const io::Dataset& a, const io::Dataset& b, Time tolerance = Time(0)) {
    ASSERT_EQ(a.imu.size(), b.imu.size());
    ASSERT_EQ(a.scans.size(), b.scans.size());
    for (std::size_t i = 0; i < a.imu.size(); ++i) {
      EXPECT_LE(std::abs((a.imu[i].time - b.imu[i].time).count()), tolerance.count()) << i;
    }
    for (std::size_t i = 0; i < a.scans.size(); ++i) {
      EXPECT_LE(std::abs((a.scans[i].time - b.scans[i].time).count()), tolerance.count()) << i;
      EXPECT_EQ(a.scans[i].detections.size(), b.scans[i].detections.size()) << i;
    }
  }

  TempDir dir_;
};

/// Of a message of ROS 1: sequence number, seconds, nanoseconds.
void set_header(Written* message, Time stamp) {
  const std::string header = Wire(Wire::kRos1).header(stamp, "").bytes;
  message->data.replace(4, 8, header.substr(4, 8));
}
void move_header(Written* message, Time by) {
  std::array<std::uint32_t, 2> stamp{};
  std::memcpy(stamp.data(), message->data.data() + 4, 8);
  set_header(message, stamp[0] * kSecond + Time(stamp[1]) + by);
}

/// at_rest() whose clocks jump after half of the messages.
/// @param of "imu", "radar" or both
std::vector<Written> jumping(const std::string& of, Time headers, Time received) {
  std::vector<Written> messages;
  const std::vector<Written> good = test::at_rest(Wire::kRos1, 40);
  for (std::size_t i = 0; i < good.size(); ++i) {
    const bool late = i >= good.size() / 2;
    const bool is_imu = good[i].topic == "/imu";
    const bool jumps = late && (of == "both" || of == (is_imu ? "imu" : "radar"));
    Written m = good[i];
    if (late) m.received += received;
    if (jumps) move_header(&m, headers);
    messages.push_back(m);
  }
  return messages;
}

TEST_F(DriverRecording, AClockThatJumpsGoesOnAsTheMessagesWereReceived) {
  const Recording good = read(test::at_rest(Wire::kRos1, 40));
  for (const char* of : {"both", "imu", "radar"}) {
    for (const Time jump :
         {-9 * kSecond, 9 * kSecond, -1'599'999'000 * kSecond, -kSecond / 5, -kSecond / 10}) {
      const Recording recording = read(jumping(of, jump, Time(0)));
      expect_same(recording.dataset, good.dataset);
      EXPECT_PRED2(test::contains, notes_of(recording), "the header clock jumps by ");
    }
  }
  // the clock of the recorder with them: the interval at the step is that of the IMU before
  const Recording back = read(jumping("both", -10 * kSecond, -10 * kSecond));
  expect_same(back.dataset, good.dataset);
  for (const Time step : {-kSecond / 5, -kSecond / 10}) {  // NTP
    const Recording set = read(jumping("both", step, step));
    expect_same(set.dataset, good.dataset);
  }
  const auto path =
      dir_.write("b", test::ros1_bag(jumping("both", -10 * kSecond, -10 * kSecond), "none", 20));
  EXPECT_PRED2(test::contains, summary_text(summarise(open_messages(path).get())), "  100.00 Hz");
}

TEST_F(DriverRecording, MessagesThatAreSwappedOrStampedLateAreNoJump) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
  std::vector<std::size_t> scans;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (messages[i].topic == "/radar") scans.push_back(i);
  }
  for (const std::size_t k : {3U, 9U, 20U, 30U}) {  // swapped by a queue, and stamped 80 ms early
    std::swap(messages[scans[k]].data, messages[scans[k + 1]].data);
    std::swap(messages[scans[k]].received, messages[scans[k] + 7].received);
    move_header(&messages[scans[k + 4]], -kSecond / 12);
    move_header(&messages[scans[k] + 3], -kSecond / 12);
  }
  const Recording recording = read(messages);
  EXPECT_EQ(notes_of(recording).find("jumps"), std::string::npos) << notes_of(recording);
}

TEST_F(DriverRecording, AClockSetForwardOrAPauseIsTold) {
  const std::string notes = notes_of(read(jumping("both", 5 * kSecond, 5 * kSecond)));
  EXPECT_PRED2(test::contains, notes,
               "clock set forward by 5.0 s, or the recorder paused, 2.0 s after the begin: the "
               "flight behind needs a recording of its own");
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
  std::erase_if(messages, [&](const Written& m) {  // of the IMU alone
    const Time at = m.received - messages[0].received;
    return m.topic == "/imu" && at > kSecond && at < 2 * kSecond;
  });
  EXPECT_EQ(notes_of(read(messages)).find("set forward"), std::string::npos);
}

/// at_rest() of 16 s; the messages of a topic are late by what `late` says of the time so far.
std::vector<Written> arriving(const std::string& topic, const std::function<Time(Time)>& late) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 160);
  const Time begin = messages[0].received;
  for (Written& m : messages) {
    if (m.topic == topic || topic.empty()) m.received += late(m.received - begin);
  }
  return messages;
}

TEST_F(DriverRecording, ATopicThatArrivesLateIsOnItsClock) {
  const Recording good = read(test::at_rest(Wire::kRos1, 160));
  const auto growing = [](Time at) { return at / 5; };
  const auto drained = [](Time at) { return at < 9 * kSecond ? 3 * kSecond / 2 : Time(0); };
  const auto slow = [](Time at) { return 9 * at; };
  for (const std::string topic : {"/radar", "/imu"}) {
    expect_same(read(arriving(topic, growing)).dataset, good.dataset);
    expect_same(read(arriving(topic, drained)).dataset, good.dataset);
  }
  std::vector<Written> played = arriving("", slow);  // at a tenth of the speed, recorded again
  std::erase_if(played, [&](const Written& m) {      // a radar that begins later
    return m.topic == "/radar" && m.received < played[0].received + 7 * kSecond;
  });
  EXPECT_EQ(read(played).dataset.scans[0].time, good.dataset.scans[7].time);

  std::vector<Written> apart = test::at_rest(Wire::kRos1, 40);
  for (Written& m : apart) {
    if (m.topic == "/radar") move_header(&m, -5 * kSecond);
  }
  EXPECT_PRED2(test::contains, notes_of(read(apart)),
               "5.000 s apart; if one only arrives late: --imu-clock header --radar-clock header");
}

TEST_F(DriverRecording, OneCorruptStampIsNoJump) {
  for (const std::size_t place : {std::size_t{0}, std::size_t{57}}) {
    std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
    messages[place].data[5] = static_cast<char>(messages[place].data[5] ^ 0x10);
    const Recording good = read(test::at_rest(Wire::kRos1, 40));
    const Recording recording = read(messages);
    EXPECT_EQ(notes_of(recording).find("jumps"), std::string::npos) << notes_of(recording);
    EXPECT_NE(recording.dataset.imu[place - place / 11].time,
              good.dataset.imu[place - place / 11].time);
    EXPECT_EQ(recording.dataset.imu.back().time, good.dataset.imu.back().time);
  }
}

TEST_F(DriverRecording, ACovarianceThatDeniesValuesThatAreThereIsNotBelieved) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 5);
  const Recording good = read(messages);
  for (Written& m : messages) {
    if (m.topic != "/imu") continue;
    const ImuMessage read =
        decode_imu_of({"", kImuType, Encoding::kRos1, ""},
                      {reinterpret_cast<const std::uint8_t*>(m.data.data()), m.data.size()});
    m.data = imu_message(Wire::kRos1, read.sample, -1.0);
  }
  const Recording recording = read(messages);
  expect_same(recording.dataset, good.dataset);
  EXPECT_PRED2(test::contains, notes_of(recording),
               "/imu: 50 messages have values and a covariance of -1");
}

/// at_rest() with the IMU of a camera: rates on one topic, forces at a third of the rate on
/// another, linear in time.
std::vector<Written> halves() {
  std::vector<Written> messages;
  int i = 0;
  for (const Written& m : test::at_rest(Wire::kRos1, 20)) {
    if (m.topic != "/imu") {
      messages.push_back(m);
      continue;
    }
    const Time stamp = m.received - Time(250'000'000);
    messages.push_back(
        {"/gyro", m.type, m.received,
         imu_message(Wire::kRos1, {stamp, {0.001 * i, 0.2, 0.3}, Vector3d::Zero()})});
    if (i % 3 == 0) {
      messages.push_back(
          {"/accel", m.type, m.received,
           imu_message(Wire::kRos1, {stamp, Vector3d::Zero(), {0.01 * i, 0.0, 9.81}})});
    }
    ++i;
  }
  return messages;
}

TEST_F(DriverRecording, HalvesOfAnImuAreOne) {
  RecordingRequest half;
  half.imu_topic = "/accel";
  for (const RecordingRequest& request : {RecordingRequest(), half}) {
    const Recording recording = read(halves(), request);
    const std::vector<ImuSample>& imu = recording.dataset.imu;
    ASSERT_EQ(imu.size(), 199U);  // up to the last force
    for (std::size_t i = 0; i < imu.size(); ++i) {
      EXPECT_NEAR(imu[i].gyro_B.x(), 1e-3 * static_cast<double>(i), 1e-12);
      EXPECT_NEAR(imu[i].accel_B.x(), 1e-2 * static_cast<double>(i), 1e-9);
      EXPECT_EQ(imu[i].accel_B.z(), 9.81);
    }
    EXPECT_PRED2(test::contains, notes_of(recording), "gyroscope /gyro, accelerometer /accel");
  }
  std::vector<Written> one = halves();
  std::erase_if(one, [](const Written& m) { return m.topic == "/accel"; });
  EXPECT_ERROR(read(one), "/gyro has no accelerometer, and no other topic has it");
}

TEST_F(DriverRecording, AnAccelerometerOnAnotherClockIsOnThatOfTheRecorder) {
  const Recording good = read(halves());
  std::vector<Written> messages = halves();
  for (Written& m : messages) {
    if (m.topic == "/accel") move_header(&m, -1'000'000 * kSecond);
  }
  const Recording recording = read(messages);
  ASSERT_EQ(recording.dataset.imu.size(), good.dataset.imu.size());
  EXPECT_EQ(recording.dataset.imu[20].accel_B, good.dataset.imu[20].accel_B);
  EXPECT_PRED2(test::contains, notes_of(recording), "clocks of IMU and accelerometer are 1000000.");
}

TEST_F(DriverRecording, ForcesThatAreMissingAreNotMadeUp) {
  std::vector<Written> messages = halves();
  std::erase_if(messages, [&](const Written& m) {
    const Time at = m.received - messages[0].received;
    return m.topic == "/accel" && at > kSecond / 2 && at < kSecond;
  });
  const std::vector<ImuSample> imu = read(messages).dataset.imu;
  Time longest{0};
  for (std::size_t i = 1; i < imu.size(); ++i) {
    longest = std::max(longest, imu[i].time - imu[i - 1].time);
  }
  EXPECT_GT(longest, kSecond / 2);
}

TEST_F(DriverRecording, Px4SensorsAreAnImu) {
  std::vector<Written> messages;
  for (const Written& m : test::at_rest(Wire::kCdr, 5)) {
    messages.push_back(m);
    if (m.topic != "/imu") continue;
    Wire wire(Wire::kCdr);
    wire.put(static_cast<std::uint64_t>((m.received.count() - 1'600'000'000'000'000'000) / 1000));
    for (const float value : {0.5F, 0.25F, -0.125F}) wire.put(value);
    wire.put(std::uint32_t{5000}).put(std::int32_t{0});
    for (const float value : {1.0F, 2.0F, -9.75F}) wire.put(value);
    wire.put(std::uint32_t{5000}).put(std::uint8_t{0}).put(std::uint8_t{0});
    messages.back() = {"/fmu", "px4_msgs/SensorCombined", m.received, wire.bytes};
  }
  const Recording good = read_ros2(test::at_rest(Wire::kCdr, 5));
  const Recording recording = read_ros2(messages);
  ASSERT_EQ(recording.dataset.imu.size(), 50U);
  EXPECT_EQ(recording.dataset.imu[3].gyro_B, Vector3d(0.5, -0.25, 0.125));
  EXPECT_EQ(recording.dataset.imu[3].accel_B, Vector3d(1.0, -2.0, 9.75));
  EXPECT_PRED2(test::contains, notes_of(recording), "/fmu: axes forward, right, down");
  // both on the clock of the recorder
  const Time apart = recording.dataset.scans[1].time - recording.dataset.imu[19].time;
  EXPECT_LE(std::abs(apart.count()), 2000)
      << (good.dataset.scans[1].time - good.dataset.imu[19].time).count();
}

/// at_rest() with other messages for the scans.
std::vector<Written> with_scans(
    Wire::Kind kind, const std::function<void(Time, Time, std::vector<Written>*)>& scan) {
  std::vector<Written> messages;
  for (const Written& m : test::at_rest(kind, 10)) {
    if (m.topic == "/imu") {
      messages.push_back(m);
    } else {
      scan(m.received - Time(250'001'000), m.received, &messages);
    }
  }
  return messages;
}

TEST_F(DriverRecording, PointsOfAScanInMessagesOfTheirOwnAreAScan) {
  const Recording good = read(test::at_rest(Wire::kRos1, 10));
  const auto point_by_point = [](Time stamp, Time received, std::vector<Written>* messages) {
    for (std::uint16_t id = 0; id < 2; ++id) {
      Wire wire(Wire::kRos1);
      wire.header(stamp + id * Time(20'000), "radar").put(id);
      for (const float value : {1.5F, 2.5F + id, -0.5F, 3.0F, 0.25F}) wire.put(value);
      wire.put(std::uint16_t{3}).put(10.F).put(12.F);
      messages->push_back({"/scan", "ti_mmwave_rospkg/RadarScan", received, wire.bytes});
    }
  };
  const std::vector<Written> messages = with_scans(Wire::kRos1, point_by_point);
  const Recording recording = read(messages);
  expect_same(recording.dataset, good.dataset);
  const RadarDetection& d = recording.dataset.scans[9].detections.at(1);
  EXPECT_EQ(d.point_S, Vector3d(1.5, 3.5, -0.5));
  EXPECT_EQ(d.range_rate, 0.25);
  EXPECT_EQ(d.snr_db, 12.0);
  EXPECT_PRED2(test::contains, summary_text(summarise(open_messages(dir_.path() / "a").get())),
               "points preset ti");
}

TEST_F(DriverRecording, RadarReturnsArePoints) {
  for (const Wire::Kind kind : {Wire::kRos1, Wire::kCdr}) {
    const auto returns = [kind](Time stamp, Time received, std::vector<Written>* messages) {
      Wire wire(kind);
      wire.header(stamp, "radar").put(std::uint32_t{2});
      for (const float side : {1.F, -1.F}) {
        wire.put(2.F).put(side * std::numbers::pi_v<float> / 6.F).put(0.F).put(0.75F).put(20.F);
      }
      messages->push_back({"/scan", "radar_msgs/RadarScan", received, wire.bytes});
    };
    const std::vector<Written> messages = with_scans(kind, returns);
    const Recording recording = kind == Wire::kCdr ? read_ros2(messages) : read(messages);
    ASSERT_EQ(recording.dataset.scans.size(), 10U);
    const RadarDetection& d = recording.dataset.scans[3].detections.at(0);
    EXPECT_LT((d.point_S - Vector3d(std::sqrt(3.0), 1.0, 0.0)).norm(), 1e-6);
    EXPECT_EQ(d.range_rate, 0.75);
    EXPECT_EQ(d.snr_db, 20.0);
  }
}

TEST_F(DriverRecording, AnglesInDegreesAreAnError) {
  const auto returns = [](Time stamp, Time received, std::vector<Written>* messages) {
    Wire wire(Wire::kRos1);
    wire.header(stamp, "radar").put(std::uint32_t{2});
    for (const float side : {1.F, -1.F}) wire.put(2.F).put(side * 30.F).put(0.F).put(0.5F).put(9.F);
    messages->push_back({"/scan", "radar_msgs/RadarScan", received, wire.bytes});
  };
  const std::vector<Written> messages = with_scans(Wire::kRos1, returns);
  EXPECT_ERROR(read(messages),
               "points: angles in degrees: --field azimuth=azimuth*0.0174533 --field "
               "elevation=elevation*0.0174533");
  RecordingRequest request;
  request.points.fields = {{"azimuth=azimuth*0.0174533", ""},
                           {"elevation=elevation*0.0174533", ""}};
  const RadarDetection d = read(messages, request).dataset.scans[3].detections.at(0);
  EXPECT_LT((d.point_S - Vector3d(std::sqrt(3.0), 1.0, 0.0)).norm(), 1e-5);
}

Written transforms(Time when, const std::vector<Transform>& all) {
  Wire wire(Wire::kRos1);
  wire.put(static_cast<std::uint32_t>(all.size()));
  for (const Transform& t : all) {
    wire.header(when, t.parent).text(t.child);
    for (const double value : t.pose.translation) wire.put(value);
    for (const double value : t.pose.rotation.coeffs()) wire.put(value);
  }
  return {"/tf_static", "tf2_msgs/TFMessage", when, wire.bytes};
}

/// at_rest() with a second radar, whose frame is "radar_left"; at_rest() calls those of the first
/// one and of the IMU "radar" and "imu_link".
std::vector<Written> two_radars() {
  std::vector<Written> messages;
  for (const Written& m : test::at_rest(Wire::kRos1, 10)) {
    messages.push_back(m);
    if (m.topic != "/radar") continue;
    Written left = m;
    left.topic = "/left";
    const std::size_t at = left.data.find("radar");
    left.data.replace(at - 4, 9, test::block("radar_left"));
    messages.push_back(left);
  }
  return messages;
}

TEST_F(DriverRecording, SeveralRadarsHaveTheirMountingsFromTheTree) {
  const Quaternion quarter(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vector3d::UnitZ()));
  std::vector<Written> messages = two_radars();
  EXPECT_ERROR(read(messages), "choose with --radar");
  const Time when = messages[0].received;
  messages.insert(messages.begin(),
                  transforms(when, {{"base", "imu_link", {quarter, {1.0, 0.0, 0.0}}},
                                    {"base", "radar", {Quaternion::Identity(), {1.0, 2.0, 0.0}}},
                                    {"radar", "radar_left", {quarter, {0.0, 0.0, 3.0}}}}));
  const Recording recording = read(messages);
  ASSERT_EQ(recording.dataset.other_radars.size(), 1U);
  EXPECT_EQ(recording.dataset.other_radars[0].scans.size(), 10U);
  const Pose& left = *recording.dataset.radar_info.T_BS;  // topics in the order of their names
  const Pose& first = *recording.dataset.other_radars[0].info.T_BS;
  EXPECT_LT((first.translation - Vector3d(2.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT(first.rotation.angularDistance(quarter.conjugate()), 1e-7);
  EXPECT_LT((left.translation - Vector3d(2.0, 0.0, 3.0)).norm(), 1e-12);
  EXPECT_LT(left.rotation.angularDistance(Quaternion::Identity()), 1e-7);
  EXPECT_PRED2(test::contains, notes_of(recording), "/left: mounting of /tf_static: T_BS: {");

  RecordingRequest request;
  request.radar_topic = "/radar,/left";
  EXPECT_LT(
      (read(messages, request).dataset.radar_info.T_BS->translation - first.translation).norm(),
      1e-12);
  request.radar_topic = "/radar";
  EXPECT_TRUE(read(messages, request).dataset.other_radars.empty());
  // the frame is that of the points as they are sent: here in axes of the chip
  request.points.axes = "ti";
  const Quaternion turned = read(messages, request).dataset.radar_info.T_BS->rotation;
  EXPECT_LT(
      (turned * Vector3d(0.0, 1.0, 0.0) - quarter.conjugate() * Vector3d(-1.0, 0.0, 0.0)).norm(),
      1e-7);
}

TEST_F(DriverRecording, CloudsWithoutDopplerAreNoRadar) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 10);
  messages.push_back({"/lidar", "sensor_msgs/PointCloud2", messages.back().received,
                      cloud_message(Wire::kRos1, messages.back().received,
                                    {{"x", 0}, {"y", 4}, {"z", 8}}, {{1, 2, 3}}, 12)});
  EXPECT_EQ(read(messages).dataset.scans.size(), 10U);
}

TEST_F(DriverRecording, PosesAreTheTruthAndPressuresTheBarometer) {
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

TEST_F(DriverRecording, TruthAndBarometerOnAnotherClockAreOnThatOfTheImu) {
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

TEST_F(DriverRecording, ATruthThatWasAddedLaterKeepsItsHeaders) {
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

TEST_F(DriverRecording, ATruthOrBarometerThatCannotBeReadIsTold) {
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

TEST_F(DriverRecording, ARadarThatEndsEarlyIsTold) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 40);
  std::erase_if(messages, [&](const Written& m) {
    return m.topic == "/radar" && m.received > messages[0].received + kSecond;
  });
  EXPECT_PRED2(test::contains, notes_of(read(messages)), "/radar ends 3.0 s before /imu");
}

TEST_F(DriverRecording, PartsAreReadInTheOrderOfTheirNumbers) {
  const std::vector<Written> all = test::at_rest(Wire::kRos1, 24);
  const Recording whole = read(all);
  const std::size_t size = all.size() / 12;
  for (const std::string& format : test::formats()) {
    const std::vector<Written> messages = test::at_rest(test::wire_of(format), 24);
    const std::string end = format == "db3"              ? ".db3"
                            : format.starts_with("ros1") ? ".bag"
                                                         : ".mcap";
    const auto folder = dir_.path() / ("parts_" + format);
    std::filesystem::create_directories(folder);
    for (std::size_t part = 0; part < 12; ++part) {
      const auto begin = messages.begin() + static_cast<std::ptrdiff_t>(part * size);
      test::write_bag(folder / ("flight_" + std::to_string(part) + end), format,
                      {begin, begin + static_cast<std::ptrdiff_t>(size)});
    }
    expect_same(read_recording(folder, {}).dataset, whole.dataset);
    std::filesystem::remove(folder / ("flight_0" + end));  // now they may be several recordings
    EXPECT_ERROR(read_recording(folder, {}), "holds several recordings; name one");
  }
}

TEST_F(DriverRecording, CompressedMessagesAndFiles) {
#ifdef RIO_HAS_ZSTD
  const std::vector<Written> plain = test::at_rest(Wire::kCdr, 10);
  const Recording good = read_ros2(plain);
  std::vector<Written> messages = plain;
  for (Written& m : messages) m.data = test::compressed("zstd", m.data);
  expect_same(read_ros2(messages).dataset, good.dataset);
  dir_.write("folder/flight_0.mcap.zstd", test::compressed("zstd", test::mcap(plain, "none", 20)));
  expect_same(read_recording(dir_.path() / "folder", {}).dataset, good.dataset);
  EXPECT_ERROR(read_recording(dir_.write("bad.zstd", "\x28\xB5\x2F\xFD and nothing more"), {}),
               "zstd data is damaged");
#ifdef RIO_HAS_SQLITE3
  test::write_bag(dir_.path() / "plain.db3", "db3", messages);
  expect_same(read_recording(dir_.path() / "plain.db3", {}).dataset, good.dataset);
#endif
#else
  GTEST_SKIP() << "skipped: built without zstd";
#endif
}

}  // namespace
}  // namespace rio::bag
