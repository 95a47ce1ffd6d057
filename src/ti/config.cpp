// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/config.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <set>

#include "config_commands.hpp"

namespace rio::ti {
namespace {

constexpr double kLight = 299792458.0;  // [m/s]
constexpr double kUsableBand = 0.8;     // of the samples'
constexpr std::size_t kPacketHeader = 40;
constexpr std::size_t kTlv = 8;  // size of its header
constexpr std::size_t kPacketUnit = 32;
constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";   // in front of what some editors save
constexpr std::size_t kManyUnknown = 3;                  // commands, not by mistake
constexpr std::size_t kStatistics = 2 * kTlv + 24 + 28;  // and, in later 3.x, the temperatures

bool is_space(char c) {
  return c == ' ' || c == '\t' || c == '\r';
}

std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < line.size();) {
    if (is_space(line[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < line.size() && !is_space(line[end])) ++end;
    words.emplace_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

int power_of_two_from(int n) {
  int power = 1;
  while (power < n) power *= 2;
  return power;
}

std::size_t size_of(int count) {
  return static_cast<std::size_t>(count);
}

int bits_in(int mask) {
  int count = 0;
  for (; mask > 0; mask >>= 1) count += mask & 1;
  return count;
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
  int masks = 0;
  for (std::size_t n = 0; const ConfigCommand* chirp = config.find("chirpCfg", n); ++n) {
    if (!is_counted(*chirp)) return std::numeric_limits<double>::quiet_NaN();
    const double begin = std::max<double>(first, chirp->number(0));
    const double end = std::min<double>(last, chirp->number(1));
    if (!(begin <= end)) continue;
    idle += (end - begin + 1.0) * 1e-6 * chirp->number(5);
    masks |= chirp->whole(7) & 7;
  }
  f->transmitters = bits_in(masks);
  return idle;
}

/// Whether it is the frameCfg of SDK 4, with the number of samples in front of the period: of eight
/// arguments the last but one is the trigger.
bool has_samples(const ConfigCommand* frame) {
  if (frame == nullptr || frame->arguments.size() != 8) return false;
  return frame->number(6) == 1.0 || frame->number(6) == 2.0;
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

double ConfigCommand::number(std::size_t i) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (i >= arguments.size()) return kNone;
  char* end = nullptr;
  const double value = std::strtod(arguments[i].c_str(), &end);
  return *end == 0 && std::isfinite(value) && std::abs(value) < 1e9 ? value : kNone;
}

int ConfigCommand::whole(std::size_t i) const {
  const double value = number(i);
  return std::isnan(value) ? 0 : static_cast<int>(value);
}

const ConfigCommand* Config::find(std::string_view name, std::size_t n) const {
  for (const ConfigCommand& command : commands) {
    if (command.name == name && n-- == 0) return &command;
  }
  return nullptr;
}

Config parse_config(std::string_view text) {
  Config config;
  if (text.substr(0, kUtf8Mark.size()) == kUtf8Mark) text.remove_prefix(kUtf8Mark.size());
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::vector<std::string> words = words_of(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (words.empty() || words[0][0] == '%' || words[0][0] == '#') continue;
    ConfigCommand command{number, words[0], {}};
    command.arguments.assign(words.begin() + 1, words.end());
    config.commands.push_back(command);
  }
  return config;
}

const Known* find_known(const std::string& name) {
  for (const Known& known : kKnown) {
    if (name == known.name) return &known;
  }
  return nullptr;
}

bool is_counted(const ConfigCommand& command) {
  const Known* known = find_known(command.name);
  const std::size_t count = command.arguments.size();
  return known != nullptr && count >= known->least && count <= known->most;
}

std::string line_of(const ConfigCommand& command, std::size_t i, const std::string& value) {
  std::string line = command.name;
  for (std::size_t k = 0; k < command.arguments.size(); ++k) {
    line += " " + (k == i ? value : command.arguments[k]);
  }
  return line;
}

std::string unreadable(const Config& config) {
  const auto has_nul = [](const std::string& word) { return word.find('\0') != std::string::npos; };
  bool knows_any = other_firmware(config) != nullptr;
  for (const ConfigCommand& command : config.commands) {
    knows_any = knows_any || find_known(command.name) != nullptr;
    const auto& words = command.arguments;
    if (has_nul(command.name) || std::any_of(words.begin(), words.end(), has_nul)) {
      return "UTF-16 or binary: save it as plain text";
    }
  }
  return knows_any ? "" : "no configuration of a TI radar: it has none of the commands";
}

Config without_replaced(const Config& config) {
  Config last;
  for (const ConfigCommand& command : config.commands) {
    const Known* known = find_known(command.name);
    if (known != nullptr && known->key != kRepeatable && is_counted(command)) {
      const auto is_replaced = [&command, known](const ConfigCommand& earlier) {
        const bool same = known->key == kStoredOnce || command.number(size_of(known->key)) ==
                                                           earlier.number(size_of(known->key));
        return same && earlier.name == command.name && is_counted(earlier);
      };
      last.commands.erase(std::remove_if(last.commands.begin(), last.commands.end(), is_replaced),
                          last.commands.end());
    }
    last.commands.push_back(command);
  }
  return last;
}

const ConfigCommand* used_profile(const Config& config) {
  const ConfigCommand* frame = config.find("frameCfg");
  const double first = frame == nullptr ? 0.0 : frame->number(0);
  for (std::size_t n = 0; const ConfigCommand* chirp = config.find("chirpCfg", n); ++n) {
    if (!(chirp->number(0) <= first && first <= chirp->number(1))) continue;
    for (std::size_t k = 0; const ConfigCommand* profile = config.find("profileCfg", k); ++k) {
      if (profile->number(0) == chirp->number(2)) return profile;
    }
  }
  return config.find("profileCfg");
}

const Firmware* other_firmware(const Config& config) {
  std::set<std::string> unknown;
  bool knows_any = false;
  for (const ConfigCommand& command : config.commands) {
    const bool known = find_known(command.name) != nullptr;
    knows_any = knows_any || known;
    if (!known) unknown.insert(command.name);
  }
  const auto has_command_of = [&unknown](const Firmware& row) {
    return std::any_of(unknown.begin(), unknown.end(), [&row](const std::string& name) {
      return std::string_view(row.commands).find(" " + name + " ") != std::string_view::npos;
    });
  };
  const ConfigCommand* cfar = config.find("cfarCfg");
  const std::size_t cfar_arguments = cfar == nullptr ? 0 : cfar->arguments.size();
  const bool is_old = config.find("aoaFovCfg") == nullptr &&  // of SDK 3.x
                      (has_command_of(kOldDemos) || cfar_arguments == 7 || cfar_arguments == 8);
  if (is_old) return &kOldDemos;
  const ConfigCommand* channels = config.find("channelCfg");
  const bool four_transmitters = channels != nullptr && channels->whole(1) > 7;
  const bool is_sdk4 = four_transmitters || has_samples(config.find("frameCfg"));
  for (const Firmware& row : kFirmware) {
    if (&row != &kOldDemos && has_command_of(row)) return &row;
    if (row.first_sdk == 4 && is_sdk4 && unknown.count("chirpComnCfg") == 0) return &row;
  }
  return knows_any && unknown.size() >= kManyUnknown ? &kUnknownDemo : nullptr;
}

std::size_t ConfigFigures::packet_bytes(std::size_t points) const {
  return (fixed_bytes + points * point_bytes + kPacketUnit - 1) / kPacketUnit * kPacketUnit;
}

Time ConfigFigures::packet_time(std::size_t points) const {
  return from_seconds(10.0 * static_cast<double>(packet_bytes(points)) / baud);
}

bool derive(const Config& all, ConfigFigures* figures, std::string* why) {
  const std::string no_text = unreadable(all);
  if (!no_text.empty()) {
    if (why != nullptr) *why = no_text;
    return false;
  }
  const Config config = without_replaced(all);
  if (const Firmware* other = other_firmware(config)) {
    if (why != nullptr) {
      *why = std::string("the configuration of ") + other->name +
             ", not of the out-of-box demo of SDK 3.x: not judged";
    }
    return false;
  }
  ConfigFigures f;
  std::string wrong;
  const Profile p = read_profile(config, &f, &wrong);
  Arguments frame(config.find("frameCfg"), "frameCfg");
  const int first = frame.whole(0, 0, 511);
  const int last = frame.whole(1, first, 511);
  f.loops = frame.whole(2, 1, 255);
  f.period = from_seconds(1e-3 * frame.real(4, 0.1, 1e5));
  Arguments channels(config.find("channelCfg"), "channelCfg");
  f.receivers = bits_in(channels.whole(0, 1, 15));
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
  f.max_range = kUsableBand * band;
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
