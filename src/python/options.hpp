// SPDX-License-Identifier: BSD-3-Clause
// The options of a Python call.
#pragma once

#include <string>
#include <vector>

#include "estimator_options.hpp"
#include "rio/options.hpp"

namespace rio::python {

/// @param texts option files, a later one overrides an earlier one
/// @param preset overrides theirs; may be empty
tools::EstimatorArguments estimator_of(const std::vector<std::string>& texts,
                                       const std::string& preset);

/// Preset, then the sensor files of a folder (if one is named), then the texts. Throws
/// std::runtime_error, "options:LINE: ..." if a line is at fault.
Options make_options(const std::vector<std::string>& texts, const std::string& preset,
                     const std::string& sensors);

}  // namespace rio::python
