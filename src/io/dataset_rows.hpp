// SPDX-License-Identifier: BSD-3-Clause
// The rows of imu0/data.csv and radar0/data.csv, every number exactly; private to rio_io.
#pragma once

#include <string>

#include "rio/types.hpp"

namespace rio::io {

inline constexpr const char* kImuHeader =
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";

/// ",x,y,z"
void append(std::string* row, const Vector3d& v);

void append_row(std::string* text, const ImuSample& sample);

/// @param sigmas include the columns of the detections' own sigmas
std::string radar_header(bool sigmas);
/// A row per detection; one with empty fields for an empty scan.
void append_rows(std::string* text, const RadarScan& scan, bool sigmas);

}  // namespace rio::io
