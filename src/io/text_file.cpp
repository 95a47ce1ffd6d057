// SPDX-License-Identifier: BSD-3-Clause
#include "rio/io/text_file.hpp"

#include <stdexcept>
#include <utility>

namespace rio::io {

TextFile::TextFile(const std::filesystem::path& path)
    : path_(path), stream_(path, std::ios::binary | std::ios::app) {
  if (!stream_) fail();
}

void TextFile::replace() {
  if (std::exchange(replaced_, true) || !std::filesystem::is_regular_file(path_)) return;
  std::filesystem::resize_file(path_, 0);
}

void TextFile::write(std::string_view text) {
  replace();
  stream_.write(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream_) fail();
}

void TextFile::flush() {
  stream_.flush();
  if (!stream_) fail();
}

void TextFile::close() {
  replace();
  stream_.close();
  if (!stream_) fail();
}

void TextFile::fail() const {
  throw std::runtime_error(path_.string() + ": cannot be written");
}

}  // namespace rio::io
