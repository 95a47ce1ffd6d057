// SPDX-License-Identifier: BSD-3-Clause
// Recordings written by Debian's python3-rosbag. Skipped where it is not installed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "rio/bag/recording.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {
namespace {

bool runs(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

/// What the script writes.
void expect_the_recording(const std::filesystem::path& path) {
  const Recording recording = read_recording(path, {});
  EXPECT_EQ(recording.damage, "");
  const io::Dataset& data = recording.dataset;
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
  for (const std::string compression : {
           "none",
#ifdef RIO_HAS_BZ2
           "bz2",
#endif
#ifdef RIO_HAS_LZ4
           "lz4",
#endif
       }) {
    const auto path = dir.path() / compression;
    ASSERT_TRUE(runs(python + RIO_SOURCE_DIR "/test/bag/write_ros1_bag.py " + path.string() + " " +
                     compression))
        << compression;
    expect_the_recording(path);
  }
}

}  // namespace
}  // namespace rio::bag
