// SPDX-License-Identifier: BSD-3-Clause
// Generated blocks of a Markdown file, each between two comment lines.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "rio/io/csv.hpp"
#include "rio/io/text_file.hpp"

namespace rio::experiment {

/// Replaces the text between `<!-- rio experiment NAME -->` and the next `<!-- end -->`.
/// @throws std::runtime_error if the file has no such block; it is unchanged then
inline void replace_results_block(const std::filesystem::path& path, const std::string& name,
                                  const std::string& markdown) {
  const std::string begin = "<!-- rio experiment " + name + " -->\n";
  const std::string end = "<!-- end -->";
  std::string text = io::read_text(path);
  const std::size_t from = text.find(begin);
  const std::size_t to = from == std::string::npos ? from : text.find(end, from);
  if (to == std::string::npos) {
    throw std::runtime_error(path.string() + ": no block from \"" +
                             begin.substr(0, begin.size() - 1) + "\" to \"" + end + "\"");
  }
  text.replace(from, to - from, begin + "\n" + markdown + "\n");
  io::TextFile file(path);
  file.write(text);
  file.close();
}

/// The experiments that have a block, in the order of the file.
inline std::vector<std::string> results_blocks(const std::filesystem::path& path) {
  const std::string begin = "<!-- rio experiment ";
  const std::string text = io::read_text(path);
  std::vector<std::string> names;
  for (std::size_t at = 0; (at = text.find(begin, at)) != std::string::npos;) {
    at += begin.size();
    names.push_back(text.substr(at, text.find(" -->", at) - at));
  }
  return names;
}

}  // namespace rio::experiment
