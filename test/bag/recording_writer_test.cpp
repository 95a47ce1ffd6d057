// SPDX-License-Identifier: BSD-3-Clause
// What is written as MCAP, read back: by the reader of this library, and, where it is installed, by
// @mcap/core (found through NODE_PATH), whose own file is read as well. Recordings written by
// Debian's python3-rosbag, where that is installed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "bag/bag_writer.hpp"
#include "rio/bag/recording.hpp"
#include "rio/bag/recording_writer.hpp"
#include "support/same_recording.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// What the script writes.
void expect_the_recording(const std::filesystem::path& path) {
  const io::Dataset data = read_recording(path, {});
  EXPECT_EQ(data.damage, "");
  ASSERT_EQ(data.imu.size(), 300U);
  ASSERT_EQ(data.scans.size(), 30U);
  for (int i = 0; i < 300; ++i) {
    const ImuSample& sample = data.imu[static_cast<std::size_t>(i)];
    EXPECT_EQ(sample.time, Time(1'000'000'000'000 + 1'000'000LL * i));
    EXPECT_EQ(sample.gyro_B, Vector3d(0.5, -0.25, i));
    EXPECT_EQ(sample.accel_B, Vector3d(0.125 * i, 0.0, 9.75));
  }
  for (int i = 0; i < 30; ++i) {
    const RadarScan& scan = data.scans[static_cast<std::size_t>(i)];
    EXPECT_EQ(scan.time, Time(1'000'000'000'000 + 10'000'000LL * i));
    ASSERT_EQ(scan.detections.size(), 2U);
    EXPECT_EQ(scan.detections[0].point_S, Vector3d(1, 2, 3));
    EXPECT_EQ(scan.detections[0].range_rate, -0.5);
    EXPECT_EQ(scan.detections[1].snr_db, 20.0);
    EXPECT_EQ(scan.detections[1].range_rate, 10.0 * i);
  }
}

TEST(Referee, ReadsWhatRosbagWrites) {
  const std::string python = "/usr/bin/python3 ";
  if (!runs(python + "-c 'import rosbag, sensor_msgs.msg'")) {
    GTEST_SKIP() << "skipped: needs the packages python3-rosbag and python3-sensor-msgs";
  }
  const test::TempDir dir;
  for (const std::string& format : test::formats()) {
    if (!format.starts_with("ros1-")) continue;
    const auto path = dir.path() / format;
    ASSERT_TRUE(runs(python + RIO_SOURCE_DIR "/test/bag/write_ros1_bag.py " + path.string() + " " +
                     format.substr(5)))
        << format;
    expect_the_recording(path);
  }
}

using std::chrono::milliseconds;
using test::TempDir;

constexpr int kSeconds = 20;

std::vector<ImuSample> some_imu() {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 100 * kSeconds; ++i) {
    samples.push_back({Time(1'700'000'000'123'456'789) + i * milliseconds(10),
                       {0.1 * i, -1.0 / 3.0, 1e-9},
                       {0.7, 1e3 / 7.0, 9.81}});
  }
  return samples;
}

/// A scan each 100 ms with numbers as a TI packet has them; some are empty.
std::vector<RadarScan> some_scans() {
  std::vector<RadarScan> scans;
  for (int i = 0; i < 10 * kSeconds; ++i) {
    RadarScan scan{Time(1'700'000'000'123'456'789) + i * milliseconds(100) - milliseconds(30), {}};
    for (int k = 0; k < i % 9; ++k) {
      const Vector3d point_S(1.1F + static_cast<float>(k), -0.3F * static_cast<float>(i), 0.7F);
      scan.detections.push_back(
          {point_S, -0.1F * static_cast<float>(k), 0.1 * (61 + k), 0.1 * (599 - i)});
    }
    scans.push_back(scan);
  }
  return scans;
}

