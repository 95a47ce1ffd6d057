// SPDX-License-Identifier: BSD-3-Clause
// What `--version` prints.
#pragma once

#include <string>

namespace rio::tools {

/// Version, commit, and how it was compiled: two lines.
std::string version_text();

}  // namespace rio::tools
