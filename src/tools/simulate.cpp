// SPDX-License-Identifier: BSD-3-Clause
// `rio simulate`: a flight of a scenario with exact truth, written as a dataset. `rio scenarios`:
// the catalogue of them, or one with units and meaning. With --live the flight is played as bytes
// on pseudo-terminals.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "commands.hpp"
#include "live/player.hpp"
#include "outputs.hpp"
#include "progress.hpp"
#include "recording.hpp"
#include "rio/io/simulation.hpp"
#include "rio/sim/catalogue.hpp"
#include "rio/sim/flight.hpp"
#include "stop_signal.hpp"

namespace rio::tools {

namespace {

namespace fs = std::filesystem;

struct Simulated {
  sim::Flight flight;
  io::Dataset dataset;  ///< as written
};

sim::Scenario make_scenario(const SimulateArguments& arguments) {
  sim::Scenario scenario;
  if (!arguments.scenario.empty()) scenario = io::load_scenario(arguments.scenario);
  if (arguments.ideal) {
    scenario.imu = sim::ImuModel::ideal();
    scenario.radar = sim::RadarModel::ideal();
  }
  if (arguments.seed) scenario.seed = *arguments.seed;
  if (!arguments.trajectory.empty()) scenario.path.file = arguments.trajectory;
  if (arguments.length) {
    if (!scenario.path.file.empty()) {
      throw std::runtime_error("--length does not act on a recorded path, " + scenario.path.file);
    }
    scenario.path.length = *arguments.length;
  }
  // scenario.yaml is written into another folder
  if (!scenario.path.file.empty()) {
    scenario.path.file = fs::absolute(scenario.path.file).lexically_normal().string();
  }
  return scenario;
}

std::string labels_text(const sim::Flight& flight) {
  std::string text = "#timestamp [ns],detection,label,reflector\n";
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    for (std::size_t k = 0; k < flight.labels[i].size(); ++k) {
      const sim::Label& label = flight.labels[i][k];
      text += fmt::format("{},{},{},{}\n", flight.scans[i].time.count(), k,
                          sim::to_string(label.cause), label.reflector);
    }
  }
  return text;
}

/// For `rio replay --init`: the first state as configured by the scenario.
std::string start_text(const sim::Flight& flight) {
  const NavState start = flight.configured_start();
  const Vector3d& v = start.v_WB;
  const Vector3d& p = start.p_WB;
  const Quaternion& q = start.q_WB;
  return fmt::format(
      "# A start for `rio replay --init`: velocity or attitude are wrong as the scenario says, "
      "1-sigma of the velocity per axis.\n"
      "time_ns: {}\nposition: [{}, {}, {}]\nquaternion_wxyz: [{}, {}, {}, {}]\n"
      "velocity: [{}, {}, {}]\nsigma:\n  velocity: {}\n",
      start.time.count(), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z(),
      flight.scenario.errors.start_velocity_sigma);
}

/// The data of another radar on the same flight.
io::Dataset::OtherRadar other_radar(const sim::Flight& flight, const Pose& T_BS) {
  sim::Scenario scenario = flight.scenario;
  scenario.radar.T_BS = T_BS;
  const sim::Flight other = sim::simulate_flight(flight.trajectory, scenario);
  return {other.scans, io::radar_info_of(scenario.radar, other.configured_T_BS)};
}

io::Dataset dataset_of(const sim::Flight& flight, std::size_t radars) {
  io::Dataset dataset = io::dataset_of(flight);
  const std::vector<Pose> mounts = sim::radar_mounts(flight.scenario.radar.T_BS, radars);
  for (std::size_t r = 1; r < radars; ++r) {
    dataset.other_radars.push_back(other_radar(flight, mounts[r]));
  }
  return dataset;
}

void write(const fs::path& out, const sim::Flight& flight, const io::Dataset& dataset) {
  const fs::path start = out / "start.yaml";
  if (fs::exists(out / "imu0") && !fs::exists(out / "scenario.yaml")) {
    throw std::runtime_error(out.string() + ": holds a recording that is no simulated flight");
  }
  if (!flight.scenario.errors.starts_wrongly() && fs::exists(start)) {
    throw std::runtime_error(start.string() + ": is left from another recording");
  }
  io::write_dataset(out, dataset);
  write_text(out / "radar0" / "labels.csv", labels_text(flight));
  write_text(out / "scenario.yaml", io::scenario_as_yaml(flight.scenario));
  if (flight.scenario.errors.starts_wrongly()) write_text(start, start_text(flight));
}

void print_summary(const SimulateArguments& arguments, const sim::Flight& flight,
                   const io::Dataset& dataset) {
  std::map<sim::Cause, std::size_t> counts;
  std::size_t detections = 0;
  for (const auto& scan : flight.labels) {
    detections += scan.size();
    for (const sim::Label& label : scan) ++counts[label.cause];
  }
  double length = 0.0;  // that was flown: max_duration may have cut the path
  double top_speed = 0.0;
  const NavState* last = &flight.truth.front();
  for (const NavState& state : flight.truth) {
    length += (state.p_WB - last->p_WB).norm();
    top_speed = std::max(top_speed, state.v_WB.norm());
    last = &state;
  }
  const double seconds = to_seconds(flight.truth.back().time - flight.truth.front().time);
  fmt::print(
      "{}: {}, seed {}, {:.1f} m in {:.1f} s at up to {:.2f} m/s, {} IMU samples, {}, "
      "{} detections{}",
      arguments.out, arguments.scenario.empty() ? "default" : arguments.scenario,
      flight.scenario.seed, length, seconds, top_speed, flight.imu.size(), scans_text(dataset),
      detections, dataset.other_radars.empty() ? "" : " of radar0");
  const char* separator = ": ";
  for (const auto& [cause, count] : counts) {
    fmt::print("{}{:.1f} % {}", separator,
               100.0 * static_cast<double>(count) / static_cast<double>(detections),
               sim::to_string(cause));
    separator = ", ";
  }
  fmt::print("\n");
}

/// The bytes of every sensor, and the names of their ports.
struct Lines {
  std::vector<std::vector<live::Piece>> pieces;
  std::vector<fs::path> ports;
  std::vector<live::CableCounters> counters;
};

Lines lines_of(const fs::path& out, const io::Dataset& flight, live::CableNoise noise) {
  Lines lines;
  const auto timing = live::simulated_timing(flight.radar_info.rate_hz.value());
  const auto add = [&](const std::string& name, const live::Cable& cable) {
    lines.pieces.push_back(cable.pieces());
    lines.counters.push_back(cable.counters());
    lines.ports.push_back(out / name / "port");
    ++noise.seed;
  };
  add("imu0", live::imu_line(flight.imu, live::Cable(noise)));
  add("radar0", live::radar_line(flight.scans, timing, live::Cable(noise)));
  for (std::size_t r = 0; r < flight.other_radars.size(); ++r) {
    add(fmt::format("radar{}", r + 1),
        live::radar_line(flight.other_radars[r].scans, timing, live::Cable(noise)));
  }
  return lines;
}

/// Waits until OUT/imu0/port, OUT/radar0/port, ... are all open, then sends the sensor data in
/// time. Ends with the flight, or at a signal.
/// @param noise its seed is that of the first cable
/// @param speed factor of time
void play_live(const fs::path& out, const io::Dataset& flight, const live::CableNoise& noise,
               double speed) {
  const Lines lines = lines_of(out, flight, noise);
  catch_stop_signals();
  std::vector<live::Pty> ptys;
  std::string radars;
  for (const fs::path& port : lines.ports) {
    ptys.emplace_back(port);
    if (&port != &lines.ports.front()) radars += fmt::format(" --radar {}", port.string());
  }
  fmt::print("waiting for: rio live --sensors {}{} --imu {}{}\n", out.string(), radars,
             lines.ports.front().string(), speed == 1.0 ? "" : fmt::format(" --speed {}", speed));
  std::fflush(stdout);
  const auto is_open = [](const live::Pty& pty) { return pty.is_open(); };
  while (!std::all_of(ptys.begin(), ptys.end(), is_open) && stop_requested == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::vector<live::CableCounters> sent(lines.ports.size());
  Time played{0};
  const std::vector<live::Event> events = live::in_order(lines.pieces);
  live::play(events, speed, stop_requested, [&](const live::Event& event) {
    sent[event.line] = event.piece->sent;
    played = event.piece->due - events.front().piece->due;
    const live::Bytes& bytes = event.piece->bytes;
    (void)ptys[event.line].write(bytes.data(), bytes.size());  // lost without a reader
    return true;
  });
  // unread bytes are lost when a pseudo-terminal is closed
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  if (stop_requested == 0) {
    sent = lines.counters;  // those dropped at the end, too
  } else {
    fmt::print("stopped after {:.1f} s\n", to_seconds(played));
  }
  for (std::size_t i = 0; i < lines.ports.size(); ++i) {
    const live::CableCounters& cable = sent[i];
    fmt::print("{}: {} packets, {} dropped, {} damaged, {} delayed, {} split\n",
               lines.ports[i].string(), cable.packets, cable.dropped, cable.damaged, cable.delayed,
               cable.split);
  }
}

/// Writes the folder `arguments.out`.
Simulated fly_and_write(const SimulateArguments& arguments) {
  if (arguments.out.empty()) throw std::runtime_error("simulate: the name of the folder is empty");
  Simulated out;
  {
    Progress progress(true);
    out.flight = io::fly_scenario(make_scenario(arguments), [&](std::size_t done, std::size_t all) {
      progress.show(done, all);
    });
  }
  out.dataset = dataset_of(out.flight, arguments.radars);
  write(arguments.out, out.flight, out.dataset);
  return out;
}

}  // namespace

void run_simulate(const SimulateArguments& arguments) {
  (void)fly_and_write(arguments);
}

void simulate(const SimulateArguments& arguments) {
  const auto [flight, dataset] = fly_and_write(arguments);
  print_summary(arguments, flight, dataset);
  if (flight.scenario.radar.latency > 0.0) {
    fmt::print("note: a recording holds stamps only, radar.latency acts in experiments\n");
  }
  if (flight.scenario.errors.starts_wrongly()) {
    fmt::print("note: starts wrongly with rio replay {0} --init {0}/start.yaml\n", arguments.out);
  }
  if (!arguments.live) return;
  live::CableNoise noise = arguments.cable;
  noise.seed = flight.scenario.seed;
  play_live(arguments.out, dataset, noise, arguments.speed);
}

void scenarios(const std::string& name_or_file) {
  if (!name_or_file.empty()) {
    fmt::print("{}", io::scenario_as_yaml(io::load_scenario(name_or_file)));
    return;
  }
  for (const sim::CatalogueEntry& entry : sim::catalogue()) {
    fmt::print("{:16}{}\n", entry.name, entry.summary);
  }
}

}  // namespace rio::tools
