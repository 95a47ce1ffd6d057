// SPDX-License-Identifier: BSD-3-Clause
// An output file that reports all write errors.
#pragma once

#include <filesystem>
#include <fstream>
#include <string_view>

namespace rio::io {

/// Opens in the constructor, throws std::runtime_error naming the file when anything cannot be
/// written. What the file held stays until the first write() or close(): a command that fails
/// before it has a result replaces nothing. A full disk often shows only in close(): call it before
/// relying on the file.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& path);
  void write(std::string_view text);
  /// Flushes the written data to the system.
  void flush();
  void close();

 private:
  void replace();
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::ofstream stream_;
  bool replaced_ = false;
};

}  // namespace rio::io
