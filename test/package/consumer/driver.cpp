// SPDX-License-Identifier: BSD-3-Clause
#include <rio/ti/frame_clock.hpp>
#include <rio/ti/packet_reader.hpp>

int main() {
  rio::ti::FrameTiming timing;
  timing.period = std::chrono::milliseconds(50);
  rio::ti::FrameClock clock(timing);
  rio::ti::PacketReader reader;
  const std::uint8_t bytes[] = {1, 2, 3};
  reader.push(bytes, sizeof bytes, rio::Time{0},
              [&](rio::ti::Frame& frame) { frame.scan.time = clock.stamp(frame); });
  return reader.state() == rio::ti::StreamState::kSearching ? 0 : 1;
}
