// SPDX-License-Identifier: BSD-3-Clause
// The load of a benchmark: a simulated flight through a room with a given number of detections.
#pragma once

#include <cstddef>

#include "rio/io/dataset.hpp"

namespace rio::bench {

/// Always the same bytes. Above twenty points a scan the radar is finer and sees weaker echoes in a
/// denser room; the strongest points of each scan are kept.
/// @param detections in each scan; near walls there may be fewer
/// @param seconds in the air, at a scan rate of 15 Hz and 200 Hz of the IMU
io::Dataset make_load(std::size_t detections, double seconds);

}  // namespace rio::bench
