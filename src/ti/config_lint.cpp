// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "config_commands.hpp"
#include "rio/ti/config_sender.hpp"

namespace rio::ti {
namespace {

constexpr double kHighCfar = 15.0;       // [dB]
constexpr double kCoarseGrid = 0.25;     // [m/s]
constexpr double kNarrowAzimuth = 90.0;  // full width [deg]
constexpr double kNarrowElevation = 30.0;
constexpr int kFirstOfFigures = 4;  // rank of channelCfg
constexpr std::size_t kLongestLine = ConfigSender::kMaxLine;

__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::string number(double value) {
  return format("%g", value);
}

class Linter {
 public:
  Linter(const Config& config, const RadarUse& use)
      : all_(config), config_(without_replaced(config)), use_(use) {}

  std::vector<LintFinding> run() {
    const std::string no_text = unreadable(all_);
    if (!no_text.empty()) {
      add(LintKind::kUnknownCommand, true, nullptr, no_text, "");
      return findings_;
    }
    if (other_firmware(all_) != nullptr) {
      std::string why;
      (void)derive(all_, &figures_, &why);
      add(LintKind::kOtherFirmware, true, nullptr, why, "");
      return findings_;
    }
    check_commands();
    check_order();
    check_repeated();
    check_missing();
    check_output();
    check_detection();
    check_hardware();
    std::string why;
    if (derive(config_, &figures_, &why)) {
      profile_ = used_profile(config_);
      check_profile();
      check_chirps();
      check_speed();
      check_time();
      check_memory();
    } else if (!miscounted_) {
      add(LintKind::kInconsistent, true, nullptr, "no figures follow: " + why, "");
    }
    std::stable_sort(findings_.begin(), findings_.end(),
                     [](const LintFinding& a, const LintFinding& b) {
                       return (a.line == 0 ? 1 << 30 : a.line) < (b.line == 0 ? 1 << 30 : b.line);
                     });
    return findings_;
  }

 private:
  void add(LintKind kind, bool wrong, const ConfigCommand* where, const std::string& text,
           const std::string& change) {
    findings_.push_back({kind, wrong, where == nullptr ? 0 : where->line, text, change});
  }

  /// The commands of a name with the right number of arguments.
  template <class Check>
  void each(const char* name, Check&& check) {
    for (std::size_t n = 0; const ConfigCommand* command = config_.find(name, n); ++n) {
      if (is_counted(*command)) check(*command);
    }
  }

  void check_commands() {
    for (const ConfigCommand& command : all_.commands) {
      const Known* known = find_known(command.name);
      if (known == nullptr) {
        add(LintKind::kUnknownCommand, true, &command,
            "the demo of SDK 3.x does not know " + command.name, "take the line out");
        continue;
      }
      check_arguments(command, *known);
    }
  }

  void check_arguments(const ConfigCommand& command, const Known& known) {
    const std::size_t count = command.arguments.size();
    const auto is_comment = [](const std::string& word) {
      return word[0] == '%' || word[0] == '#';
    };
    if (std::any_of(command.arguments.begin(), command.arguments.end(), is_comment)) {
      miscounted_ = miscounted_ || known.rank >= kFirstOfFigures;
      return add(LintKind::kWrongArguments, true, &command,
                 "a comment needs a line of its own: the demo takes it for arguments", "");
    }
    if (!is_counted(command)) {
      miscounted_ = miscounted_ || known.rank >= kFirstOfFigures;
      return add(LintKind::kWrongArguments, true, &command,
                 format("%s has %zu arguments and needs %zu", known.name, count,
                        count < known.least ? known.least : known.most),
                 "");
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!std::isnan(command.number(i))) continue;
      add(LintKind::kWrongArguments, true, &command,
          format("argument %zu of %s is no number: %.40s", i + 1, known.name,
                 command.arguments[i].c_str()),
          "");
    }
    if (line_of(command).size() > kLongestLine) {
      add(LintKind::kWrongArguments, true, &command,
          format("the line of %s is longer than the %zu characters the demo reads", known.name,
                 kLongestLine),
          "");
    }
  }

  void check_order() {
    const Known* latest = nullptr;
    for (const ConfigCommand& command : all_.commands) {
      const Known* known = find_known(command.name);
      if (known == nullptr) continue;
      const bool started = latest != nullptr && latest->rank == 10;
      if (started || (known->rank > 0 && latest != nullptr && known->rank < latest->rank)) {
        add(LintKind::kWrongOrder, true, &command,
            format("%s stands behind %s", known->name, latest->name),
            format("move it in front of %s", latest->name));
      }
      if (known->rank > 0 && (latest == nullptr || known->rank > latest->rank)) latest = known;
    }
  }

