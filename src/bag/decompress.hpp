// SPDX-License-Identifier: BSD-3-Clause
// The compression methods of chunks, each if its library was present at build time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rio/bag/wire.hpp"

namespace rio::bag {

/// Replaces `out` by the decompressed `in`; memory grows with the output, not with the declared
/// size.
/// @param method "bz2", "lz4" (LZ4 frames) or "zstd"
/// @param declared size of the result; empty: any up to 1 GiB
/// @return the error, or empty; `out` holds the output up to there
/// @throws std::runtime_error that names the missing library
std::string decompress(std::string_view method, Bytes in, std::optional<std::uint64_t> declared,
                       std::vector<std::uint8_t>* out);

/// "zstd" or "lz4" if the bytes begin as a frame of it, else empty.
std::string_view compression_of(Bytes in);
/// Of a file compressed as a whole with zstd a temporary copy that is not, which lives as long as
/// the program. Throws if it cannot be unpacked.
std::filesystem::path unpacked(const std::filesystem::path& path);

/// CRC-32 (IEEE 802.3).
std::uint32_t crc32(Bytes bytes);

}  // namespace rio::bag
