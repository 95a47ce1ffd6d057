// SPDX-License-Identifier: BSD-3-Clause
// What a command writes: it does not replace what it reads.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "rio/io/text_file.hpp"

namespace rio::tools {

/// The path without a slash at its end.
inline std::filesystem::path named(const std::filesystem::path& path) {
  const std::filesystem::path normal = path.lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

/// @throws std::runtime_error if the folder of a file to write is not there, or the file is one
inline void expect_folder(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) {
    throw std::runtime_error(file.string() + ": cannot be written: it is a folder");
  }
  const std::filesystem::path folder = file.parent_path();
  if (folder.empty() || std::filesystem::is_directory(folder)) return;
  throw std::runtime_error(file.string() + ": cannot be written: there is no such folder");
}

/// Writes a file of this text.
inline void write_text(const std::filesystem::path& path, const std::string& text) {
  io::TextFile file(path);
  file.write(text);
  file.close();
}

/// Whether `file` is the file `path`, or belongs to the recording in the folder `path`: what is in
/// its sub-folders, and beside these what no command writes as a result.
inline bool is_part_of(const std::filesystem::path& file, const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  if (!fs::is_directory(path)) return fs::exists(path) && fs::equivalent(file, path);
  const auto options = fs::directory_options::skip_permission_denied;
  for (auto at = fs::recursive_directory_iterator(path, options); at != fs::end(at); ++at) {
    const std::string kind = at->path().extension().string();
    const bool result = at.depth() == 0 && (kind == ".tum" || kind == ".csv" || kind == ".svg");
    if (!result && at->is_regular_file() && fs::equivalent(file, at->path())) return true;
  }
  return false;
}

/// Call it before an output is opened. Empty names are none.
/// @param inputs files, and folders of recordings
/// @throws std::runtime_error if an output is an input, or named twice
inline void protect_inputs(const std::vector<std::string>& inputs,
                           const std::vector<std::string>& outputs) {
  namespace fs = std::filesystem;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (std::size_t k = 0; k < i; ++k) {
      if (fs::weakly_canonical(outputs[i]) == fs::weakly_canonical(outputs[k]) &&
          !fs::is_character_file(outputs[i])) {
        throw std::runtime_error(outputs[i] + ": is named for two outputs");
      }
    }
    if (!fs::is_regular_file(outputs[i])) continue;
    for (const std::string& input : inputs) {
      if (!input.empty() && is_part_of(outputs[i], input)) {
        throw std::runtime_error(outputs[i] + ": would replace an input; nothing was written");
      }
    }
  }
}

}  // namespace rio::tools
