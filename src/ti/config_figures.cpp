// SPDX-License-Identifier: BSD-3-Clause
// The figures of the radar with a configuration.
#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdio>
#include <limits>

#include "config_commands.hpp"

namespace rio::ti {
namespace {

constexpr double kLight = 299792458.0;  // [m/s]
constexpr double kUsableBand = 0.8;     // of the samples'
constexpr std::size_t kPacketHeader = 40;
constexpr std::size_t kTlv = 8;  // size of its header
constexpr std::size_t kPacketUnit = 32;
constexpr std::size_t kStatistics = 2 * kTlv + 24 + 28;  // and, in later 3.x, the temperatures

int power_of_two_from(int n) {
  int power = 1;
  while (power < n) power *= 2;
  return power;
}

std::size_t size_of(int count) {
  return static_cast<std::size_t>(count);
}

/// Takes arguments in turn, each within its range; remembers the first invalid one.
class Arguments {
 public:
  Arguments(const ConfigCommand* command, const char* name) : name_(name), command_(command) {
    if (command_ == nullptr) wrong_ = std::string(name) + " is missing";
    if (command_ != nullptr && !is_counted(*command_)) {
      wrong_ = "line " + std::to_string(command_->line) + ", " + name + ": number of arguments";
    }
  }

  double real(std::size_t i, double least, double most) {
    if (command_ == nullptr) return least;
    const double value = command_->number(i);
    if (value >= least && value <= most) return value;
    char text[120];
    std::snprintf(text, sizeof text, "line %d, %s: argument %zu must be %g to %g", command_->line,
                  name_, i + 1, least, most);
    if (wrong_.empty()) wrong_ = text;
    return least;
  }
  int whole(std::size_t i, int least, int most) {
    return static_cast<int>(std::lround(real(i, least, most)));
  }
  const std::string& wrong() const { return wrong_; }

