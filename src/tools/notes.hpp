// SPDX-License-Identifier: BSD-3-Clause
// What a user should know of the inputs, on stderr.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace rio::tools {

inline void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
}

}  // namespace rio::tools
