// SPDX-License-Identifier: BSD-3-Clause
// A folder whose points or samples have other axes, units or another sign than its files should.
#pragma once

#include <memory>

#include "rio/bag/recording.hpp"
#include "rio/io/recording_stream.hpp"

namespace rio::bag {

/// The folder with the axes of the points, the sign of the Doppler and the axes and units of the
/// IMU of the request; those that are not given are those of its format.
/// @throws std::runtime_error if the axes are unknown
std::unique_ptr<io::RecordingStream> turned(std::unique_ptr<io::RecordingStream> folder,
                                            const RecordingRequest& request);

}  // namespace rio::bag
