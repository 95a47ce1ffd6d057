// SPDX-License-Identifier: BSD-3-Clause
// Bytes of an autopilot: the same packets in pieces of any size; samples finite; answers of any
// clock; the frame after them is read with its last byte, unless it completes one of them.
#include <vector>

#include "fuzz/fuzz.hpp"
#include "rio/mavlink/imu.hpp"
#include "rio/mavlink/parser.hpp"
#include "rio/mavlink/timesync.hpp"

namespace rio::mavlink {

namespace {

struct Seen {
  std::uint32_t id = 0;
  int sequence = 0;
  std::array<std::uint8_t, kMaxPayload> payload{};
  bool operator==(const Seen&) const = default;
};

void check_sample(const ImuSample& sample) {
  RIO_FUZZ_CHECK(sample.gyro_B.allFinite() && sample.accel_B.allFinite());
  RIO_FUZZ_CHECK(sample.time >= Time{0});
}

/// What a receiver does with a packet.
Seen use(const Packet& packet, TimesyncClient* client) {
  HighresImu highres;
  ScaledImu scaled;
  RawImu raw;
  Timesync timesync;
  if (packet.read(&highres)) {
    if (const auto sample = imu_sample(highres)) check_sample(*sample);
  }
  if (packet.read(&scaled)) check_sample(imu_sample(scaled));
  if (packet.read(&raw)) check_sample(imu_sample(raw));
  if (packet.read(&timesync)) {
    const Time now = packet.arrival;
    const Time late = now + std::chrono::milliseconds(3);
    client->take(timesync, now);
    timesync.ts1 = client->ask(now).ts1;
    const bool taken = client->take(timesync, late);
    RIO_FUZZ_CHECK(!taken || timesync.tc1 != 0);
    RIO_FUZZ_CHECK(client->bound(late) >= Time{0});
    RIO_FUZZ_CHECK(timesync_answer(timesync, packet.from, now).has_value() == (timesync.tc1 == 0));
  }
  return {packet.id, packet.sequence, packet.payload};
}

}  // namespace

}  // namespace rio::mavlink

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rio::mavlink;  // NOLINT
  if (size == 0) return 0;
  const rio::fuzz::TrapFloatingPoint trap(true);
  const std::uint32_t random = data[0] + 1U;
  ++data;
  --size;
  std::vector<Seen> whole, pieces;
  TimesyncClient client;
  const rio::Time now = std::chrono::hours(400000);
  Parser parser;
  parser.push(data, size, now,
              [&](const Packet& packet) { whole.push_back(use(packet, &client)); });

  Parser other;
  rio::fuzz::deliver_in_pieces(
      random, data, size, now,
      [&](const std::uint8_t* piece, std::size_t length, rio::Time arrival) {
        other.push(piece, length, arrival,
                   [&](const Packet& packet) { pieces.push_back(use(packet, &client)); });
      });
  RIO_FUZZ_CHECK(whole == pieces && rio::fuzz::same(parser.counters(), other.counters()));
  RIO_FUZZ_CHECK(parser.counters().bytes == size && parser.counters().frame_bytes <= size);

  Writer writer;
  std::uint8_t frame[kMaxFrame];
  Heartbeat heartbeat;
  heartbeat.custom_mode = 4711;
  const std::size_t length = writer.write(heartbeat, frame, sizeof frame);
  bool another = false;
  const auto is_read = [&] {
    std::uint32_t mode = 0;
    parser.push(frame, length, now, [&](const Packet& packet) {
      Heartbeat received;
      if (packet.read(&received)) mode = received.custom_mode;
      another = true;
    });
    return mode == 4711;
  };
  // its first bytes may complete a frame that lacked them
  RIO_FUZZ_CHECK(is_read() || another);
  parser.drop_pending();
  RIO_FUZZ_CHECK(is_read());
  return 0;
}
