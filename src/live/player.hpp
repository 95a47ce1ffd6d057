// SPDX-License-Identifier: BSD-3-Clause
// Scans and samples as timed bytes, as sensors would send them, through a bad cable to a busy host,
// on pseudo-terminals.
#pragma once

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "rio/sim/ti_packet.hpp"
#include "rio/ti/frame_clock.hpp"
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

struct CableCounters {
  std::uint64_t packets = 0;
  std::uint64_t dropped = 0;
  std::uint64_t damaged = 0;
  std::uint64_t delayed = 0;
  std::uint64_t split = 0;
};

/// Bytes that arrive together.
struct Piece {
  Time due{0};
  Bytes bytes;
  CableCounters sent{};  ///< up to the packet that they belong to
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

/// Timing of the simulated radars: chirps of zero length, else the defaults of FrameTiming.
ti::FrameTiming simulated_timing(double rate_hz);

/// The packets of a radar: sent `processing_delay` after the stamps at the rate of the UART.
/// Missing scans leave gaps in the frame numbers.
Cable radar_line(const std::vector<RadarScan>& scans, const ti::FrameTiming& timing, Cable cable);

/// The binary frames of an IMU (imu_stream.hpp), half a millisecond after their stamps.
Cable imu_line(const std::vector<ImuSample>& samples, Cable cable);

/// A piece, and its line.
struct Event {
  const Piece* piece = nullptr;
  std::size_t line = 0;
};
/// The events of all lines in the order of time.
std::vector<Event> in_order(const std::vector<std::vector<Piece>>& lines);

/// Hands out the events when they are due, the first one immediately.
/// @param speed factor of time, 1: real time
/// @param on_event returns false to end
/// @param stop ends it as well
void play(const std::vector<Event>& events, double speed, const volatile std::sig_atomic_t& stop,
          const std::function<bool(const Event&)>& on_event);

/// A pseudo-terminal: a serial line without a cable. This is the side of the device; the path of
/// the other end can be opened like /dev/ttyACM1.
class Pty {
 public:
  /// Throws std::runtime_error if none is available.
  /// @param link if given, a link to the other end, which replaces an older link; removed at the
  /// end
  explicit Pty(std::filesystem::path link = {});
  ~Pty();
  Pty(Pty&& other) noexcept;
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;
  Pty& operator=(Pty&&) = delete;

  const std::string& path() const { return path_; }
  int fd() const { return fd_; }

  /// Some program has the other end open.
  bool is_open() const;
  /// Waits for space if the reader is slow.
  /// @return false if the other end was closed meanwhile, or has no space for five seconds
  bool write(const std::uint8_t* bytes, std::size_t count);
  /// Bytes written by the other end; 0 if none.
  std::size_t read(std::uint8_t* buffer, std::size_t size);

 private:
  int fd_ = -1;
  std::string path_;
  std::filesystem::path link_;
};

}  // namespace rio::live
