// SPDX-License-Identifier: BSD-3-Clause
// Regular expressions: compiled once, as std::regex takes a compiler seconds.
#pragma once

#include <string>
#include <vector>

namespace rio::test {

/// The first group of every match, in order.
std::vector<std::string> matches(const std::string& text, const std::string& pattern);

}  // namespace rio::test
