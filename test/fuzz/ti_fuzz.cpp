// SPDX-License-Identifier: BSD-3-Clause
// Bytes of a radar: the same frames in pieces of any size, all finite; every frame has its bytes;
// the packet after them is read with its last byte; no stamp is far from its arrival.
#include <algorithm>
#include <cmath>
#include <vector>

#include "fuzz/fuzz.hpp"
#include "rio/ti/frame_clock.hpp"
#include "rio/ti/packet_reader.hpp"
#include "ti/packets.hpp"

namespace rio::ti {

namespace {

constexpr std::size_t kMaxPacket = 4096;
constexpr Time kPeriod = std::chrono::milliseconds(50);
constexpr Time kFarthest = std::chrono::seconds(3);

struct Seen {
  std::uint32_t number = 0;
  std::uint32_t bytes = 0;
  std::size_t points = 0;
  double sum = 0.0;
  bool operator==(const Seen&) const = default;
};

Seen seen(const Frame& frame) {
  Seen what{frame.number, frame.bytes, frame.scan.detections.size(), 0.0};
  RIO_FUZZ_CHECK(frame.bytes <= kMaxPacket && 8 * what.points < frame.bytes);
  RIO_FUZZ_CHECK(frame.scan.detections.capacity() <= kMaxPacket / 8);  // that of the start
  for (const RadarDetection& d : frame.scan.detections) {
    RIO_FUZZ_CHECK(d.point_S.allFinite() && std::isfinite(d.range_rate));
    RIO_FUZZ_CHECK(std::abs(d.snr_db) <= 65535.0 && std::abs(d.noise_db) <= 65535.0);
    what.sum += d.point_S.sum() + d.range_rate + d.snr_db + d.noise_db;
  }
  return what;
}

void stamp(FrameClock* clock, Time arrival, Frame* frame) {
  const int odd = clock->odd();
  frame->scan.time = clock->stamp(*frame);
  const Time off = frame->scan.time - arrival;
  RIO_FUZZ_CHECK(std::max(off, -off) < kFarthest);
  RIO_FUZZ_CHECK(clock->odd() - odd <= 1 && std::abs(clock->drift()) < 1e-3);
}

}  // namespace

}  // namespace rio::ti

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rio::ti;  // NOLINT
  if (size == 0) return 0;
  const rio::fuzz::TrapFloatingPoint trap(true);
  const std::uint32_t random = data[0] + 1U;
  ++data;
  --size;
  std::vector<Seen> whole, pieces;
  PacketReader reader(kMaxPacket);
  reader.push(data, size, rio::Time{0}, [&](const Frame& frame) { whole.push_back(seen(frame)); });

  FrameTiming timing;
  timing.period = kPeriod;
  FrameClock clock(timing);
  PacketReader other(kMaxPacket);
  rio::Time now = std::chrono::hours(400000);
  const auto take = [&](Frame& frame) {
    pieces.push_back(seen(frame));
    stamp(&clock, now, &frame);
  };
  rio::fuzz::deliver_in_pieces(
      random, data, size, now,
      [&](const std::uint8_t* piece, std::size_t length, rio::Time arrival) {
        now = arrival;
        other.push(piece, length, now, take);
      });
  reader.flush([&](const Frame& frame) { whole.push_back(seen(frame)); });
  other.flush(take);
  RIO_FUZZ_CHECK(whole == pieces && rio::fuzz::same(reader.counters(), other.counters()));
  std::size_t claimed = 0;
  for (const Seen& frame : whole) claimed += frame.bytes - (kMagicSize - 1);
  RIO_FUZZ_CHECK(claimed + reader.counters().bytes_skipped <= size);

  const auto points = test::some_points(12345, 3);
  const test::Bytes last = test::packet_of(12345, points).bytes();
  std::size_t count = 0;
  Seen newest;
  reader.push(last.data(), last.size(), rio::Time{0}, [&](const Frame& frame) {
    newest = seen(frame);
    ++count;
  });
  RIO_FUZZ_CHECK(count >= 1 && newest.number == 12345 && newest.points == 3);
  return 0;
}
