// SPDX-License-Identifier: BSD-3-Clause
#include "rio/bag/recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "bag/driver_recording.hpp"
#include "rio/bag/summary.hpp"

namespace rio::bag {
namespace {

class RecordingTest : public DriverRecording {
 protected:
  /// A scan with this header stamp.
  static Written scan(Time header, Time received, const test::Points& points = {{1, 2, 3, 4, 5}}) {
    return {"/radar", "sensor_msgs/PointCloud2", received,
            cloud_message(Wire::kRos1, header, test::ti_fields(), points, 32)};
  }
  static Written imu(Time header, Time received) {
    return {"/imu", "sensor_msgs/Imu", received,
            imu_message(Wire::kRos1, {header, {1, 2, 3}, {4, 5, 6}})};
  }
};

TEST_F(RecordingTest, TheClocksAreChosenByWhatTheHeadersSay) {
  const Time gap(250'000'000);
  const auto all = [&](Time imu_header, Time radar_header, const RecordingRequest& request = {}) {
    std::vector<Written> messages;
    for (int i = 0; i < 9; ++i) {
      const Time t = kBegin + i * gap;
      const Time jitter((i * 7 % 5 - 2) * 1'000'000);
      messages.push_back(imu(imu_header + i * gap, t + jitter));
      messages.push_back(scan(radar_header.count() == 0 ? Time(0) : radar_header + i * gap, t));
    }
    return read(messages, request);
  };
  const io::Dataset same = all(kBegin - Time(1000), kBegin - Time(2000));
  EXPECT_EQ(same.imu[3].time, kBegin - Time(1000) + 3 * gap);
  EXPECT_EQ(same.scans[3].time, kBegin - Time(2000) + 3 * gap);
  expect_told(same, "/imu: 9 messages, stamped by their headers\n");

  // a zero stamp: the radar by its arrival, the IMU carried there without its jitter
  const io::Dataset zero = all(Time(5'000'000'000), Time(0));
  EXPECT_EQ(zero.imu[3].time, kBegin + 3 * gap);
  EXPECT_EQ(zero.scans[3].time, kBegin + 3 * gap);
  expect_told(zero,
              "/radar: 9 messages, stamped when they were received (9 header stamps are zero)");
  expect_told(zero, "--radar-offset");

  // two clocks: both onto that of the recorder
  const io::Dataset two = all(Time(5'000'000'000), Time(90'000'000'000));
  EXPECT_EQ(two.imu[3].time, kBegin + 3 * gap);
  EXPECT_EQ(two.scans[3].time, kBegin + 3 * gap);
  expect_told(two, "the header clocks of IMU and radar are 85.000 s apart");

  RecordingRequest request;
  request.radar_clock = Clock::kHeader;
  EXPECT_ERROR(all(kBegin, Time(0), request),
               "9 of 9 header stamps on /radar are zero; use --radar-clock receive");
  request.radar_clock = Clock::kReceive;
  request.imu_clock = Clock::kReceive;
  request.radar_offset = -0.5;
  request.imu_offset = 0.25;
  const io::Dataset asked = all(kBegin, kBegin, request);
  EXPECT_EQ(asked.imu[1].time, kBegin + 2 * gap);
  EXPECT_EQ(asked.scans[2].time, kBegin);
}

/// Ten triggers 100 ms apart on a clock of their own; of all but the last one a scan with their
/// number 126 ms later, hence after the next trigger.
std::vector<Written> triggered(Wire::Kind kind) {
  constexpr Time kOwn(77'000'000'000);
  std::vector<Written> messages;
  for (int i = 0; i < 10; ++i) {
    const Time t = kBegin + i * Time(100'000'000);
    const auto number = static_cast<std::uint32_t>(40 + i);
    const Time stamp = kOwn + (t - kBegin);
    messages.push_back(
        {"/imu", "sensor_msgs/Imu", t, imu_message(kind, {stamp, {0.01, 0, 0}, {0, 0, 9.8}})});
    messages.push_back({"/tick", "std_msgs/Header", t, Wire(kind).header(stamp, "", number).bytes});
    if (i == 9) break;
    messages.push_back(
        {"/radar", "sensor_msgs/PointCloud2", t + Time(126'000'000),
         cloud_message(kind, Time(0), test::ti_fields(), {{1, 2, 3, 4, 5}}, 32, 1, 0, number)});
  }
  return messages;
}

TEST_F(RecordingTest, ScansAreStampedByTheirTriggers) {
  constexpr Time kFrame(100'000'000);
  std::vector<Written> messages = triggered(Wire::kRos1);
  RecordingRequest request;
  request.radar_clock = Clock::kTrigger;
  request.radar_offset = 9e-3;
  const auto time = [](const io::Dataset& r, std::size_t i) {
    return r.scans.at(i).time - r.imu.at(i).time;
  };
  const io::Dataset same = read(messages, request);
  ASSERT_EQ(same.scans.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(time(same, i), Time(9'000'000)) << i;
  expect_told(same,
              "/radar: 9 messages, 9 stamped by the last trigger before on /tick, of the same "
              "number, and moved by 0.009 s; 0 without one are left out");
  request.trigger_match = TriggerMatch::kEarlier;
  EXPECT_EQ(time(read(messages, request), 4), kFrame + Time(9'000'000));

  // a trigger that is missing costs its scan; one of a second run with the same number is later
  request.trigger_match = TriggerMatch::kSequence;
  messages.push_back(messages[10]);
  messages.back().received += Time(50'000'000'000);
  messages.erase(messages.begin() + 4);  // the second one
  const io::Dataset lost = read(messages, request);
  ASSERT_EQ(lost.scans.size(), 8U);
  EXPECT_EQ(lost.scans[1].time - lost.imu[2].time, Time(9'000'000));
  expect_told(lost, "1 without one are left out");
}

TEST_F(RecordingTest, TriggersThatDoNotFitAreErrors) {
  RecordingRequest request;
  request.radar_clock = Clock::kTrigger;
  std::vector<Written> messages = triggered(Wire::kRos1);
  request.trigger_topic = "/imu";  // begins with a header, too; all numbers are 7
  EXPECT_ERROR(read(messages, request), "no scan on /radar has a trigger on /imu");
  request.trigger_topic = "/none";
  EXPECT_ERROR(read(messages, request), "no topic /none; there are\n  /imu");
  request.trigger_topic = "";
  messages.push_back({"/tock", "std_msgs/Header", kBegin, messages[1].data});
  EXPECT_ERROR(read(messages, request),
               "several topics of type std_msgs/Header; choose with --trig");
  messages.back() = {"/tick", "std_msgs/Header", kBegin,
                     Wire(Wire::kRos1).header(Time(0), "").bytes};
  EXPECT_ERROR(read(messages, request), "1 of 11 header stamps on /tick are zero");
  EXPECT_ERROR(read(test::at_rest(Wire::kRos1, 2), request), "no topic of type std_msgs/Header");
  request.radar_clock = Clock::kAuto;
  request.imu_clock = Clock::kTrigger;
  EXPECT_ERROR(read(messages, request), "is for the radar alone");

  request = {};
  request.radar_clock = Clock::kTrigger;
  messages = triggered(Wire::kCdr);
  EXPECT_ERROR(read_ros2(messages, request), "/tick have no sequence numbers, as in ROS 2");
  request.trigger_match = TriggerMatch::kEarlier;
  EXPECT_EQ(read_ros2(messages, request).scans.size(), 9U);
}

TEST_F(RecordingTest, TopicsAreGuessedOnlyIfThereIsOne) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 2);
  messages.push_back(messages.front());
  messages.back().topic = "/imu2";
  EXPECT_ERROR(read(messages),
               "several topics of type sensor_msgs/Imu; choose with --imu:\n  /imu "
               "sensor_msgs/Imu (20 messages)");
  RecordingRequest request;
  request.imu_topic = "/imu2";
  EXPECT_EQ(read(messages, request).imu.size(), 1U);
  request.imu_topic = "/imu3";
  EXPECT_ERROR(read(messages, request), "no topic /imu3; there are\n  /imu sensor_msgs/Imu");
  request.imu_topic = "/radar";
  EXPECT_ERROR(read(messages, request), "topic /radar is of type sensor_msgs/PointCloud2");
  messages.resize(3);
  EXPECT_ERROR(read(messages), "no topic of type sensor_msgs/PointCloud2; there are");
}

TEST_F(RecordingTest, UnitsOfTheImuAreConverted) {
  RecordingRequest request;
  request.gyro_unit = 0.5;
  request.accel_unit = 9.80665;
  const io::Dataset recording = read({imu(kBegin, kBegin), scan(kBegin, kBegin)}, request);
  EXPECT_EQ(recording.imu[0].gyro_B, Vector3d(0.5, 1.0, 1.5));
  EXPECT_EQ(recording.imu[0].accel_B, 9.80665 * Vector3d(4, 5, 6));
}

TEST_F(RecordingTest, WhatIsLeftOutIsCounted) {
  std::vector<Written> messages = {imu(kBegin, kBegin), imu(kBegin + Time(9), kBegin)};
  messages[1].data.resize(50);
  messages.push_back(scan(kBegin, kBegin, {{1, 2, 3, 4, NAN}, {1, 2, 3, 4, 5}}));
  messages.push_back(scan(kBegin, kBegin));
  messages.push_back(scan(kBegin + Time(1), kBegin, {}));
  const io::Dataset recording = read(messages);
  EXPECT_EQ(recording.imu.size(), 1U);
  ASSERT_EQ(recording.scans.size(), 2U);
  EXPECT_EQ(recording.scans[0].detections.size(), 1U);
  EXPECT_TRUE(recording.scans[1].detections.empty());
  expect_told(recording, "1 scans have the stamp of the scan before");
  expect_told(recording, "1 points are not finite");
  expect_told(recording, "/imu: 1 messages cannot be read and are left out; the first");
}

TEST_F(RecordingTest, OfADamagedFileItKeepsWhatStandsBefore) {
  const std::vector<Written> messages = test::at_rest(Wire::kRos1, 20);
  const std::string bytes = test::ros1_bag(messages, "none", 44);
  const auto path = dir_.write("cut", bytes.substr(0, bytes.size() / 2));
  const io::Dataset recording = read_recording(path, {});
  EXPECT_PRED2(test::contains, recording.damage, "cut: byte ");
  EXPECT_GT(recording.imu.size(), 90U);
  EXPECT_LT(recording.imu.size(), 110U);
  EXPECT_NEAR(*recording.imu_info.rate_hz, 100.0, 1e-3);
  EXPECT_NEAR(*recording.radar_info.rate_hz, 10.0, 1e-3);
  EXPECT_FALSE(recording.radar_info.T_BS);
  EXPECT_ERROR(read_recording(dir_.write("b", bytes.substr(0, 40)), {}), "b: byte ");
}

/// In the order of time, as a replay asks, each format and each order of the topics in the file.
TEST_F(RecordingTest, SampleBySampleEveryFormatIsTheSame) {
  const auto by_topic = [](const std::string& first) {
    return [first](const Written& a, const Written& b) {
      return (a.topic == first) > (b.topic == first);
    };
  };
  for (const std::string& format : test::formats()) {
    for (const std::string order : {"time", "/imu", "/radar"}) {
      std::vector<Written> messages = test::at_rest(test::wire_of(format), 450);
      messages[7].data.resize(20);                 // unreadable
      messages.push_back(messages[10 * 11 + 10]);  // a scan, twice
      messages.push_back(messages[10 * 11 + 10]);
      if (order != "time") std::stable_sort(messages.begin(), messages.end(), by_topic(order));
      const auto path = dir_.path() / format;
      std::filesystem::remove(path);
      test::write_bag(path, format, messages);
      const io::Dataset all = read_recording(path, {});
      ASSERT_EQ(all.imu.size(), 4499U);
      ASSERT_EQ(all.scans.size(), 451U);
      const auto stream = open_recording(path, {});
      EXPECT_EQ(stream->outline().sensors.notes, all.notes);
      for (int pass = 0; pass < 2; ++pass, stream->rewind()) {
        SCOPED_TRACE(format + " " + order);
        ImuSample sample;
        RadarScan scan;
        std::size_t imu = 0;
        for (std::size_t i = 0; i < all.scans.size(); ++i) {
          for (; imu < 10 * i && imu < all.imu.size(); ++imu) {
            ASSERT_TRUE(stream->next(&sample)) << imu;
            EXPECT_EQ(sample.time, all.imu[imu].time);
            EXPECT_EQ(sample.gyro_B, all.imu[imu].gyro_B);
          }
          ASSERT_TRUE(stream->next(&scan)) << i;
          EXPECT_EQ(scan.time, all.scans[i].time);
          EXPECT_EQ(scan.time, stream->outline().scan_times[0][i]);
          ASSERT_EQ(scan.detections.size(), 2U);
          EXPECT_EQ(scan.detections[1].range_rate, all.scans[i].detections[1].range_rate);
        }
        EXPECT_FALSE(stream->next(&scan));
        while (imu < all.imu.size() && stream->next(&sample)) ++imu;
        EXPECT_EQ(imu, all.imu.size());
        EXPECT_FALSE(stream->next(&sample));
      }
    }
  }
}

TEST_F(RecordingTest, TheSummaryTellsRatesClocksAndFields) {
  std::vector<Written> messages = test::at_rest(Wire::kRos1, 20);
  messages.push_back(scan(Time(0), messages.back().received));
  const auto path = dir_.write("a", test::ros1_bag(messages, "none", 44));
  const std::string text = summary_text(summarise(open_messages(path).get()));
  for (const char* part :
       {"ROS 1 bag, 221 messages, 1.990 s, received from 1600000000.373456789 s on\n",
        "   200   100.00 Hz     1.990 s\n",
        "header stamps 0.250000 to 0.250000 s before they were received; frame_id \"imu_link\"",
        "; 1 of 21 are zero; frame_id \"radar\"", "fields: x float32 @0, y float32 @4",
        "points preset ti: x=x"}) {
    EXPECT_PRED2(test::contains, text, part);
  }
}

TEST_F(RecordingTest, CompressedMessagesAndFiles) {
#ifdef RIO_HAS_ZSTD
  const std::vector<Written> plain = test::at_rest(Wire::kCdr, 10);
  const io::Dataset good = read_ros2(plain);
  std::vector<Written> messages = plain;
#ifdef RIO_HAS_LZ4
  for (Written& m : messages) m.data = test::compressed("lz4", m.data);
  expect_same(read_ros2(messages), good);
  messages = plain;
#endif
  for (Written& m : messages) m.data = test::compressed("zstd", m.data);
  expect_same(read_ros2(messages), good);
  dir_.write("folder/flight_0.mcap.zstd", test::compressed("zstd", test::mcap(plain, "none", 20)));
  expect_same(read_recording(dir_.path() / "folder", {}), good);
  EXPECT_ERROR(read_recording(dir_.write("bad.zstd", "\x28\xB5\x2F\xFD and nothing more"), {}),
               "zstd data is damaged");
#ifdef RIO_HAS_SQLITE3
  test::write_bag(dir_.path() / "plain.db3", "db3", messages);
  expect_same(read_recording(dir_.path() / "plain.db3", {}), good);
#endif
#else
  GTEST_SKIP() << "skipped: built without zstd";
#endif
}

}  // namespace
}  // namespace rio::bag
