// SPDX-License-Identifier: BSD-3-Clause
// The commands of the demo of SDK 3.x, and what the checks of a configuration share.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "rio/ti/config.hpp"

namespace rio::ti {

inline constexpr int kStoredOnce = -1;  ///< key of a command of which the demo stores the last
inline constexpr int kRepeatable = -2;  ///< key of one that may be repeated

/// Commands with a rank must come in that order.
struct Known {
  const char* name;
  std::size_t least;  ///< fewest arguments
  std::size_t most;
  bool required;
  int rank;
  int key = kStoredOnce;  ///< argument that tells those apart of which the demo stores the last
};
inline constexpr Known kKnown[] = {
    {"sensorStop", 0, 0, false, 1, kRepeatable},
    {"flushCfg", 0, 0, true, 2, kRepeatable},
    {"dfeDataOutputMode", 1, 1, true, 3},
    {"channelCfg", 3, 3, true, 4},
    {"adcCfg", 2, 2, true, 5},
    {"adcbufCfg", 5, 5, true, 6},
    {"profileCfg", 14, 14, true, 7, 0},
    {"chirpCfg", 8, 8, true, 8, kRepeatable},
    {"frameCfg", 7, 7, true, 9},
    {"sensorStart", 0, 1, true, 10, kRepeatable},
    {"configDataPort", 2, 2, false, 0},
    {"lowPower", 2, 2, true, 0},
    {"guiMonitor", 7, 7, true, 0},
    {"cfarCfg", 9, 9, true, 0, 1},
    {"multiObjBeamForming", 3, 3, true, 0},
    {"clutterRemoval", 2, 2, true, 0},
    {"calibDcRangeSig", 5, 5, true, 0},
    {"extendedMaxVelocity", 2, 2, true, 0},
    {"lvdsStreamCfg", 4, 4, true, 0},
    {"compRangeBiasAndRxChanPhase", 9, 25, true, 0},
    {"measureRangeBiasAndRxChanPhase", 3, 3, true, 0},
    {"CQRxSatMonitor", 5, 5, true, 0},
    {"CQSigImgMonitor", 3, 3, true, 0},
    {"analogMonitor", 2, 2, true, 0},
    {"aoaFovCfg", 5, 5, true, 0},
    {"cfarFovCfg", 4, 4, true, 0, 1},
    {"bpmCfg", 4, 4, false, 0},
    {"calibData", 2, 3, false, 0},
    {"advFrameCfg", 5, 5, false, 0},
    {"subFrameCfg", 10, 10, false, 0, 0},
    {"queryDemoStatus", 0, 0, false, 0, kRepeatable},
    {"version", 0, 0, false, 0, kRepeatable},
};

/// Null if it is none of them.
const Known* find_known(const std::string& name);
/// The command of whose name one letter is wrong, missing or too many; null if there is none.
const Known* meant_by(std::string_view name);
/// As people write it who take another mark than % and #.
bool is_comment(const std::string& name);
/// Whether the number of its arguments is right; false for an unknown command.
bool is_counted(const ConfigCommand& command);
/// The command as text, argument i replaced.
std::string line_of(const ConfigCommand& command, std::size_t i = std::string::npos,
                    const std::string& value = {});
/// Why nothing else is judged, and what to do, as the only finding; its text is empty if all is.
LintFinding headline(const Config& config);
/// The commands without those in whose place the demo stores a later one.
Config without_replaced(const Config& config);
/// The profile of the first chirp of the frame; the first one if none is.
const ConfigCommand* used_profile(const Config& config);

/// As printf() prints.
__attribute__((format(printf, 1, 2))) std::string format(const char* pattern, ...);

/// Looks at the commands in force, and adds findings.
class ConfigCheck {
 protected:
  ConfigCheck(const Config& in_force, std::vector<LintFinding>* findings)
      : config_(in_force), findings_(findings) {}

  void add(LintKind kind, bool wrong, const ConfigCommand* where, const std::string& text,
           const std::string& change) {
    findings_->push_back({kind, wrong, where == nullptr ? 0 : where->line, text, change});
  }

  /// The commands of a name with the right number of arguments.
  template <class Check>
  void each(const char* name, Check&& check) {
    for (std::size_t n = 0; const ConfigCommand* command = config_.find(name, n); ++n) {
      if (is_counted(*command)) check(*command);
    }
  }

  const Config& config_;

 private:
  std::vector<LintFinding>* findings_;
};

/// What the figures of the commands in force tell.
void check_figures(const Config& in_force, const ConfigFigures& figures, const RadarUse& use,
                   std::vector<LintFinding>* findings);

}  // namespace rio::ti
