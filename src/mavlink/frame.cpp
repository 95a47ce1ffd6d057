// SPDX-License-Identifier: BSD-3-Clause
#include "rio/mavlink/frame.hpp"

#include <cstring>

namespace rio::mavlink {
namespace {

template <class Message>
constexpr MessageKind kind_of(const char* name) {
  return {name, Message::kId, Message::kCrcExtra, Message::kBasicSize};
}
constexpr MessageKind kKinds[] = {
    kind_of<Heartbeat>("HEARTBEAT"), kind_of<ScaledImu>("SCALED_IMU"),
    kind_of<RawImu>("RAW_IMU"),      kind_of<HighresImu>("HIGHRES_IMU"),
    kind_of<Timesync>("TIMESYNC"),   kind_of<OdometryMessage>("ODOMETRY")};

}  // namespace

const MessageKind* find_message(std::uint32_t id) {
  for (const MessageKind& kind : kKinds) {
    if (kind.id == id) return &kind;
  }
  return nullptr;
}

void Crc16::add(const std::uint8_t* bytes, std::size_t count) {
  constexpr unsigned kReflected = 0x8408;
  for (std::size_t i = 0; i < count; ++i) {
    unsigned value = value_ ^ static_cast<unsigned>(bytes[i]);
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1U) != 0U ? kReflected : 0U);
    value_ = static_cast<std::uint16_t>(value);
  }
}

std::size_t Writer::frame(std::uint32_t id, std::uint8_t crc_extra, const std::uint8_t* payload,
                          std::size_t length, std::uint8_t* buffer, std::size_t size) {
  while (length > 1 && payload[length - 1] == 0) --length;
  if (size < kHeaderV2 + length + kChecksum) return 0;
  const std::uint8_t header[kHeaderV2] = {kMagicV2,
                                          static_cast<std::uint8_t>(length),
                                          0,
                                          0,
                                          sequence_++,
                                          from_.system,
                                          from_.component,
                                          static_cast<std::uint8_t>(id),
                                          static_cast<std::uint8_t>(id >> 8),
                                          static_cast<std::uint8_t>(id >> 16)};
  std::memcpy(buffer, header, kHeaderV2);
  std::memcpy(buffer + kHeaderV2, payload, length);
  Crc16 crc;
  crc.add(buffer + 1, kHeaderV2 - 1 + length);
  crc.add(&crc_extra, 1);
  std::uint8_t* end = buffer + kHeaderV2 + length;
  end[0] = static_cast<std::uint8_t>(crc.value());
  end[1] = static_cast<std::uint8_t>(crc.value() >> 8);
  return kHeaderV2 + length + kChecksum;
}

}  // namespace rio::mavlink
