// SPDX-License-Identifier: BSD-3-Clause
// What recorders and drivers do to messages, undone: messages compressed one by one, scans sent
// point by point, receive times after the clock of the recorder was set back.
#pragma once

#include <filesystem>
#include <memory>

#include "rio/bag/message_stream.hpp"

namespace rio::bag {

/// Scans of kTiScanType become one message: the messages of their points, each after its length.
std::unique_ptr<MessageStream> tidied(std::unique_ptr<MessageStream> raw);

/// The file itself; of a file compressed as a whole with zstd a temporary copy that is not, which
/// lives as long as the program. Throws if it cannot be unpacked.
std::filesystem::path unpacked(const std::filesystem::path& path);

}  // namespace rio::bag