 private:
  const char* name_;
  const ConfigCommand* command_;
  std::string wrong_;
};

struct Profile {
  double start = 0.0;      ///< [Hz]
  double idle = 0.0;       ///< [s]
  double adc_start = 0.0;  ///< [s]
  double ramp = 0.0;       ///< [s]
  double slope = 0.0;      ///< [Hz/s]
  double rate = 0.0;       ///< [Hz]
};

Profile read_profile(const Config& config, ConfigFigures* f, std::string* wrong) {
  Arguments a(used_profile(config), "profileCfg");
  Profile p;
  a.whole(0, 0, 15);
  p.start = 1e9 * a.real(1, 55.0, 90.0);
  p.idle = 1e-6 * a.real(2, 0.0, 5300.0);
  p.adc_start = 1e-6 * a.real(3, 0.0, 100.0);
  p.ramp = 1e-6 * a.real(4, 1.0, 5300.0);
  p.slope = 1e12 * a.real(7, 0.1, 300.0);
  f->samples = a.whole(9, 2, 4096);
  p.rate = 1e3 * a.real(10, 100.0, 40000.0);
  *wrong = a.wrong();
  return p;
}

/// The chirps of a loop: transmitters, and additional idle times.
double read_chirps(const Config& config, int first, int last, ConfigFigures* f) {
  double idle = 0.0;
  std::bitset<3> masks;
  for (std::size_t n = 0; const ConfigCommand* chirp = config.find("chirpCfg", n); ++n) {
    if (!is_counted(*chirp)) return std::numeric_limits<double>::quiet_NaN();
    const double begin = std::max<double>(first, chirp->number(0));
    const double end = std::min<double>(last, chirp->number(1));
    if (!(begin <= end)) continue;
    idle += (end - begin + 1.0) * 1e-6 * chirp->number(5);
    masks |= static_cast<unsigned>(chirp->whole(7) & 7);
  }
  f->transmitters = std::min(static_cast<int>(masks.count()), f->chirps);
  return idle;
}

void read_packet(const Config& config, ConfigFigures* f) {
  if (const ConfigCommand* port = config.find("configDataPort")) f->baud = port->number(0);
  const ConfigCommand* gui = config.find("guiMonitor");
  f->fixed_bytes = kPacketHeader;
  if (gui == nullptr || !is_counted(*gui)) return;
  const auto on = [gui](std::size_t i) { return gui->number(i) > 0.0; };
  const auto bins = size_of(f->range_bins);
  const auto antennas = size_of(f->receivers) * size_of(f->transmitters);
  f->side_info = gui->number(1) == 1.0;
  if (on(1)) f->fixed_bytes += kTlv + (f->side_info ? kTlv : 0);
  f->point_bytes = on(1) ? (f->side_info ? 20 : 16) : 0;
  if (on(2)) f->fixed_bytes += kTlv + 2 * bins;
  if (on(3)) f->fixed_bytes += kTlv + 2 * bins;
  if (on(4)) f->fixed_bytes += kTlv + 4 * bins * antennas;
  if (on(5)) f->fixed_bytes += kTlv + 2 * bins * size_of(f->doppler_bins);
  if (on(6)) f->fixed_bytes += kStatistics;
}

}  // namespace

std::size_t ConfigFigures::packet_bytes(std::size_t points) const {
  return (fixed_bytes + points * point_bytes + kPacketUnit - 1) / kPacketUnit * kPacketUnit;
}

Time ConfigFigures::packet_time(std::size_t points) const {
  return from_seconds(10.0 * static_cast<double>(packet_bytes(points)) / baud);
}

bool derive(const Config& all, ConfigFigures* figures, std::string* why) {
  std::string wrong = headline(all).text;
  if (!wrong.empty()) {
    if (why != nullptr) *why = wrong;
    return false;
  }
  const Config config = without_replaced(all);
  ConfigFigures f;
  const Profile p = read_profile(config, &f, &wrong);
  Arguments frame(config.find("frameCfg"), "frameCfg");
  const int first = frame.whole(0, 0, 511);
  const int last = frame.whole(1, first, 511);
  f.loops = frame.whole(2, 1, 255);
  f.period = from_seconds(1e-3 * frame.real(4, 0.1, 1e5));
  Arguments channels(config.find("channelCfg"), "channelCfg");
  f.receivers =
      static_cast<int>(std::bitset<4>(static_cast<unsigned>(channels.whole(0, 1, 15))).count());
  if (wrong.empty()) wrong = frame.wrong();
  if (wrong.empty()) wrong = channels.wrong();
  f.chirps = last - first + 1;
  const double idle = read_chirps(config, first, last, &f);
  const double loop = f.chirps * (p.idle + p.ramp) + idle;
  if (wrong.empty() && f.transmitters == 0) wrong = "no chirpCfg for the chirps of frameCfg";
  if (wrong.empty() && !(loop > 0.0 && loop < 1.0)) wrong = "the chirps take no sensible time";
  if (why != nullptr) *why = wrong;
  if (!wrong.empty()) return false;

  f.range_bins = power_of_two_from(f.samples);
  f.doppler_bins = power_of_two_from(f.loops);
  const double middle = p.start + p.slope * (p.adc_start + 0.5 * f.samples / p.rate);
  f.max_speed = kLight / middle / (4.0 * loop);
  f.speed_grid = 2.0 * f.max_speed / f.doppler_bins;
  const double band = kLight * p.rate / (2.0 * p.slope);
  f.range_resolution = band / f.samples;
  f.range_grid = band / f.range_bins;
  const ConfigCommand* samples = config.find("adcCfg");
  const bool shows_image = samples != nullptr && samples->number(1) == 2.0;
  f.max_range = kUsableBand * band * (shows_image ? 0.5 : 1.0);
  f.chirp_block = from_seconds(f.loops * loop);
  const auto cells = size_of(f.range_bins) * size_of(f.doppler_bins);
  const auto chirp_cells = size_of(f.range_bins) * size_of(f.loops) * size_of(f.chirps);
  f.cube_bytes = 4 * chirp_cells * size_of(f.receivers) + 2 * cells;
  read_packet(config, &f);
  if (!(f.baud >= 1200.0)) f.baud = 921600.0;
  *figures = f;
  return true;
}

std::string as_options(const ConfigFigures& f) {
  char text[256];
  std::snprintf(text, sizeof text,
                "radar:\n  max_doppler: %.4f m/s\n  doppler_resolution: %.5f m/s\n"
                "  range_resolution: %.5f m\n  max_range: %.2f m\n",
                f.max_speed, f.speed_grid, f.range_grid, f.max_range);
  return text;
}

}  // namespace rio::ti
