// SPDX-License-Identifier: BSD-3-Clause
// Decodes numbers and strings from bytes, never past their end.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rio::bag {

using Bytes = std::span<const std::uint8_t>;

/// Invalid bytes, with their position.
struct Damage : std::runtime_error {
  Damage(std::uint64_t where, const std::string& what) : std::runtime_error(what), offset(where) {}
  std::uint64_t offset;
};

/// The number of type T in the first sizeof(T) bytes.
template <class T>
T number_at(const std::uint8_t* bytes, bool big_endian) {
  std::array<std::uint8_t, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes, sizeof(T));
  if (big_endian != (std::endian::native == std::endian::big)) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

/// Sequential reader. Reading past the end throws Damage with the position in `bytes`.
class WireReader {
 public:
  /// Little-endian without gaps: containers and ROS 1.
  explicit WireReader(Bytes bytes) : bytes_(bytes) {}
  /// Plain CDR (DDS-XTypes 1.3, 7.4): four bytes with the byte order, then numbers aligned to their
  /// size, in version 2 to four at most; strings are zero-terminated.
  static WireReader cdr(Bytes bytes) {
    WireReader reader(bytes);
    const std::uint8_t kind = reader.skip(4)[1];
    if (bytes[0] != 0 || (kind > 1 && kind != 6 && kind != 7)) {
      throw Damage(0, "serialised in another way than plain CDR");
    }
    reader.cdr_ = true;
    reader.big_endian_ = kind % 2 == 0;
    reader.max_align_ = kind > 1 ? 4 : 8;
    return reader;
  }

  bool is_cdr() const { return cdr_; }
  std::size_t position() const { return position_; }
  std::size_t remaining() const { return bytes_.size() - position_; }

  template <class T>
  T read() {
    if (cdr_) {
      const std::size_t align = std::min(sizeof(T), max_align_);
      skip((align - (position_ - 4) % align) % align);
    }
    return number_at<T>(skip(sizeof(T)).data(), big_endian_);
  }

  /// The next `count` bytes.
  Bytes skip(std::uint64_t count) {
    if (count > remaining()) {
      throw Damage(position_, "needs " + std::to_string(count) + " bytes where " +
                                  std::to_string(remaining()) + " are left");
    }
    const Bytes part = bytes_.subspan(position_, static_cast<std::size_t>(count));
    position_ += static_cast<std::size_t>(count);
    return part;
  }

  /// A length of four bytes, and as many bytes.
  Bytes block() { return skip(read<std::uint32_t>()); }

  std::string_view text() {
    const Bytes part = block();
    std::string_view text(reinterpret_cast<const char*>(part.data()), part.size());
    if (cdr_ && !text.empty() && text.back() == '\0') text.remove_suffix(1);
    return text;
  }

 private:
  Bytes bytes_;
  std::size_t position_ = 0;
  bool cdr_ = false;
  bool big_endian_ = false;
  std::size_t max_align_ = 1;
};

}  // namespace rio::bag
