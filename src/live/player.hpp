// SPDX-License-Identifier: BSD-3-Clause
// Scans and samples as the bytes that sensors would send, each at its time.
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

/// Of the simulated radars: chirps without length, then what FrameTiming has by default.
ti::FrameTiming simulated_timing(double rate_hz);

/// The packets of a radar: sent `processing_delay` after the stamps at the rate of the UART. Frames
/// that are missing among the scans are missing in the numbers.
Cable radar_line(const std::vector<RadarScan>& scans, const ti::FrameTiming& timing, Cable cable);

/// The binary frames of an IMU (imu_stream.hpp), half a millisecond after their stamps.
Cable imu_line(const std::vector<ImuSample>& samples, Cable cable);

/// A piece, and whose it is.
struct Event {
  const Piece* piece = nullptr;
  std::size_t line = 0;
};
/// Of all lines in the order of time.
std::vector<Event> in_order(const std::vector<std::vector<Piece>>& lines);

/// Hands out the events when they are due, the first one now.
/// @param speed of the time, 1: as it is
/// @param on_event returns false to end
/// @param stop ends it, too
void play(const std::vector<Event>& events, double speed, const volatile std::sig_atomic_t& stop,
          const std::function<bool(const Event&)>& on_event);

}  // namespace rio::live
