// SPDX-License-Identifier: BSD-3-Clause
// What the fuzz targets share: bytes turned into values, a failed check, trapped floating point
// exceptions, a folder in memory.
#pragma once

#include <fenv.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

#include "rio/types.hpp"

/// A finding: says where, and ends the program in the way the fuzzer notices.
#define RIO_FUZZ_CHECK(condition)                                                  \
  do {                                                                             \
    if (!(condition)) {                                                            \
      std::fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                \
    }                                                                              \
  } while (false)

namespace rio::fuzz {

/// The fuzzer's bytes, read from the front; zeros when they are used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  bool empty() const { return size_ == 0; }
  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  int below(int limit) { return byte() % limit; }
  template <class T, std::size_t n>
  const T& one_of(const T (&list)[n]) {
    return list[byte() % n];
  }
  std::int16_t word() {
    const int low = byte();
    return static_cast<std::int16_t>(low | byte() << 8);
  }

  /// Mostly of the size that sensors say, else one that arithmetic stumbles over.
  double real() {
    using Limits = std::numeric_limits<double>;
    constexpr double kLeast = Limits::denorm_min(), kNan = Limits::quiet_NaN();
    constexpr double kMax = Limits::max(), kInf = Limits::infinity();
    constexpr double kOdd[] = {
        0.0,   -0.0,   1.0,    -1.0,   1e-9, 1e3,   1.1e3, -1e4,  1e9,  1e154,
        1e300, -1e300, 1e-300, kLeast, kMax, -kMax, kInf,  -kInf, kNan, 3.14159265358979};
    const std::size_t kind = byte();
    if (kind < std::size(kOdd)) return kOdd[kind];
    if (kind == 255) return any();
    return word() * (kind % 2 == 0 ? 1e-3 : 1e-2);
  }

 private:
  double any() {
    std::array<std::uint8_t, sizeof(double)> bytes;
    for (std::uint8_t& b : bytes) b = byte();
    return std::bit_cast<double>(bytes);
  }

  const std::uint8_t* data_;
  std::size_t size_;
};

/// While it lives, an invalid operation, a division by zero and an overflow end the program.
class TrapFloatingPoint {
 public:
  explicit TrapFloatingPoint(bool on) : on_(on) {
    if (!on_) return;
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  }
  ~TrapFloatingPoint() {
    if (on_) fedisableexcept(FE_ALL_EXCEPT);
  }
  TrapFloatingPoint(const TrapFloatingPoint&) = delete;
  TrapFloatingPoint& operator=(const TrapFloatingPoint&) = delete;

 private:
  bool on_;
};

/// Bytes as a port delivers them: push(piece, its size, time) for pieces of random size at random
/// times from `now` on.
template <class Push>
void deliver_in_pieces(std::uint32_t random, const std::uint8_t* data, std::size_t size, Time now,
                       const Push& push) {
  for (std::size_t at = 0; at < size;) {
    random = random * 1664525U + 1013904223U;
    const std::size_t piece = std::min<std::size_t>(1 + (random >> 24) % 97, size - at);
    now += std::chrono::microseconds(random >> 12 & 0xFFFF);
    push(data + at, piece, now);
    at += piece;
  }
}

/// To the last bit; a value that is no number is the same as itself.
template <class T>
bool same(const T& a, const T& b) {
  const auto* bytes = reinterpret_cast<const std::byte*>(&a);
  return std::equal(bytes, bytes + sizeof a, reinterpret_cast<const std::byte*>(&b));
}

inline std::string text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Whether `read` reads its file; else it must throw a std::runtime_error that begins with `name`.
template <class Read>
bool reads(const std::string& name, const Read& read) {
  try {
    read();
    return true;
  } catch (const std::runtime_error& error) {
    RIO_FUZZ_CHECK(std::string(error.what()).rfind(name, 0) == 0);
    return false;
  }
}

}  // namespace rio::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
