// SPDX-License-Identifier: BSD-3-Clause
// Random access to a file, never past its end, and a chunk of a recording in memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "decompress.hpp"
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

  /// Throws Damage if the file ends earlier.
  void expect(std::uint64_t offset, std::uint64_t count) const {
    if (offset <= size_ && count <= size_ - offset) return;
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

class Chunk {
 public:
  /// Reads and decompresses. A chunk truncated by the end of the file is kept as far as it goes; an
  /// invalid one is not: its error is thrown when its bytes are used up.
  /// @param stored,declared bytes in the file and after decompression
  /// @param crc of the content, 0 if not known
  void load(FileBytes* file, std::uint64_t offset, std::uint64_t stored,
            std::string_view compression, std::uint64_t declared, std::uint32_t crc) {
    offset_ = offset;
    position_ = 0;
    file->expect(offset, 0);
    const std::uint64_t there = std::min(stored, file->size() - offset);
    file->read(offset, there, &stored_);
    error_.clear();
    if (compression.empty() || compression == "none") {
      bytes_.swap(stored_);
      if (declared != stored) error_ = "the two sizes of the chunk differ";
    } else {
      error_ = decompress(compression, stored_, declared, &bytes_);
    }
    if (error_.empty() && crc != 0 && crc32(bytes_) != crc) error_ = "its check sum is wrong";
    if (there < stored) {
      error_ = "the file ends inside of this chunk";
    } else if (!error_.empty()) {
      bytes_.clear();
    }
    if (!error_.empty() && bytes_.empty()) throw Damage(offset_, error_);
  }

  /// Whether anything is left, including an error.
  bool more() const { return position_ < bytes_.size() || !error_.empty(); }

  /// Passes the rest to `parse(WireReader&)` and advances by what that read.
  template <class Parse>
  auto parse(Parse&& parse) {
    WireReader reader(Bytes(bytes_).subspan(position_));
    try {
      auto result = parse(reader);
      position_ += reader.position();
      return result;
    } catch (const Damage& damage) {
      const std::uint64_t place = position_ + damage.offset;
      const std::string what = error_.empty() ? damage.what() : error_;
      position_ = bytes_.size();
      error_.clear();
      throw Damage(offset_, "byte " + std::to_string(place) + " of the chunk there: " + what);
    }
  }

 private:
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> stored_;
  std::uint64_t offset_ = 0;
  std::size_t position_ = 0;
  std::string error_;
};

}  // namespace rio::bag