  void check_repeated() {
    auto in_force = config_.commands.begin();
    for (const ConfigCommand& command : all_.commands) {
      if (in_force != config_.commands.end() && in_force->line == command.line) {
        ++in_force;
        continue;
      }
      add(LintKind::kInconsistent, true, &command,
          format("%s is given twice, the last counts", command.name.c_str()), "take one out");
    }
  }

  void check_missing() {
    for (const Known& known : kKnown) {
      if (!known.required || config_.find(known.name) != nullptr) continue;
      add(LintKind::kMissingCommand, true, nullptr,
          format("%s is missing: the demo does not start without it", known.name), "");
    }
    for (const char* name : {"cfarCfg", "cfarFovCfg"}) check_directions(name);
  }

  /// A command that is needed for both.
  void check_directions(const char* name) {
    const bool miscounted =
        std::any_of(config_.commands.begin(), config_.commands.end(),
                    [name](const ConfigCommand& c) { return c.name == name && !is_counted(c); });
    if (miscounted || config_.find(name) == nullptr) return;
    for (const char* direction : {"range", "Doppler"}) {
      const double wanted = direction[0] == 'r' ? 0.0 : 1.0;
      int found = 0;
      each(name, [&](const ConfigCommand& c) { found += c.number(1) == wanted ? 1 : 0; });
      if (found > 0) continue;
      add(LintKind::kMissingCommand, true, nullptr,
          format("there is no %s for %s: the demo does not start without it", name, direction),
          format("%s -1 %g ...", name, wanted));
    }
  }

  void check_output() {
    each("guiMonitor", [&](const ConfigCommand& c) {
      if (!(c.number(1) > 0.0)) {
        add(LintKind::kNoPoints, true, &c, "the detected points are not sent", line_of(c, 1, "1"));
      } else if (c.number(1) != 1.0) {
        add(LintKind::kNoSideInfo, true, &c,
            "SNR and noise of the points are not sent (side info, TLV 7)", line_of(c, 1, "1"));
      }
    });
    each("lvdsStreamCfg", [&](const ConfigCommand& c) {
      if (c.number(2) == 0.0 && c.number(3) == 0.0) return;
      add(LintKind::kLvdsOn, false, &c, "raw data are streamed over LVDS, and need a capture card",
          "lvdsStreamCfg -1 0 0 0");
    });
  }

  void check_detection() {
    each("clutterRemoval", [&](const ConfigCommand& c) {
      if (c.number(1) == 0.0) return;
      add(LintKind::kClutterRemoval, true, &c,
          "clutter removal deletes what has no Doppler: all of the world when the vehicle stands, "
          "what is abeam when it moves",
          line_of(c, 1, "0"));
    });
    each("cfarCfg", [&](const ConfigCommand& c) {
      if (!(c.number(7) > kHighCfar)) return;
      add(LintKind::kCfarTooHigh, true, &c,
          format("a CFAR threshold of %g dB in %s leaves few points of walls and ground",
                 c.number(7), c.number(1) == 0.0 ? "range" : "Doppler"),
          line_of(c, 7, "10"));
    });
    each("extendedMaxVelocity", [&](const ConfigCommand& c) {
      if (c.number(1) == 0.0) return;
      add(LintKind::kExtendedVelocity, false, &c,
          "the extended velocity is right for one target in a range cell only; the estimator "
          "unfolds by its own prediction",
          line_of(c, 1, "0"));
    });
    each("aoaFovCfg", [&](const ConfigCommand& c) {
      const double azimuth = c.number(2) - c.number(1);
      const double elevation = c.number(4) - c.number(3);
      if (azimuth >= kNarrowAzimuth && elevation >= kNarrowElevation) return;
      add(LintKind::kNarrowView, false, &c,
          format("only %g x %g deg are used: the velocity across is measured by wide angles",
                 azimuth, elevation),
          "aoaFovCfg -1 -70 70 -45 45");
    });
  }

