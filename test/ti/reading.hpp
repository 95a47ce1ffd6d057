// SPDX-License-Identifier: BSD-3-Clause
// A packet reader and all that it has handed out.
#pragma once

#include <algorithm>
#include <vector>

#include "rio/ti/packet_reader.hpp"
#include "ti/packet_writer.hpp"

namespace rio::ti::test {

struct Reading {
  PacketReader reader;
  std::vector<Frame> frames;

  explicit Reading(std::size_t max_packet = PacketReader::kMaxPacket) : reader(max_packet) {}

  void push(const std::uint8_t* bytes, std::size_t count, Time arrival = Time{0}) {
    reader.push(bytes, count, arrival, [this](const Frame& frame) { frames.push_back(frame); });
  }
  void push(const Bytes& bytes, Time arrival = Time{0}) {
    push(bytes.data(), bytes.size(), arrival);
  }
  /// In two pieces.
  void push_split(const Bytes& bytes, std::size_t first, Time arrival = Time{0}) {
    push(bytes.data(), first, arrival);
    push(bytes.data() + first, bytes.size() - first, arrival);
  }
  void flush() {
    reader.flush([this](const Frame& frame) { frames.push_back(frame); });
  }
  const PacketCounters& counters() const { return reader.counters(); }
  std::vector<std::uint32_t> numbers() const {
    std::vector<std::uint32_t> numbers;
    for (const Frame& frame : frames) numbers.push_back(frame.number);
    return numbers;
  }
};

/// The frame is the packet of these points, none left out.
inline bool is_frame_of(const Frame& frame, std::uint32_t number,
                        const std::vector<WrittenPoint>& points) {
  const auto same = [](const RadarDetection& d, const WrittenPoint& p) {
    return d.point_S == Vector3d(p.y, -p.x, p.z) && d.range_rate == p.velocity &&
           d.snr_db == 0.1 * p.snr && d.noise_db == 0.1 * p.noise;
  };
  return frame.number == number &&
         std::equal(frame.scan.detections.begin(), frame.scan.detections.end(), points.begin(),
                    points.end(), same);
}

}  // namespace rio::ti::test
