// SPDX-License-Identifier: BSD-3-Clause
#include "live/imu_stream.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

#include "rio/mavlink/frame.hpp"

namespace rio::live {
namespace {

constexpr std::uint8_t kStart[] = {'R', 'I', 1};  // magic and version
constexpr std::size_t kSequence = 3;
constexpr std::size_t kStamp = 4;
constexpr std::size_t kRate = 12;
constexpr std::size_t kForce = 24;
constexpr std::size_t kCrc = 36;

std::uint16_t checksum(const std::uint8_t* frame) {
  mavlink::Crc16 crc;
  crc.add(frame + 2, kCrc - 2);
  return crc.value();
}

template <class T>
void put(T value, std::uint8_t* at) {
  mavlink::detail::put(value, at);
}
template <class T>
T get(const std::uint8_t* at) {
  T value{};
  mavlink::detail::get(at, &value);
  return value;
}

void put(const Vector3d& v, std::uint8_t* at) {
  for (int i = 0; i < 3; ++i) put(static_cast<float>(v[i]), at + 4 * i);
}
Vector3d vector_at(const std::uint8_t* at) {
  return {get<float>(at), get<float>(at + 4), get<float>(at + 8)};
}

/// Reads a number and, except for the last one, the comma after it.
template <class T>
bool read_field(const char** at, const char* end, bool last, T* value) {
  while (*at < end && (**at == ' ' || **at == '+')) ++*at;
  const auto [next, error] = std::from_chars(*at, end, *value);
  if (error != std::errc()) return false;
  *at = next;
  if (last) return next == end || *next == '\r' || *next == ',';
  if (next == end || *next != ',') return false;
  ++*at;
  return true;
}

bool read_line(const std::string& line, ImuSample* sample) {
  const char* at = line.data();
  const char* end = at + line.size();
  std::int64_t stamp = 0;
  if (!read_field(&at, end, false, &stamp)) return false;
  sample->time = Time(stamp);
  for (int i = 0; i < 6; ++i) {
    double& value = i < 3 ? sample->gyro_B[i] : sample->accel_B[i - 3];
    if (!read_field(&at, end, i == 5, &value)) return false;
  }
  return true;
}

}  // namespace

std::array<std::uint8_t, kImuFrame> imu_frame(const ImuSample& sample, std::uint8_t sequence) {
  std::array<std::uint8_t, kImuFrame> frame{};
  std::copy(std::begin(kStart), std::end(kStart), frame.begin());
  frame[kSequence] = sequence;
  put(static_cast<std::int64_t>(sample.time.count()), frame.data() + kStamp);
  put(sample.gyro_B, frame.data() + kRate);
  put(sample.accel_B, frame.data() + kForce);
  put(checksum(frame.data()), frame.data() + kCrc);
  return frame;
}

bool ImuFrameReader::may_be_frame() const {
  return std::equal(frame_.begin(),
                    frame_.begin() + static_cast<int>(std::min(stored_, sizeof kStart)),
                    std::begin(kStart));
}

void ImuFrameReader::shift() {
  std::memmove(frame_.data(), frame_.data() + 1, --stored_);
}

/// A frame is complete; an invalid one is searched for another one inside.
bool ImuFrameReader::take() {
  if (get<std::uint16_t>(frame_.data() + kCrc) != checksum(frame_.data())) {
    ++counters_.damaged;
    do {
      shift();
    } while (stored_ > 0 && !may_be_frame());
    return false;
  }
  const std::uint8_t sequence = frame_[kSequence];
  if (counters_.samples > 0) counters_.lost += static_cast<std::uint8_t>(sequence - expected_);
  expected_ = static_cast<std::uint8_t>(sequence + 1);
  ++counters_.samples;
  sample_.time = Time(get<std::int64_t>(frame_.data() + kStamp));
  sample_.gyro_B = vector_at(frame_.data() + kRate);
  sample_.accel_B = vector_at(frame_.data() + kForce);
  stored_ = 0;
  return true;
}

bool ImuLineReader::take() {
  if (line_.empty() || line_[0] == '#' || line_[0] == '\r') return false;
  if (line_.size() >= kLongest || !read_line(line_, &sample_)) {
    ++counters_.damaged;
    return false;
  }
  ++counters_.samples;
  return true;
}

}  // namespace rio::live
