// SPDX-License-Identifier: BSD-3-Clause
// Simulates a bad cable and a busy host.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "rio/sim/ti_packet.hpp"
#include "rio/types.hpp"

namespace rio::live {

using sim::Bytes;

/// Shares of the packets, 0 to 1, each drawn independently.
struct CableNoise {
  double dropped = 0.0;  ///< never arrive
  double damaged = 0.0;  ///< a run of 1 to 64 of their bytes is lost, as in a UART overrun
  double delayed = 0.0;  ///< late by 20 ms on average, exponential; later packets wait
  double split = 0.0;    ///< in two to five pieces, 1 ms apart
  std::uint64_t seed = 1;
};

/// Bytes that arrive together.
struct Piece {
  Time due{0};
  Bytes bytes;
};

struct CableCounters {
  std::uint64_t packets = 0;
  std::uint64_t dropped = 0;
  std::uint64_t damaged = 0;
  std::uint64_t delayed = 0;
  std::uint64_t split = 0;
};

/// One line. Bytes arrive in the order of sending. The same seed and packets give the same pieces.
class Cable {
 public:
  explicit Cable(const CableNoise& noise) : noise_(noise), random_(noise.seed) {}

  /// @param due arrival of the last byte of the packet over a good cable; increasing
  void send(Bytes packet, Time due);

  const std::vector<Piece>& pieces() const { return pieces_; }
  const CableCounters& counters() const { return counters_; }

 private:
  bool happens(double share);
  std::size_t draw(std::size_t least, std::size_t most);
  void cut(const Bytes& packet, Time due);

  CableNoise noise_;
  std::mt19937_64 random_;
  std::vector<Piece> pieces_;
  CableCounters counters_;
};

}  // namespace rio::live
