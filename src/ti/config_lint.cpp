// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <string_view>

#include "config_commands.hpp"
#include "rio/ti/config_sender.hpp"

namespace rio::ti {
namespace {

constexpr double kHighCfar = 15.0;       // [dB]
constexpr double kNarrowAzimuth = 90.0;  // full width [deg]
constexpr double kNarrowElevation = 30.0;
constexpr int kFirstOfFigures = 4;  // rank of channelCfg
constexpr std::size_t kLongestLine = ConfigSender::kMaxLine;

/// Of the commands one by one.
class CommandCheck : private ConfigCheck {
 public:
  CommandCheck(const Config& all, const Config& in_force, std::vector<LintFinding>* findings)
      : ConfigCheck(in_force, findings), all_(all) {}

  void run() {
    check_commands();
    check_order();
    check_repeated();
    check_missing();
    check_output();
    check_detection();
    check_samples();
    check_hardware();
  }
  /// A line that the figures need has a wrong number of arguments.
  bool miscounted() const { return miscounted_; }

  /// The last argument is the switch in every SDK.
  void check_clutter(const ConfigCommand& c) {
    const std::size_t last = c.arguments.size() - 1;
    if (c.arguments.empty() || c.number(last) == 0.0) return;
    add(LintKind::kClutterRemoval, true, &c,
        "clutter removal deletes what has no Doppler: all of the world when the vehicle stands, "
        "what is abeam when it moves",
        line_of(c, last, "0"));
  }

 private:
  void check_commands() {
    for (const ConfigCommand& command : all_.commands) {
      const Known* known = find_known(command.name);
      if (known == nullptr) {
        const Known* meant = meant_by(command.name);
        add(LintKind::kUnknownCommand, true, &command,
            "the demo of SDK 3.x does not know " + command.name,
            is_comment(command.name) ? "a comment begins with %"
            : meant == nullptr       ? "take the line out"
                                     : "did you mean " + std::string(meant->name) + "?");
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
    std::size_t required = 0;
    std::vector<const char*> missing;
    for (const Known& known : kKnown) {
      if (!known.required) continue;
      ++required;
      if (config_.find(known.name) == nullptr) missing.push_back(known.name);
    }
    if (2 * missing.size() > required) {
      return add(LintKind::kMissingCommand, true, nullptr,
                 format("%zu of the %zu commands without which the demo of SDK 3.x does not start "
                        "are missing: of another demo, or not all of the file",
                        missing.size(), required),
                 "");
    }
    for (const char* name : missing) {
      add(LintKind::kMissingCommand, true, nullptr,
          format("%s is missing: the demo does not start without it", name), "");
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
    each("clutterRemoval", [&](const ConfigCommand& c) { check_clutter(c); });
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
      add(LintKind::kNarrowView, azimuth <= 0.0 || elevation <= 0.0, &c,
          format("only %g x %g deg are used: the velocity across is measured by wide angles",
                 std::max(0.0, azimuth), std::max(0.0, elevation)),
          "aoaFovCfg -1 -70 70 -45 45");
    });
    each("cfarFovCfg", [&](const ConfigCommand& c) {
      if (!(c.number(2) >= c.number(3))) return;
      add(LintKind::kInconsistent, true, &c,
          format("nothing is between %g and %g: no point is detected", c.number(2), c.number(3)),
          format("cfarFovCfg -1 %g %g %g", c.number(1), c.number(3), c.number(2)));
    });
  }

  /// "mmWave SDK User's Guide" 3.x, usage of adcCfg and adcbufCfg in the demo.
  void check_samples() {
    static constexpr struct {
      const char* name;
      std::size_t i;
      double least, most;
      const char* only;
    } kTaken[] = {{"adcCfg", 0, 2.0, 2.0, "samples of 16 bits"},
                  {"adcCfg", 1, 1.0, 2.0, "complex samples"},
                  {"adcbufCfg", 1, 0.0, 0.0, "complex samples"},
                  {"adcbufCfg", 2, 1.0, 1.0, "samples with Q first"},
                  {"adcbufCfg", 3, 1.0, 1.0, "receivers one after the other"}};
    for (const auto& taken : kTaken) {
      each(taken.name, [&](const ConfigCommand& c) {
        const double value = c.number(taken.i);
        if (!(value < taken.least || value > taken.most)) return;
        add(LintKind::kInconsistent, true, &c,
            format("argument %zu is %g: the demo takes %s only", taken.i + 1, value, taken.only),
            line_of(c, taken.i, format("%g", taken.least)));
      });
    }
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
  }

  const Config& all_;
  bool miscounted_ = false;
};

}  // namespace

std::string format(const char* pattern, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(text, sizeof text, pattern, arguments);
  va_end(arguments);
  return text;
}

std::vector<LintFinding> lint(const Config& config, const RadarUse& use) {
  std::vector<LintFinding> findings;
  const Config in_force = without_replaced(config);
  CommandCheck commands(config, in_force, &findings);
  if (const LintFinding only = headline(config); !only.text.empty()) {
    findings.push_back(only);
    const ConfigCommand* clutter = in_force.find("clutterRemoval");
    if (only.kind == LintKind::kOtherFirmware && clutter != nullptr) {
      commands.check_clutter(*clutter);
    }
    return findings;
  }
  ConfigFigures figures;
  std::string why;
  const bool has_figures = derive(config, &figures, &why);
  commands.run();
  if (has_figures) {
    check_figures(in_force, figures, use, &findings);
  } else if (!commands.miscounted()) {
    findings.push_back({LintKind::kInconsistent, true, 0, "no figures follow: " + why, ""});
  }
  const auto place = [](const LintFinding& f) { return f.line == 0 ? 1 << 30 : f.line; };
  std::stable_sort(findings.begin(), findings.end(),
                   [&](const LintFinding& a, const LintFinding& b) { return place(a) < place(b); });
  return findings;
}

}  // namespace rio::ti
