// SPDX-License-Identifier: BSD-3-Clause
// On stderr: a progress bar, or, where how far is not known, the seconds that have passed. If
// stderr is not a terminal, a line every minute, or, with a name, every ten percent.
#pragma once

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdio>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
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

/// "WHAT, 3 s", from the second second on, while it lives.
class Busy {
 public:
  explicit Busy(const char* what)
      : thread_([what](const std::stop_token& stop) { tell(stop, what); }) {}

 private:
  static void tell(const std::stop_token& stop, const char* what) {
    const bool terminal = isatty(STDERR_FILENO) != 0;
    const int step = terminal ? 1 : 60;  // [s]
    std::mutex mutex;
    std::unique_lock lock(mutex);
    std::condition_variable_any woken;
    const auto never = [] { return false; };
    for (int seconds = step;; seconds += step) {
      woken.wait_for(lock, stop, std::chrono::seconds(step), never);
      if (stop.stop_requested()) break;
      if (seconds == 1) continue;
      std::fprintf(stderr, terminal ? "\r%s, %d s" : "%s, %d s\n", what, seconds);
    }
    if (terminal) std::fprintf(stderr, "\r%40s\r", "");
  }

  std::jthread thread_;
};

}  // namespace rio::tools
