// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate --live`: a simulated flight as bytes on pseudo-terminals.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>

#include "live/player.hpp"
#include "simulate.hpp"
#include "stop_signal.hpp"

namespace rio::tools {

namespace {

namespace fs = std::filesystem;
using live::Cable;
using live::CableNoise;
using live::Pty;
using namespace std::chrono_literals;

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
  const auto is_open = [](const Pty& pty) { return pty.is_open(); };
  while (!std::all_of(ptys.begin(), ptys.end(), is_open) && stop_requested == 0) {
    std::this_thread::sleep_for(10ms);
  }
  live::play(live::in_order(lines.pieces), speed, stop_requested, [&](const live::Event& event) {
    const live::Bytes& bytes = event.piece->bytes;
    (void)ptys[event.line].write(bytes.data(), bytes.size());  // lost without a reader
    return true;
  });
  std::this_thread::sleep_for(200ms);  // unread bytes are lost when a pseudo-terminal is closed
  for (std::size_t i = 0; i < lines.ports.size(); ++i) {
    const live::CableCounters& cable = lines.counters[i];
    fmt::print("{}: {} packets, {} dropped, {} damaged, {} delayed, {} split\n",
               lines.ports[i].string(), cable.packets, cable.dropped, cable.damaged, cable.delayed,
               cable.split);
  }
}

}  // namespace rio::tools
