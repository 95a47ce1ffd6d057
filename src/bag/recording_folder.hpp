// SPDX-License-Identifier: BSD-3-Clause
// The recordings in a folder, by the names of their files: what belongs together, what is missing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rio::bag {

/// Without a ".zstd" at its end.
std::filesystem::path plain_name(const std::filesystem::path& path);
/// Without a ".zstd" and digits: the same for all parts of a split recording.
std::string without_digits(const std::filesystem::path& path);
/// Of a part of a split recording, as in "flight_12.db3"; -1 if there is none.
std::int64_t number_of(const std::filesystem::path& path);

/// Its bags, parts in the order of their numbers; if there are none, the folders in it that have
/// some.
std::vector<std::filesystem::path> recordings_in(const std::filesystem::path& folder);
/// The parts of the same recording that rosbag did not close, when it was killed.
std::vector<std::filesystem::path> not_closed(const std::filesystem::path& folder,
                                              const std::filesystem::path& part);
/// By the numbers of the parts, in front of one of them; empty if none is missing.
std::string missing_before(const std::vector<std::filesystem::path>& files, std::size_t i);

/// The parts behind the last one that metadata.yaml of rosbag2 lists; empty if none is missing.
std::string missing_after(const std::vector<std::filesystem::path>& files);

}  // namespace rio::bag
