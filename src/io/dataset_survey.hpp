// SPDX-License-Identifier: BSD-3-Clause
// One pass over a dataset folder; private to rio_io.
#pragma once

#include <filesystem>

#include "rio/io/recording_stream.hpp"

namespace rio::io {

/// Throws as read_dataset() does.
/// @param samples receives the samples and scans, if not null
RecordingOutline survey(const std::filesystem::path& root, Truth truth, Dataset* samples);

}  // namespace rio::io
