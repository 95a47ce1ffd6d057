// SPDX-License-Identifier: BSD-3-Clause
// From the named fields of a point cloud to detections: which field is which quantity, in which
// unit, sign and axes. Matched by name, never by position.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "rio/bag/messages.hpp"
#include "rio/types.hpp"

namespace rio::bag {

/// What a detection consists of. Points are x y z or range, azimuth, elevation.
enum Quantity {
  kX,
  kY,
  kZ,
  kRange,
  kAzimuth,    ///< from the x axis towards the y axis
  kElevation,  ///< from the x-y plane towards the z axis
  kDoppler,
  kSnr,
  kNoise,
  kSigmaRange,
  kSigmaAzimuth,
  kSigmaElevation,
  kSigmaDoppler,
  kQuantityCount
};

/// Axes of the points: forward left up (those of rio), TI's right forward up, right down forward,
/// forward right down.
enum class Axes { kFlu, kTi, kRdf, kFrd };

/// What the user says of the points. All of it may be left empty: then a preset whose fields are
/// exactly those found is taken, and else every quantity whose name is the only known one.
struct PointRequest {
  /// What a quantity is made of: "doppler=rdot", "snr=power*0.1", or one of several that a cloud
  /// may have, "doppler=rdot*-1,velocity".
  struct Rule {
    std::string text;
    std::string where;  ///< "FILE:LINE" for messages; empty: of the command line
  };
  std::string preset;        ///< one of point_presets()
  std::vector<Rule> fields;  ///< of two for a quantity the last one counts; wins over the preset
  std::string axes;          ///< "flu", "ti", "rdf", "frd"; wins over the preset
  bool approaching = false;  ///< the Doppler is positive towards the radar
  std::string where;         ///< "FILE:LINE" for messages; empty: of the command line
};

class PointMap {
 public:
  /// @throws std::runtime_error that lists the fields found: a quantity that is needed has none, or
  /// has several; a name, preset or axes that are not known; with file and line where there are any
  PointMap(const std::vector<PointField>& fields, const PointRequest& request);

  /// Appends the detections [m, m/s, dB], axes x forward, y left, z up. Points that are not finite
  /// are left out.
  /// @return how many were left out
  std::size_t convert(const PointCloud& cloud, std::vector<RadarDetection>* detections) const;

  /// The fields it was made for.
  const std::vector<PointField>& fields() const { return fields_; }
  /// What was matched, as one line.
  std::string text() const;

 private:
  struct Source {
    PointField field;
    double scale = 1.0;
  };
  void set_by(const PointRequest& request);
  void set_by_rule(const std::string& rule);
  void set(int quantity, const std::string& name_and_scale);
  std::optional<PointField> find(const std::string& name) const;
  void match_names();
  void settle_point();  ///< keeps x y z, or else the polar ones
  [[noreturn]] void fail(const std::string& what) const;

  std::vector<PointField> fields_;
  std::array<std::optional<Source>, kQuantityCount> sources_;
  Axes axes_ = Axes::kFlu;
  std::string origin_;  ///< of the match
};

/// Names of the presets with what they are for, one line each.
std::string point_presets();

}  // namespace rio::bag
