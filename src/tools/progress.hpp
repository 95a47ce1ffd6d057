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
  /// @param wanted false: never shown, for example when other lines go to the same terminal
  /// @param name prefix of the lines if there is no terminal; empty: a line a minute
  explicit Progress(bool wanted, std::string name = {})
      : shown_(wanted && isatty(STDERR_FILENO) != 0), name_(shown_ ? "" : std::move(name)) {
    silent_ = !shown_ && isatty(STDERR_FILENO) != 0 && name_.empty();
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (shown_) std::fprintf(stderr, "\r%*s\r", kWidth + 8, "");
  }

  /// Draws only when the percentage changes.
  void show(std::size_t done, std::size_t total) {
    if (silent_ || total == 0) return;
    auto percent = static_cast<int>(100 * done / total);
    if (!shown_ && name_.empty()) return tell_each_minute(percent);
    if (!shown_) percent -= percent % 10;
    if (percent == percent_) return;
    percent_ = percent;
    if (!shown_) {
      std::fprintf(stderr, "%s: %d %%\n", name_.c_str(), percent);
      return;
    }
    const std::string bar(static_cast<std::size_t>(percent * kWidth / 100), '#');
    std::fprintf(stderr, "\r[%-*s] %3d %%", kWidth, bar.c_str(), percent);
  }

 private:
  static constexpr int kWidth = 50;

  void tell_each_minute(int percent) {
    if (percent == percent_) return;
    percent_ = percent;
    const auto now = std::chrono::steady_clock::now();
    if (now - told_ < std::chrono::minutes(1)) return;
    told_ = now;
    std::fprintf(stderr, "%d %%\n", percent);
  }

  bool shown_;
  bool silent_ = false;
  std::chrono::steady_clock::time_point told_ = std::chrono::steady_clock::now();
  std::string name_;
  int percent_ = -1;
};

}  // namespace rio::tools
