// SPDX-License-Identifier: BSD-3-Clause
// Encodes numbers and texts as bytes, little-endian: packed as in the records of MCAP, or in CDR.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace rio::bag {

/// Packed; a text is preceded by its length (32 bits).
class ByteWriter {
 public:
  template <class T>
  ByteWriter& put(T value) {
    if constexpr (std::is_floating_point_v<T>) {
      return put(
          std::bit_cast<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>(value));
    } else {
      for (std::size_t i = 0; i < sizeof(T); ++i) {
        bytes_ += static_cast<char>(static_cast<std::uint64_t>(value) >> (8 * i));
      }
      return *this;
    }
  }
  ByteWriter& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  ByteWriter& block(std::string_view bytes) {
    return put(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }

  const std::string& bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }
  void clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

/// CDR of ROS 2 (XCDR1): every number aligned to its size, counted from the end of the first four
/// bytes; a text is zero-terminated, and its length includes the zero.
class CdrWriter {
 public:
  CdrWriter() { bytes_.put(std::uint32_t{0x100}); }

  template <class T>
  CdrWriter& put(T value) {
    while (bytes_.size() % sizeof(T) != kHead % sizeof(T)) bytes_.put(std::uint8_t{0});
    bytes_.put(value);
    return *this;
  }
  CdrWriter& text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.raw(text).put(std::uint8_t{0});
    return *this;
  }
  CdrWriter& block(std::string_view bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    bytes_.raw(bytes);
    return *this;
  }
  const std::string& bytes() const { return bytes_.bytes(); }

 private:
  static constexpr std::size_t kHead = 4;

  ByteWriter bytes_;
};

}  // namespace rio::bag
