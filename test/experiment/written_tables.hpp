// SPDX-License-Identifier: BSD-3-Clause
// Which tables this very program has written already, in a file beside them, so that a long series
// can be stopped and resumed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "rio/io/csv.hpp"
#include "rio/io/text_file.hpp"

namespace rio::experiment {

/// FNV-1a of a file as text: equal for the same program.
inline std::string fingerprint(const std::filesystem::path& file) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char c : io::read_text(file)) {
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  }
  std::ostringstream text;
  text << std::hex << hash;
  return text.str();
}

class WrittenTables {
 public:
  /// @param file a line per table: the program and its arguments, and the table
  WrittenTables(std::filesystem::path file, std::string program)
      : file_(std::move(file)), program_(std::move(program)) {}

  bool has(const std::string& table) const {
    std::ifstream in(file_);
    for (std::string line; std::getline(in, line);) {
      if (line == line_of(table)) return true;
    }
    return false;
  }
  /// To be called once it is written.
  void add(const std::string& table) {
    std::string text = std::filesystem::exists(file_) ? io::read_text(file_) : "";
    io::TextFile out(file_);
    out.write(text + line_of(table) + "\n");
    out.close();
  }

 private:
  std::string line_of(const std::string& table) const { return program_ + " " + table; }

  std::filesystem::path file_;
  std::string program_;
};

}  // namespace rio::experiment
