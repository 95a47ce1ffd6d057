// SPDX-License-Identifier: BSD-3-Clause
// A radar that sends frames, and how far off their stamps are.
#pragma once

#include <cstdint>

#include "rio/ti/frame_clock.hpp"

namespace rio::ti::test {

/// A radar and its cable: frames with the instants at which they were measured.
class SendingRadar {
 public:
  static constexpr std::uint32_t kBytes = 928;  // 43 points, 10 ms on the wire

  explicit SendingRadar(const FrameTiming& timing, double drift = 0.0)
      : timing_(timing), period_(to_seconds(timing.period) * (1.0 + drift)) {}

  /// Frame `index` after power-on, `pause` later than it would have come.
  Frame frame(std::uint32_t index, Time first_late = Time{0}, Time last_late = Time{0},
              Time pause = Time{0}) {
    begun_ = Time(1'700'000'000'000'000'000) + from_seconds(index * period_) + pause;
    Frame frame;
    frame.number = index;
    frame.bytes = kBytes;
    const Time sent = begun_ + timing_.chirp_block + timing_.processing_delay;
    frame.first_arrival = sent + first_late;
    frame.last_arrival = sent + from_seconds(kBytes * 10 / 921600.0) + last_late;
    return frame;
  }
  Time begun() const { return begun_; }  ///< the frame of the last call
  Time middle() const { return begun_ + timing_.chirp_block / 2; }

 private:
  FrameTiming timing_;
  double period_;
  Time begun_{0};
};

inline FrameTiming usual() {
  FrameTiming timing;
  timing.period = std::chrono::microseconds(66667);
  timing.chirp_block = std::chrono::microseconds(18500);
  return timing;
}

inline double error_of(Time stamp, const SendingRadar& radar) {
  return to_seconds(stamp - radar.middle());
}

}  // namespace rio::ti::test
