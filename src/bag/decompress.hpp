// SPDX-License-Identifier: BSD-3-Clause
// The compressions of chunks, each if its library was there at build time.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rio/bag/wire.hpp"

namespace rio::bag {

/// Replaces `out` by what is in `in`; memory grows with what comes out, not with what is declared.
/// @param method "bz2", "lz4" (LZ4 frames) or "zstd"
/// @param declared size of the result
/// @return what is wrong, or empty; `out` holds what came before
/// @throws std::runtime_error that names the library which is missing
std::string decompress(std::string_view method, Bytes in, std::uint64_t declared,
                       std::vector<std::uint8_t>* out);

/// CRC-32 (IEEE 802.3).
std::uint32_t crc32(Bytes bytes);

}  // namespace rio::bag
