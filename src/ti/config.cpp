// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ti/config.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "config_commands.hpp"

namespace rio::ti {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";  // in front of what some editors save
constexpr std::ptrdiff_t kManyUnknown = 3;              // commands, not by mistake

/// The words of a line, between blanks.
std::vector<std::string> words_of(std::string_view line) {
  constexpr const char* kBlanks = " \t";
  std::vector<std::string> words;
  for (std::size_t at = 0; (at = line.find_first_not_of(kBlanks, at)) != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.emplace_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Whether it is the frameCfg of SDK 4, with the number of samples in front of the period: of eight
/// arguments the last but one is the trigger.
bool has_samples(const ConfigCommand* frame) {
  if (frame == nullptr || frame->arguments.size() != 8) return false;
  return frame->number(6) == 1.0 || frame->number(6) == 2.0;
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
                                           "other firmware",
                                           "scan rate"};
  static_assert(sizeof kNames / sizeof *kNames == static_cast<std::size_t>(LintKind::kCount));
  return kind < LintKind::kCount ? kNames[static_cast<std::size_t>(kind)] : "unknown";
}

Config parse_config(std::string_view text) {
  Config config;
  if (text.substr(0, kUtf8Mark.size()) == kUtf8Mark) text.remove_prefix(kUtf8Mark.size());
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    std::vector<std::string> words = words_of(text.substr(0, end));
    const std::size_t mark = text.substr(end, 2) == "\r\n" ? 2 : 1;
    text.remove_prefix(std::min(end + mark, text.size()));
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

const Known* meant_by(std::string_view name) {
  for (const Known& k : kKnown) {
    const std::string_view known = k.name;
    const auto begin = std::mismatch(name.begin(), name.end(), known.begin(), known.end());
    const auto end = std::mismatch(name.rbegin(), name.rend(), known.rbegin(), known.rend());
    const auto alike = begin.first - name.begin() + (end.first - name.rbegin());
    if (alike + 1 >= static_cast<std::ptrdiff_t>(std::max(name.size(), known.size()))) return &k;
  }
  return nullptr;
}

bool is_comment(const std::string& name) {
  return std::isalpha(static_cast<unsigned char>(name[0])) == 0;
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

LintFinding headline(const Config& config) {
  const auto has_nul = [](const std::string& word) { return word.find('\0') != std::string::npos; };
  const Firmware* other = other_firmware(config);
  bool knows_any = other != nullptr;
  LintFinding only{LintKind::kUnknownCommand, true, 0, "", ""};
  for (const ConfigCommand& command : config.commands) {
    knows_any = knows_any || find_known(command.name) != nullptr;
    const auto& words = command.arguments;
    if (has_nul(command.name) || std::any_of(words.begin(), words.end(), has_nul)) {
      only.text = "UTF-16 or binary: save it as plain text";
      return only;
    }
  }
  const Config in_force = without_replaced(config);
  const ConfigCommand* mode = in_force.find("dfeDataOutputMode");
  const bool has_mode = mode != nullptr && is_counted(*mode) && !std::isnan(mode->number(0));
  if (!knows_any) {
    only.text = "no configuration of a TI radar: it has none of the commands";
  } else if (other != nullptr) {
    only.kind = LintKind::kOtherFirmware;
    only.text = std::string("the configuration of ") + other->name +
                ", not of the out-of-box demo of SDK 3.x: not judged";
  } else if (config.find("advFrameCfg") != nullptr || (has_mode && mode->number(0) != 1.0)) {
    only.kind = LintKind::kInconsistent;
    only.text =
        "advanced frames (subframes) and continuous chirps are not understood: use one frame "
        "(dfeDataOutputMode 1, frameCfg)";
  }
  return only;
}

Config without_replaced(const Config& config) {
  Config last;
  for (const ConfigCommand& command : config.commands) {
    const Known* known = find_known(command.name);
    if (known != nullptr && known->key != kRepeatable && is_counted(command)) {
      const auto is_replaced = [&command, known](const ConfigCommand& earlier) {
        const bool same =
            known->key == kStoredOnce || command.number(static_cast<std::size_t>(known->key)) ==
                                             earlier.number(static_cast<std::size_t>(known->key));
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
  const auto any = [&config](std::string_view name, auto&& is_it) {
    return std::any_of(
        config.commands.begin(), config.commands.end(),
        [&](const ConfigCommand& command) { return command.name == name && is_it(command); });
  };
  const auto count = [](const ConfigCommand& c) { return c.arguments.size(); };
  const bool is_old =
      config.find("aoaFovCfg") == nullptr &&  // of SDK 3.x
      (has_command_of(kOldDemos) ||
       any("cfarCfg", [&](const ConfigCommand& c) { return count(c) == 7 || count(c) == 8; }) ||
       any("adcbufCfg", [&](const ConfigCommand& c) { return count(c) == 4; }));
  if (is_old) return &kOldDemos;
  const bool is_sdk4 = unknown.count("antGeometryCfg") > 0 ||
                       has_samples(config.find("frameCfg")) ||
                       any("channelCfg", [](const ConfigCommand& c) { return c.whole(1) > 7; }) ||
                       any("chirpCfg", [](const ConfigCommand& c) { return c.whole(7) > 7; });
  for (const Firmware& row : kFirmware) {
    if (&row != &kOldDemos && has_command_of(row)) return &row;
    if (row.first_sdk == 4 && is_sdk4 && config.find("chirpCfg") != nullptr) return &row;
  }
  const auto is_other = [](const std::string& name) {
    return !is_comment(name) && meant_by(name) == nullptr;
  };
  const auto others = std::count_if(unknown.begin(), unknown.end(), is_other);
  return knows_any && others >= kManyUnknown ? &kUnknownDemo : nullptr;
}

}  // namespace rio::ti
