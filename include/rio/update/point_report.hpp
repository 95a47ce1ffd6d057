// SPDX-License-Identifier: BSD-3-Clause
// The detections of a scan for the reader of a report: label, world position and Doppler residual
// by the estimate after the update.
#pragma once

#include <vector>

#include "rio/core/static_vector.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/frontend/own_echoes.hpp"
#include "rio/report.hpp"

namespace rio {

/// @param received the filtered scan
/// @param own its own echoes
/// @param seen what was made of the rest, in its order
/// @param trails the distances of trails are measurements
/// @param out replaced; allocates only beyond its capacity
void report_points(const DetectionList& received, const OwnEchoList& own, const Observations& seen,
                   const Estimate& x, bool trails, std::vector<PointReport>* out);

}  // namespace rio
