// SPDX-License-Identifier: BSD-3-Clause
// Scans and samples as timed bytes, as sensors would send them.
#pragma once

#include <csignal>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "live/cable.hpp"
#include "rio/ti/frame_clock.hpp"
#include "rio/types.hpp"

namespace rio::live {

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

}  // namespace rio::live
