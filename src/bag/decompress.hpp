// SPDX-License-Identifier: BSD-3-Clause
// The compression methods of chunks, each if its library was present at build time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rio/bag/wire.hpp"

namespace rio::bag {

/// Replaces `out` by the decompressed `in`; memory grows with the output, not with the declared
/// size.
/// @param method "bz2", "lz4" (LZ4 frames) or "zstd"
/// @param declared size of the result
/// @return the error, or empty; `out` holds the output up to there
/// @throws std::runtime_error that names the missing library
std::string decompress(std::string_view method, Bytes in, std::uint64_t declared,
                       std::vector<std::uint8_t>* out);

/// CRC-32 (IEEE 802.3).
std::uint32_t crc32(Bytes bytes);

}  // namespace rio::bag
