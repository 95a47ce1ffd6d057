// SPDX-License-Identifier: BSD-3-Clause
// Measurement times of frames: stamps in the middle of the chirp block, from arrivals that are late
// by a jitter, or from trigger times. C++17.
//
//   |<-- chirp block -->|<-- processing -->|<-- UART: bytes x 10 / baud -->|
//   start     ^stamp                       ^first byte                     ^last byte
//
// The radar starts its frames by its own clock: start(n) = c + n * period * (1 + drift). Bytes can
// only be late, through polling, USB and the scheduler. So of the points (n, arrival of the first
// byte) the least delayed lie on a line and all others above it. The estimate is the line below all
// points of the last minute that is nearest to them on average, an edge of their lower convex hull
// (for exponential jitter the most likely line; Moon, Skelly and Towsley, "Estimation and removal
// of clock skew from network delay measurements", INFOCOM 1999), with a bounded drift.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rio/core/ring.hpp"
#include "rio/ti/packet.hpp"

namespace rio::ti {

/// Timing of a frame, from the configuration of the radar.
struct FrameTiming {
  Time period{0};       ///< of the frames (`frameCfg`); required
  Time chirp_block{0};  ///< loops x chirps x (idle + ramp end)
  /// From the end of the chirp block to the first byte on the wire. Measured: 7.5 ms for an
  /// IWR6843AOP at 40 points; statistics (TLV 6) contain it.
  Time processing_delay = std::chrono::microseconds(7500);
  Time trigger_delay{0};  ///< from the edge of a hardware trigger to the first chirp
  double baud =
      921600.0;  ///< of the data UART, 10 bits a byte; 0: unknown, only the first byte is used
  double max_drift = 2e-4;  ///< of the radar's clock relative to that of the arrivals
  Time window = std::chrono::seconds(60);  ///< length of the arrivals used for the line

  /// @param why what is invalid, if anything
  bool validate(std::string* why = nullptr) const;
};

/// Stamps the frames of one radar without subframes. No allocation after construction. Each frame
/// visits all frames of the window: microseconds.
class FrameClock {
 public:
  /// @param timing must be valid
  explicit FrameClock(const FrameTiming& timing);

  /// The middle of the chirp block; call it once for every frame, in order. If a trigger was at the
  /// start of the frame (within half a period of the arrivals' estimate), its time is used. A frame
  /// whose number or arrival contradicts the line by more than half a period is stamped by its
  /// arrival alone if it is early or more than a second late, and by the line if it is less late (a
  /// busy host) at the configured rate. Five such frames in a row over a second restart the clock
  /// from them.
  Time stamp(const Frame& frame);

  /// A pulse to the radar's trigger input; the newest 16 are kept.
  void add_trigger(Time edge);

  /// Number of frames stamped by their arrival alone.
  int odd() const { return odd_; }
  /// Number of restarts of the line.
  int restarts() const { return restarts_; }
  /// Period of the radar over the configured one, minus one, from the line.
  double drift() const { return slope_ / period_; }
  /// The period by arrivals and numbers of the newest frames [s], if it is significantly and more
  /// than a percent off the configured one: that is wrong, or the numbers do not count the frames.
  /// Told after about 12 frames if it is 20 % off; zero if all frames came at once.
  std::optional<double> other_period() const;

  void reset();

 private:
  /// A frame: x [frames], y = arrival - x * period [s], both since the origin.
  struct Arrival {
    double x = 0.0;
    double y = 0.0;
  };
  struct Counted {
    std::uint32_t number = 0;
    Time first_byte{0};
  };

  Time first_byte(const Frame& frame) const;
  void count(std::uint32_t number, Time first_byte);
  void start(const Frame& frame, Time first_byte);
  Arrival arrival(const Frame& frame, Time first_byte) const;
  void fit();
  bool contradicts(const Frame& frame, Time first_byte, double lateness);
  Time triggered(Time stamp) const;

  FrameTiming timing_;
  double period_;            ///< [s]
  Ring<Counted> newest_;     ///< arrivals apart
  std::size_t at_once_ = 0;  ///< frames that the newest of them stands for, besides it
  Ring<Arrival> window_;
  std::vector<Arrival> hull_;
  double slope_ = 0.0;      ///< of the line [s a frame]
  double intercept_ = 0.0;  ///< [s]
  bool started_ = false;
  std::uint32_t origin_number_ = 0;
  Time origin_time_{0};
  std::uint32_t newest_number_ = 0;
  int run_ = 0;        ///< frames in a row that contradict the line
  Time run_begin_{0};  ///< arrival of the first of them
  int odd_ = 0;
  int restarts_ = 0;
  std::array<Time, 16> triggers_{};
  std::size_t trigger_count_ = 0;
};

}  // namespace rio::ti
