// SPDX-License-Identifier: BSD-3-Clause
// The manual page and the bash completions, from the description of the command line.
#pragma once

#include <CLI/CLI.hpp>

namespace rio::tools {

/// The hidden command `rio describe man|bash`, which prints one of them; the build calls it.
void add_describe_command(CLI::App& app);

}  // namespace rio::tools