  void check_hardware() {
    each("frameCfg", [&](const ConfigCommand& c) {
      if (c.number(5) == 2.0) {
        add(LintKind::kHardwareTrigger, false, &c,
            "frames wait for pulses at the SYNC_IN pin: without them there is no scan",
            line_of(c, 5, "1"));
      }
      if (c.number(3) > 0.0) {
        add(LintKind::kInconsistent, true, &c,
            format("the radar stops after %g frames", c.number(3)), line_of(c, 3, "0"));
      }
    });
    each("sensorStart", [&](const ConfigCommand& c) {
      if (c.number(0) != 0.0 || config_.find("frameCfg") == nullptr) return;
      add(LintKind::kInconsistent, true, &c,
          "sensorStart 0 is for a radar with a configuration: the demo refuses it behind a new one",
          "sensorStart");
    });
    each("dfeDataOutputMode", [&](const ConfigCommand& c) {
      if (c.number(0) == 1.0) return;
      add(LintKind::kInconsistent, true, &c,
          format("mode %g is not one frame a period, which is understood here", c.number(0)),
          "dfeDataOutputMode 1");
    });
  }

  void check_profile() {
    const ConfigCommand& p = *profile_;
    const double start = p.number(1), adc_start = p.number(3), ramp = p.number(4);
    const double slope = p.number(7), sampling = 1e3 * p.number(9) / p.number(10);
    if (adc_start + sampling > ramp) {
      add(LintKind::kSamplesOutsideRamp, true, &p,
          format("the samples end %.2f us after the start of the ramp, which ends after %g us",
                 adc_start + sampling, ramp),
          line_of(p, 4, number(std::ceil(adc_start + sampling + 1.0))));
    }
    const bool high = start >= 70.0;
    const double low_edge = high ? 76.0 : 60.0, high_edge = high ? 81.0 : 64.0;
    const double end = start + 1e-3 * slope * ramp;
    if (start < low_edge || end > high_edge) {
      const double fitting = 1e3 * (high_edge - std::max(start, low_edge)) / ramp;
      add(LintKind::kBandExceeded, true, &p,
          format("the ramp goes from %g to %.3f GHz, the band from %g to %g GHz", start, end,
                 low_edge, high_edge),
          line_of(p, 7, number(std::floor(10.0 * std::min(slope, fitting)) / 10.0)));
    }
    each("profileCfg", [&](const ConfigCommand& c) {
      if (c.number(0) == p.number(0)) return;
      add(LintKind::kInconsistent, true, &c,
          format("another profile than %g, that of the first chirp: the figures are those of one",
                 p.number(0)),
          "take the line out");
    });
  }

  /// Checks that each chirp of the frame is defined once, by the profile, with one enabled
  /// transmitter.
  void check_chirps() {
    const ConfigCommand& frame = *config_.find("frameCfg");
    const int on = config_.find("channelCfg")->whole(1);
    for (int chirp = frame.whole(0); chirp <= frame.number(1); ++chirp) {
      int found = 0;
      each("chirpCfg", [&](const ConfigCommand& c) {
        if (!(c.number(0) <= chirp && chirp <= c.number(1))) return;
        ++found;
        check_chirp(c, on);
      });
      if (found == 1) continue;
      add(LintKind::kInconsistent, true, &frame,
          format("chirp %d of the frame is defined %d times", chirp, found), "");
    }
    if (figures_.transmitters < 3) {
      add(LintKind::kFlatElevation, false, &frame,
          format("%d transmitters take turns: an xWR1843BOOST tells no elevation by them",
                 figures_.transmitters),
          "chirps 0, 1, 2 with the transmitters 1, 4, 2, and frameCfg 0 2 ...");
    }
  }

  void check_chirp(const ConfigCommand& c, int on) {
    if (c.number(2) != profile_->number(0)) {
      add(LintKind::kInconsistent, true, &c,
          format("the chirp uses profile %g, not %g, for which the figures are", c.number(2),
                 profile_->number(0)),
          line_of(c, 2, profile_->arguments[0]));
    }
    const int mask = c.whole(7);
    if (mask == 0 || (mask & ~on) != 0) {
      add(LintKind::kInconsistent, true, &c,
          format("the chirp uses transmitters %d, channelCfg switches on %d", mask, on), "");
    }
  }

