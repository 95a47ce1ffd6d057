// SPDX-License-Identifier: BSD-3-Clause
// A progress bar on stderr; if stderr is not a terminal, a line every minute, or, with a name,
// every ten percent.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <string>
#include <utility>

namespace rio::tools {

class Progress {
 public:
  /// @param wanted false: no bar, for example when other lines go to the same terminal
  /// @param name prefix of the lines if there is no bar; empty: a line a minute, none on a terminal
  explicit Progress(bool wanted, std::string name = {}) : name_(std::move(name)) {
    const bool terminal = isatty(STDERR_FILENO) != 0;
    form_ = terminal && wanted ? Form::kBar
            : !name_.empty()   ? Form::kNamedLines
            : terminal         ? Form::kNothing
                               : Form::kLines;
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (form_ == Form::kBar) std::fprintf(stderr, "\r%*s\r", kWidth + 8, "");
  }

  /// Draws only when the percentage changes.
  void show(std::size_t done, std::size_t total) {
    if (form_ == Form::kNothing || total == 0) return;
    auto percent = static_cast<int>(100 * done / total);
    if (form_ == Form::kNamedLines) percent -= percent % 10;
    if (percent == percent_) return;
    percent_ = percent;
    if (form_ == Form::kBar) {
      const std::string bar(static_cast<std::size_t>(percent * kWidth / 100), '#');
      std::fprintf(stderr, "\r[%-*s] %3d %%", kWidth, bar.c_str(), percent);
    } else if (form_ == Form::kNamedLines) {
      std::fprintf(stderr, "%s: %d %%\n", name_.c_str(), percent);
    } else if (const auto now = std::chrono::steady_clock::now();
               now - told_ >= std::chrono::minutes(1)) {
      told_ = now;
      std::fprintf(stderr, "%d %%\n", percent);
    }
  }

 private:
  enum class Form { kNothing, kBar, kNamedLines, kLines };
  static constexpr int kWidth = 50;

  std::string name_;
  Form form_;
  std::chrono::steady_clock::time_point told_ = std::chrono::steady_clock::now();
  int percent_ = -1;
};

}  // namespace rio::tools
