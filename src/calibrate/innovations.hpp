// SPDX-License-Identifier: BSD-3-Clause
// Innovations of a run of the filter, as a measure of the noise of its radar.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "rio/eval/noise_fit.hpp"
#include "rio/types.hpp"

namespace rio::calibrate {

/// The true state at a time, if known.
using TruthAt = std::function<std::optional<NavState>(Time)>;

/// Result of a probe.
struct Innovations {
  std::vector<eval::NoiseSample> samples;
  std::size_t landmarks = 0;  ///< of these, matches with landmarks
  std::size_t dopplers = 0;   ///< of these, Dopplers
};

}  // namespace rio::calibrate
