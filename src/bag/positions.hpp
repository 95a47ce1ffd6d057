// SPDX-License-Identifier: BSD-3-Clause
// Ground truth without an attitude: the positions of a total station or of GNSS.
#pragma once

#include <optional>

#include "rio/bag/messages.hpp"

namespace rio::bag {

/// geometry_msgs/PointStamped or sensor_msgs/NavSatFix.
bool is_position(const std::string& type);

/// The positions of one topic.
class PositionReader {
 public:
  /// @return the position, the rest NaN. Of a fix it is east, north and up of the first one [m],
  /// along the ellipsoid WGS 84: the local tangent within 2 mm in 100 m, 0.2 m in 1 km, up to 50
  /// deg of latitude.
  /// Throws Damage if the bytes are not such a message, not finite, or no fix.
  NavState read(const Topic& topic, Bytes message, Header* header);

 private:
  Vector3d from_first(double latitude, double longitude, double altitude);

  struct First {
    double latitude, longitude;       ///< [rad]
    double altitude;                  ///< [m]
    double meridian, prime_vertical;  ///< radii of curvature at that altitude [m]
  };
  std::optional<First> first_;
};

}  // namespace rio::bag
