// SPDX-License-Identifier: BSD-3-Clause
// The stamps of the IMU: unit, rate, order, and what the lost samples cost the estimate.
#pragma once

#include <filesystem>
#include <vector>

#include "check/finding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// @param all as recorded, in their order
/// @param good usable_if_not_all() of them (imu_check.hpp), else all; at least two
/// @param csv their file, to name lines of it; may be empty
/// @param unit of the stamps [ns]; unchanged if it is that, else the change is up to the caller
Finding check_stamps(const std::vector<ImuSample>& all, const std::vector<ImuSample>& good,
                     const io::ImuInfo& info, Source source, const std::filesystem::path& csv,
                     double* unit);

}  // namespace rio::check
