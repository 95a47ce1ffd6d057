// SPDX-License-Identifier: BSD-3-Clause
// What a command prints with --json.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rio::tools {

/// One line of JSON. Bytes that are not UTF-8, as in the name of a file, become U+FFFD.
inline std::string json_line(const nlohmann::ordered_json& all) {
  return all.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace rio::tools
