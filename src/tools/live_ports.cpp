// SPDX-License-Identifier: BSD-3-Clause
#include "live_ports.hpp"

#include <fmt/format.h>
#include <poll.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "live/host_clock.hpp"
#include "live/port.hpp"
#include "rio/ti/config_sender.hpp"
#include "stop_signal.hpp"

namespace rio::tools {

namespace {

constexpr int kCliBaud = 115200;

/// Sensor properties from the configuration, if the sensor file does not have them.
void complete(io::RadarInfo* info, const ti::ConfigFigures& figures, const std::string& path) {
  constexpr double kSame = 0.02;  // of the value; files are rounded
  const auto set = [&path](std::optional<double>* to, double value, const char* key) {
    if (to->has_value() && key != nullptr && std::abs(**to - value) > kSame * value) {
      print_notes({fmt::format("radar0/sensor.yaml has {} {:.4g}, {} {:.4g}: correct the wrong one",
                               key, **to, path, value)});
    }
    if (!to->has_value()) *to = value;
  };
  set(&info->rate_hz, figures.frame_rate(), "rate_hz");
  set(&info->max_doppler, figures.max_speed, "max_doppler_mps");
  set(&info->doppler_resolution, figures.speed_grid, "doppler_resolution_mps");
  set(&info->range_resolution, figures.range_grid, "range_resolution_m");
  set(&info->max_range, figures.max_range, nullptr);  // a limit that a user chooses, too
}

/// Of the sensor file of radar r, or of the first one if that has none.
Time period_of(const io::Dataset& sensors, std::size_t r) {
  std::optional<double> rate = sensors.radar_info.rate_hz;
  if (r > 0 && sensors.other_radars[r - 1].info.rate_hz) {
    rate = sensors.other_radars[r - 1].info.rate_hz;
  }
  if (!rate || *rate <= 0.0) {
    throw std::runtime_error(
        fmt::format("the frame rate of the radar is not known: give --radar-cfg, or rate_hz in "
                    "radar{}/sensor.yaml of --sensors",
                    r));
  }
  return from_seconds(1.0 / *rate);
}

ti::ConfigFigures figures_of(const std::string& path, const ti::Config& config) {
  ti::ConfigFigures figures;
  std::string why;
  if (!ti::derive(config, &figures, &why)) throw std::runtime_error(path + ": " + why);
  return figures;
}

/// The errors of a configuration for odometry.
void note_errors(const std::string& path, const ti::Config& config) {
  for (const ti::LintFinding& finding : ti::lint(config)) {
    if (!finding.wrong || finding.kind == ti::LintKind::kOtherFirmware) continue;
    fmt::print(stderr, "note: {}:{}: {}: {}\n", path, finding.line, to_string(finding.kind),
               finding.text);
  }
}

/// Passes on the answer of the port within a tenth of a second.
void listen(live::Port* port, ti::ConfigSender* sender) {
  pollfd ask{port->fd(), POLLIN, 0};
  if (poll(&ask, 1, 100) != 1) return;
  std::uint8_t buffer[4096];
  const std::size_t count = port->read(buffer, sizeof buffer);
  if (port->fd() < 0) throw std::runtime_error(port->name() + ": vanished");
  sender->receive(buffer, count);
}

bool write(live::Port* port, const std::string& text) {
  return port->write(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

ti::Config read_config(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    throw std::runtime_error(path + ": is a folder: give a file in it");
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) throw std::runtime_error(path + ": cannot be read");
  return ti::parse_config(text);
}

LiveSensors find_sensors(const LiveArguments& arguments) {
  LiveSensors sensors;
  if (arguments.sensors.empty()) {
    print_notes({"no --sensors: mounting and noise by the options"});
  } else {
    sensors.info = io::read_sensor_info(arguments.sensors);
    print_notes(sensors.info.notes);
  }
  sensors.info.other_radars.resize(arguments.radars.size() - 1);
  const std::string& path = arguments.radar_cfg;
  if (!path.empty()) sensors.config = read_config(path);
  const ti::Firmware* other = ti::other_firmware(sensors.config);
  ti::FrameTiming timing;
  if (other != nullptr) {
    print_notes({fmt::format("{}: the configuration of {}: the frame rate is that of --sensors",
                             path, other->name)});
  }
  const bool configured = other == nullptr && !path.empty();
  if (other != nullptr) timing.baud = other->baud;
  if (configured) {
    const ti::ConfigFigures figures = figures_of(path, sensors.config);
    complete(&sensors.info.radar_info, figures, path);
    timing.period = figures.period;
    timing.chirp_block = figures.chirp_block;
    timing.baud = figures.baud;
  }
  if (!path.empty()) note_errors(path, sensors.config);
  sensors.setup.options = make_options(arguments.estimator, sensors.info);
  sensors.setup.options.timing.clock = &live::HostClock::real;
  for (std::size_t r = 0; r < arguments.radars.size(); ++r) {
    ti::FrameTiming& of_it = sensors.setup.radars.emplace_back(timing);
    if (!configured) of_it.period = period_of(sensors.info, r);
    of_it.baud = live::Port(arguments.radars[r], static_cast<int>(timing.baud)).baud();
  }
  sensors.setup.imu_on_host_clock = arguments.imu_clock == "host";
  return sensors;
}

void send_config(const std::string& port_name, const ti::Config& config) {
  live::Port port(port_name, kCliBaud);
  if (!port.open()) throw std::runtime_error(port_name + ": is not there");
  ti::ConfigSender sender(config);
  while (!sender.over() && stop_requested == 0) {
    const std::string line = sender.to_send(live::HostClock::real());
    if (!line.empty() && !write(&port, line))
      throw std::runtime_error(port_name + ": takes nothing");
    if (!sender.over()) listen(&port, &sender);
  }
  if (!sender.error().empty()) throw std::runtime_error(port_name + ": " + sender.error());
}

void stop_radar(const std::string& port_name) {
  live::Port port(port_name, kCliBaud);
  try {
    if (port.open()) (void)write(&port, "sensorStop\n");
  } catch (const std::runtime_error& error) {
    print_notes({fmt::format("{}; the radar was not stopped", error.what())});
  }
}

}  // namespace rio::tools
