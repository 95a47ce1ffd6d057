// SPDX-License-Identifier: BSD-3-Clause
// A progress bar on stderr, shown only when stderr is a terminal.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <string>

namespace rio::tools {

class Progress {
 public:
  /// @param wanted false: never shown, as when other lines go to the same terminal
  explicit Progress(bool wanted) : shown_(wanted && isatty(STDERR_FILENO) != 0) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  ~Progress() {
    if (shown_) std::fprintf(stderr, "\r%*s\r", kWidth + 8, "");
  }

  /// Draws only when the percentage changes.
  void show(std::size_t done, std::size_t total) {
    if (!shown_ || total == 0) return;
    const auto percent = static_cast<int>(100 * done / total);
    if (percent == percent_) return;
    percent_ = percent;
    const std::string bar(static_cast<std::size_t>(percent * kWidth / 100), '#');
    std::fprintf(stderr, "\r[%-*s] %3d %%", kWidth, bar.c_str(), percent);
  }

 private:
  static constexpr int kWidth = 50;

  bool shown_;
  int percent_ = -1;
};

}  // namespace rio::tools
