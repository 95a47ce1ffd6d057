// SPDX-License-Identifier: BSD-3-Clause
// SIGINT, SIGTERM and SIGHUP as a flag, for commands that run until stopped.
#pragma once

#include <time.h>

#include <csignal>

namespace rio::tools {

inline volatile std::sig_atomic_t stop_requested = 0;

/// The first signal sets the flag; another, half a second later or more, ends the program at once.
/// (`timeout` sends the first one twice.)
inline void on_stop_signal(int signal) {
  static timespec first;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (stop_requested == 0) {
    first = now;
    stop_requested = 1;
    return;
  }
  const double since = static_cast<double>(now.tv_sec - first.tv_sec) +
                       1e-9 * static_cast<double>(now.tv_nsec - first.tv_nsec);
  if (since < 0.5) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// From now on SIGINT, SIGTERM and, unless `nohup` ignores it, SIGHUP are handled by
/// on_stop_signal(). A reader of the output that goes away is an output that fails, no signal.
inline void catch_stop_signals() {
  std::signal(SIGPIPE, SIG_IGN);
  struct sigaction action {};
  action.sa_handler = &on_stop_signal;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&action.sa_mask, signal);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(signal, &action, nullptr);
  }
}

}  // namespace rio::tools
