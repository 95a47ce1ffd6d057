// SPDX-License-Identifier: BSD-3-Clause
// A chunk of a recording in memory, and its errors.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "decompress.hpp"
#include "file_bytes.hpp"
#include "rio/bag/wire.hpp"

namespace rio::bag {

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
