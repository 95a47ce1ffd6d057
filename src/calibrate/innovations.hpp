// SPDX-License-Identifier: BSD-3-Clause
// What a run of the filter tells of the noise of its radar.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "rio/eval/noise_fit.hpp"
#include "rio/types.hpp"

namespace rio::calibrate {

/// The true state at a time, where it is known.
using TruthAt = std::function<std::optional<NavState>(Time)>;

/// What a probe has seen.
struct Innovations {
  std::vector<eval::NoiseSample> samples;
  std::size_t landmarks = 0;  ///< of them matches with landmarks
  std::size_t dopplers = 0;   ///< of them Dopplers
};

}  // namespace rio::calibrate
