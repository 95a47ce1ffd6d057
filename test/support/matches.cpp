// SPDX-License-Identifier: BSD-3-Clause
#include "support/matches.hpp"

#include <regex>

namespace rio::test {

std::vector<std::string> matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> all;
  for (std::sregex_iterator m(text.begin(), text.end(), regex), end; m != end; ++m) {
    all.push_back((*m)[1]);
  }
  return all;
}

}  // namespace rio::test
