// SPDX-License-Identifier: BSD-3-Clause
// Known point clouds, of drivers and of public data sets.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "rio/bag/point_fields.hpp"

namespace rio::bag {

/// A known source of clouds. It matches a cloud that has all its fields and none except those and
/// `others`, and whose fields with a scale are integers.
struct PointPreset {
  const char* name;
  const char* meaning;
  Axes axes;
  const char* fields;  ///< QUANTITY=FIELD[*SCALE], separated by blanks
  const char* others;
  bool recognised;
  const char* doubt = "";  ///< another source with the same fields
};

/// The words between blanks.
std::vector<std::string> words_of(const std::string& text);
/// Splits "doppler=rdot*-1" into "doppler" and "rdot*-1".
std::pair<std::string, std::string> split_rule(const std::string& rule);

/// The requested one, or that of the fields; null if there is none.
/// @throws std::runtime_error that lists the presets if there is none of the requested name
const PointPreset* find_preset(const PointRequest& request, const std::vector<PointField>& fields);

}  // namespace rio::bag