  void check_speed() {
    if (figures_.max_speed < use_.speed) {
      const double share = figures_.max_speed / use_.speed;
      add(LintKind::kTooSlow, true, profile_,
          format("Dopplers fold at +-%.2f m/s, the vehicle flies %g m/s", figures_.max_speed,
                 use_.speed),
          format("a loop of %d chirps must take %.0f us instead of %.0f: shorter idle time and "
                 "ramp, or fewer chirps",
                 figures_.chirps, std::floor(1e6 * share * loop_time()), 1e6 * loop_time()));
    }
    if (figures_.speed_grid > kCoarseGrid) {
      add(LintKind::kCoarseSpeed, false, config_.find("frameCfg"),
          format("the grid of the Doppler is %.2f m/s", figures_.speed_grid),
          format("more than %d loops", figures_.loops));
    }
    each("cfarFovCfg", [&](const ConfigCommand& c) {
      if (c.number(1) != 1.0) return;
      const double least = std::min(use_.speed, figures_.max_speed - figures_.speed_grid);
      if (c.number(2) <= -least && c.number(3) >= least) return;
      add(LintKind::kSpeedCut, true, &c,
          format("Dopplers beyond %g to %g m/s are cut off, the vehicle flies %g m/s", c.number(2),
                 c.number(3), use_.speed),
          format("cfarFovCfg -1 1 %.2f %.2f", -figures_.max_speed, figures_.max_speed));
    });
  }

  double loop_time() const { return to_seconds(figures_.chirp_block) / figures_.loops; }

  void check_time() {
    const ConfigCommand& frame = *config_.find("frameCfg");
    const double period = 1e3 * to_seconds(figures_.period);  // [ms]
    const double block = 1e3 * to_seconds(figures_.chirp_block);
    const double wire = 1e3 * to_seconds(figures_.packet_time(use_.points));
    if (block >= period) {
      add(LintKind::kFrameTooShort, true, &frame,
          format("the chirps take %.2f ms of a period of %g ms", block, period),
          line_of(frame, 4, number(std::ceil(block / 0.5))));
      return;
    }
    if (wire < period - block) return;
    const double free = 1e-4 * (period - block) * figures_.baud;  // [bytes]
    const double room = free - static_cast<double>(figures_.fixed_bytes) - 31.0;
    const double fit = room > 0.0 && figures_.point_bytes > 0
                           ? std::floor(room / static_cast<double>(figures_.point_bytes))
                           : 0.0;
    const ConfigCommand* gui = config_.find("guiMonitor");
    add(LintKind::kUartTooSlow, wire >= period, gui == nullptr ? &frame : gui,
        format("a packet of %zu points has %zu bytes and takes %.1f ms at %.0f baud; the chirps "
               "leave %.1f ms of %g, enough for %.0f points",
               use_.points, figures_.packet_bytes(use_.points), wire, figures_.baud, period - block,
               period, fit),
        "guiMonitor -1 1 0 0 0 0 0, a longer period, or a faster configDataPort");
  }

  void check_memory() {
    if (figures_.cube_bytes <= use_.memory) return;
    add(LintKind::kTooMuchMemory, true, config_.find("frameCfg"),
        format("the radar cube of %d range bins, %d loops, %d chirps and %d receivers has %zu kB, "
               "the memory %zu kB",
               figures_.range_bins, figures_.loops, figures_.chirps, figures_.receivers,
               figures_.cube_bytes / 1024, use_.memory / 1024),
        "half the samples, or half the loops");
  }

  const Config& all_;
  const Config config_;  ///< what is in force
  RadarUse use_;
  ConfigFigures figures_;
  const ConfigCommand* profile_ = nullptr;  ///< for which they are
  bool miscounted_ = false;                 ///< a line that the figures need
  std::vector<LintFinding> findings_;
};

}  // namespace

const char* to_string(LintKind kind) {
  static constexpr const char* kNames[] = {"unknown command",
                                           "arguments",
                                           "missing command",
                                           "order",
                                           "clutter removal",
                                           "no points",
                                           "no side info",
                                           "unambiguous speed",
                                           "grid of the speed",
                                           "extended velocity",
                                           "CFAR threshold",
                                           "UART",
                                           "frame period",
                                           "sampling",
                                           "band",
                                           "consistency",
                                           "memory",
                                           "LVDS",
                                           "hardware trigger",
                                           "field of view",
                                           "limits of the speed",
                                           "elevation",
                                           "other firmware"};
  static_assert(sizeof kNames / sizeof *kNames == static_cast<std::size_t>(LintKind::kCount));
  return kind < LintKind::kCount ? kNames[static_cast<std::size_t>(kind)] : "unknown";
}

std::vector<LintFinding> lint(const Config& config, const RadarUse& use) {
  return Linter(config, use).run();
}

}  // namespace rio::ti
