// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate --live`: a simulated flight as bytes on pseudo-terminals.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "live/player.hpp"
#include "live/pty.hpp"
#include "simulate.hpp"
#include "stop_signal.hpp"

namespace rio::tools {

namespace {

namespace fs = std::filesystem;
using live::Cable;
using live::CableNoise;
using live::Pty;

/// The bytes of every sensor, and the names of their ports.
struct Lines {
  std::vector<std::vector<live::Piece>> pieces;
  std::vector<fs::path> ports;
  std::vector<live::CableCounters> counters;
};

Lines lines_of(const fs::path& out, const io::Dataset& flight, CableNoise noise) {
  Lines lines;
  const auto timing = live::simulated_timing(flight.radar_info.rate_hz.value());
  const auto add = [&](const std::string& name, const Cable& cable) {
    lines.pieces.push_back(cable.pieces());
    lines.counters.push_back(cable.counters());
    lines.ports.push_back(out / name / "port");
    ++noise.seed;
  };
  add("imu0", live::imu_line(flight.imu, Cable(noise)));
  add("radar0", live::radar_line(flight.scans, timing, Cable(noise)));
  for (std::size_t r = 0; r < flight.other_radars.size(); ++r) {
    add(fmt::format("radar{}", r + 1),
        live::radar_line(flight.other_radars[r].scans, timing, Cable(noise)));
  }
  return lines;
}

void print(const fs::path& port, const live::CableCounters& cable) {
  fmt::print("{}: {} packets, {} dropped, {} damaged, {} delayed, {} split\n", port.string(),
             cable.packets, cable.dropped, cable.damaged, cable.delayed, cable.split);
}

void pause(int milliseconds) {
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

bool all_open(const std::vector<Pty>& ptys) {
  return std::all_of(ptys.begin(), ptys.end(), [](const Pty& pty) { return pty.is_open(); });
}

}  // namespace

void play_live(const fs::path& out, const io::Dataset& flight, const CableNoise& noise,
               double speed) {
  const Lines lines = lines_of(out, flight, noise);
  catch_stop_signals();
  std::vector<Pty> ptys;
  std::string radars;
  for (const fs::path& port : lines.ports) {
    ptys.emplace_back(port);
    if (&port != &lines.ports.front()) radars += fmt::format(" --radar {}", port.string());
  }
  fmt::print("waiting for: rio live --sensors {}{} --imu {}{}\n", out.string(), radars,
             lines.ports.front().string(), speed == 1.0 ? "" : fmt::format(" --speed {}", speed));
  std::fflush(stdout);
  while (!all_open(ptys) && stop_requested == 0) pause(10);
  live::play(live::in_order(lines.pieces), speed, stop_requested, [&](const live::Event& event) {
    const live::Bytes& bytes = event.piece->bytes;
    (void)ptys[event.line].write(bytes.data(), bytes.size());  // lost without a reader
    return true;
  });
  pause(200);  // unread bytes are lost when a pseudo-terminal is closed
  for (std::size_t i = 0; i < lines.ports.size(); ++i) print(lines.ports[i], lines.counters[i]);
}

}  // namespace rio::tools
