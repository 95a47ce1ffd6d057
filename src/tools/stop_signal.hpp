// SPDX-License-Identifier: BSD-3-Clause
// SIGINT and SIGTERM as a flag, for commands that run until stopped.
#pragma once

#include <csignal>

namespace rio::tools {

inline volatile std::sig_atomic_t stop_requested = 0;

/// From now on the signals set the flag; a second signal of a kind ends the program at once.
inline void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_requested = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace rio::tools
