// SPDX-License-Identifier: BSD-3-Clause
// Files that are not what their names say, as downloads and power failures leave them.
#pragma once

#include <string_view>

namespace rio::io {

/// What a file is by its first bytes, 32 or more, and what to do: "a page of HTML...: download it
/// again"; empty if it is none of those known.
std::string_view foreign_file(std::string_view head);

}  // namespace rio::io
