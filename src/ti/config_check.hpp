// SPDX-License-Identifier: BSD-3-Clause
// What the checks of a configuration share.
#pragma once

#include <string>
#include <vector>

#include "config_commands.hpp"

namespace rio::ti {

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
