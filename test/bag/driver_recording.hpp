// SPDX-License-Identifier: BSD-3-Clause
// Recordings, read and compared with plain ones.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "bag/bag_writer.hpp"
#include "rio/bag/recording.hpp"
#include "support/temp_dir.hpp"

namespace rio::bag {

using test::kBegin;
using test::kDelay;
using test::Wire;
using test::Written;

inline constexpr Time kSecond(1'000'000'000);

/// A line each.
inline std::string notes_of(const io::Dataset& recording) {
  std::string text;
  for (const std::string& note : recording.notes) text += note + "\n";
  return text;
}

inline void expect_told(const io::Dataset& recording, const std::string& note) {
  EXPECT_PRED2(test::contains, notes_of(recording), note);
}
inline void expect_not_told(const io::Dataset& recording, const std::string& note) {
  EXPECT_FALSE(test::contains(notes_of(recording), note)) << notes_of(recording);
}

class DriverRecording : public testing::Test {
 protected:
  io::Dataset read(const std::vector<Written>& messages, const RecordingRequest& request = {}) {
    return read_recording(dir_.write("a", test::ros1_bag(messages, "none", 20)), request);
  }
  io::Dataset read_ros2(const std::vector<Written>& messages,
                        const RecordingRequest& request = {}) {
    return read_recording(dir_.write("a", test::mcap(messages, "none", 20)), request);
  }
  /// Stamps and numbers of detections.
  static void expect_same(const io::Dataset& a, const io::Dataset& b) {
    ASSERT_EQ(a.imu.size(), b.imu.size());
    ASSERT_EQ(a.scans.size(), b.scans.size());
    for (std::size_t i = 0; i < a.imu.size(); ++i) EXPECT_EQ(a.imu[i].time, b.imu[i].time) << i;
    for (std::size_t i = 0; i < a.scans.size(); ++i) {
      EXPECT_EQ(a.scans[i].time, b.scans[i].time) << i;
      EXPECT_EQ(a.scans[i].detections.size(), b.scans[i].detections.size()) << i;
    }
  }

  test::TempDir dir_;
};

/// at_rest(), of a topic the messages that `give(message, its stamp, &messages)` appends instead.
template <class Give>
std::vector<Written> replaced(Wire::Kind kind, int scans, const std::string& topic,
                              const Give& give) {
  std::vector<Written> messages;
  for (const Written& m : test::at_rest(kind, scans)) {
    if (m.topic == topic) {
      give(m, m.received - kDelay - Time(topic == "/radar" ? 1000 : 0), &messages);
    } else {
      messages.push_back(m);
    }
  }
  return messages;
}

/// All but what arrives of a topic between two times after the first message.
inline std::vector<Written> without(std::vector<Written> messages, const std::string& topic,
                                    Time from = Time::min(), Time to = Time::max()) {
  const Time begin = messages.front().received;
  std::erase_if(messages, [&](const Written& m) {
    const Time at = m.received - begin;
    return m.topic == topic && at > from && at < to;
  });
  return messages;
}

/// Of a message of ROS 1: sequence number, seconds, nanoseconds.
inline void set_header(Written* message, Time stamp) {
  const std::string header = Wire(Wire::kRos1).header(stamp, "").bytes;
  message->data.replace(4, 8, header.substr(4, 8));
}

inline void move_header(Written* message, Time by) {
  std::array<std::uint32_t, 2> stamp{};
  std::memcpy(stamp.data(), message->data.data() + 4, 8);
  set_header(message, stamp[0] * kSecond + Time(stamp[1]) + by);
}

}  // namespace rio::bag
