// SPDX-License-Identifier: BSD-3-Clause
#include "positions.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace rio::bag {

bool is_position(const std::string& type) {
  return type == kPointType || type == kFixType;
}

NavState PositionReader::read(const Topic& topic, Bytes message, Header* header) {
  WireReader reader = reader_of(topic.encoding, message);
  *header = read_header(&reader);
  const bool is_fix = topic.type == kFixType;
  const std::size_t where = reader.position();
  if (is_fix) {
    if (reader.read<std::int8_t>() < 0) throw Damage(where, "it says that there is no fix");
    (void)reader.read<std::uint16_t>();  // which satellites
  }
  Vector3d read;
  for (double& value : read) value = reader.read<double>();
  if (!read.allFinite()) throw Damage(where, "a position that is not finite");
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  NavState state;
  state.time = header->stamp;
  state.p_WB = is_fix ? from_first(read[0], read[1], read[2]) : read;
  state.q_WB.coeffs().setConstant(kNaN);
  state.v_WB.setConstant(kNaN);
  return state;
}

Vector3d PositionReader::from_first(double latitude, double longitude, double altitude) {
  constexpr double kEquator = 6378137.0;               // WGS 84 [m]
  constexpr double kEccentricity2 = 6.69437999014e-3;  // squared
  constexpr double kDegree = std::numbers::pi / 180.0;
  const double phi = latitude * kDegree;
  const double lambda = longitude * kDegree;
  if (!first_) {
    const double s = 1.0 - kEccentricity2 * std::pow(std::sin(phi), 2);
    const double prime_vertical = kEquator / std::sqrt(s);
    const double meridian = prime_vertical * (1.0 - kEccentricity2) / s;
    first_ = {phi, lambda, altitude, meridian + altitude, prime_vertical + altitude};
  }
  const double turn = std::remainder(lambda - first_->longitude, 2.0 * std::numbers::pi);
  const double between = 0.5 * (phi + first_->latitude);
  return {turn * first_->prime_vertical * std::cos(between),
          (phi - first_->latitude) * first_->meridian, altitude - first_->altitude};
}

}  // namespace rio::bag
