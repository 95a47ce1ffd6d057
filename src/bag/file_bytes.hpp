// SPDX-License-Identifier: BSD-3-Clause
// Random access to a file, never past its end.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "rio/bag/wire.hpp"

namespace rio::bag {

/// Size limit of a record, compressed or not; more is treated as damage.
inline constexpr std::uint64_t kMaxRecord = std::uint64_t{1} << 30;

class FileBytes {
 public:
  explicit FileBytes(const std::filesystem::path& path)
      : size_(std::filesystem::file_size(path)), stream_(path, std::ios::binary) {
    if (!stream_) throw std::runtime_error(path.string() + ": cannot be read");
  }

  std::uint64_t size() const { return size_; }

  /// Whether `count` bytes at `offset` are in the file.
  bool holds(std::uint64_t offset, std::uint64_t count) const {
    return offset <= size_ && count <= size_ - offset;
  }

  /// Throws Damage if the file ends earlier.
  void expect(std::uint64_t offset, std::uint64_t count) const {
    if (holds(offset, count)) return;
    throw Damage(offset, "the file ends inside of a record: it has " + std::to_string(size_) +
                             " bytes, the record needs " + std::to_string(count) + " from here");
  }

  /// Replaces `out`; throws Damage if the file ends earlier, or for more than kMaxRecord.
  void read(std::uint64_t offset, std::uint64_t count, std::vector<std::uint8_t>* out) {
    expect(offset, count);
    if (count > kMaxRecord) throw Damage(offset, "a record of more than 1 GiB");
    out->resize(static_cast<std::size_t>(count));
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(offset));
    stream_.read(reinterpret_cast<char*>(out->data()), static_cast<std::streamsize>(count));
    if (stream_.gcount() != static_cast<std::streamsize>(count)) {
      throw Damage(offset, "cannot be read");
    }
  }

 private:
  std::uint64_t size_;
  std::ifstream stream_;
};

}  // namespace rio::bag