/// Both in the order in which they come, a chunk a second.
void write(const std::filesystem::path& path, bool closed = true) {
  RecordingWriter file(path, 1);
  const std::vector<RadarScan> scans = some_scans();
  std::size_t scan = 0;
  int count = 0;
  for (const ImuSample& sample : some_imu()) {
    file.add(sample);
    if (scan < scans.size() && scans[scan].time + milliseconds(50) < sample.time) {
      file.add(scans[scan++]);
    }
    if (++count % 100 == 0) file.flush();
  }
  while (scan < scans.size()) file.add(scans[scan++]);
  if (closed) file.close();
}

/// To the last bit.
void expect_all(const io::Dataset& read) {
  EXPECT_EQ(read.damage, "");
  io::Dataset put;
  put.imu = some_imu();
  put.scans = some_scans();
  test::expect_same_recording(read, put, 0.0, 0.0,
                              [](const RadarDetection& a, const RadarDetection& b) {
                                ASSERT_EQ(a.snr_db, b.snr_db);
                                ASSERT_EQ(a.noise_db, b.noise_db);
                              });
}

TEST(RecordingWriter, ReadsBack) {
  const TempDir dir;
  write(dir.path() / "a.mcap");
  expect_all(read_recording(dir.path() / "a.mcap", {}));
}

TEST(RecordingWriter, WholeChunksAreReadWhereverTheFileEnds) {
  const TempDir dir;
  write(dir.path() / "open.mcap", false);
  EXPECT_GT(read_recording(dir.path() / "open.mcap", {}).imu.size(), 100U * kSeconds - 1);
  write(dir.path() / "a.mcap");
  const std::string bytes = dir.read("a.mcap");
  std::size_t least = 0;
  const std::size_t first_chunks = 100'000;
  for (std::size_t size = first_chunks; size < bytes.size(); size += 9973) {
    const auto cut = dir.write("cut.mcap", bytes.substr(0, size));
    const io::Dataset read = read_recording(cut, {});
    EXPECT_NE(read.damage, "") << size;
    EXPECT_GE(read.imu.size(), least) << size;
    // a second is less than 60 kB: all but the last one are there
    EXPECT_GE(read.imu.size() + 100, 100 * (size / 60'000)) << size;
    least = read.imu.size();
  }
  EXPECT_GT(least, 100U * (kSeconds - 2));
}

TEST(RecordingWriter, Refuses) {
  const TempDir dir;
  write(dir.path() / "a.mcap");
  EXPECT_ERROR(RecordingWriter(dir.path() / "a.mcap", 1), "is another file");
  EXPECT_ERROR(RecordingWriter(dir.path() / "no/such/folder.mcap", 1), "folder.mcap");
  RecordingWriter file(dir.path() / "b.mcap", 2);
  EXPECT_ERROR(file.add(ImuSample{Time(-1), {}, {}}), "not one of ROS");
  file.add(RadarScan{Time(-1), {}}, 1);
  file.add(RadarScan{Time(1), {}}, 1);
  file.close();
}

TEST(RecordingWriter, TheRefereeReadsTheSameAndItsCopyIsRead) {
  if (!runs("node -e 'require(\"@mcap/core\")'")) {
    GTEST_SKIP() << "skipped: needs node and @mcap/core in NODE_PATH";
  }
  const TempDir dir;
  const std::string file = (dir.path() / "a.mcap").string();
  write(file);
  const std::string command = "node " RIO_SOURCE_DIR "/test/bag/copy_mcap.cjs " + file + " " +
                              file + ".copy >" + (dir.path() / "out").string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  EXPECT_EQ(dir.read("out"),
            "/imu sensor_msgs/msg/Imu ros2msg cdr 2000\n"
            "/radar0 sensor_msgs/msg/PointCloud2 ros2msg cdr 200\n"
            "chunks 20, with an index 20, messages by the index 2200\n");
  expect_all(read_recording(file + ".copy", {}));
}

}  // namespace
}  // namespace rio::bag
