// SPDX-License-Identifier: BSD-3-Clause
// The load of a measurement: a simulated flight through a room with as much to see as asked for.
#pragma once

#include <cstddef>

#include "rio/io/dataset.hpp"

namespace rio::bench {

/// The same bytes whenever asked for. Above twenty points a scan the radar is a finer one that sees
/// weaker echoes in a denser room; of each scan the strongest points are kept.
/// @param detections in each scan; near walls there may be fewer
/// @param seconds in the air, at a scan rate of 15 Hz and 200 Hz of the IMU
io::Dataset make_load(std::size_t detections, double seconds);

}  // namespace rio::bench
