// SPDX-License-Identifier: BSD-3-Clause
// From the named fields of a point cloud to detections: assignment of fields to quantities, with
// unit, sign and axes. Matched by name, never by position.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rio/bag/messages.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::bag {

/// The quantities of a detection. Points are x y z or range, azimuth, elevation.
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
constexpr std::array<std::string_view, 4> names_of(Axes) {
  return {"flu", "ti", "rdf", "frd"};
}

/// To forward, left, up.
Vector3d to_flu(Axes axes, const Vector3d& v);
/// The same as a matrix.
Matrix3d flu_from(Axes axes);
/// @throws std::runtime_error if there are none of this name
Axes axes_named(const std::string& name);

/// User settings for the points. All may be empty: then a preset with exactly the given fields is
/// used, else every quantity that has exactly one known name.
struct PointRequest {
  /// The field of a quantity: "doppler=rdot", "snr=power*0.1", or alternatives,
  /// "doppler=rdot*-1,velocity".
  struct Rule {
    std::string text;
    std::string where;  ///< "FILE:LINE" for messages; empty: the command line
  };
  std::string preset;        ///< one of point_presets()
  std::vector<Rule> fields;  ///< the last one for a quantity counts; overrides the preset
  std::string axes;          ///< "flu", "ti", "rdf", "frd"; overrides the preset
  bool approaching = false;  ///< the Doppler is positive towards the radar
  std::string where;         ///< "FILE:LINE" for messages; empty: the command line
};

class PointMap {
 public:
  /// @throws std::runtime_error that lists the fields found: a required quantity has no field, or
  /// several; a name, preset or axes are unknown; with file and line if available
  PointMap(const std::vector<PointField>& fields, const PointRequest& request);

  /// Appends the detections [m, m/s, dB], axes x forward, y left, z up. Points that are not finite
  /// are dropped.
  /// @return number of dropped points
  std::size_t convert(const PointCloud& cloud, std::vector<RadarDetection>* detections) const;

  /// @throws std::runtime_error if azimuths or elevations are beyond a turn: they are degrees
  void check_angles(const PointCloud& cloud) const;

  /// The fields of the cloud.
  const std::vector<PointField>& fields() const { return fields_; }
  /// The assignment as one line.
  std::string text() const;
  /// The same for messages, into RadarInfo::fields and ::axes.
  void name(io::RadarInfo* info) const;
  /// From the axes of the cloud to forward, left, up.
  Matrix3d rotation() const { return flu_from(axes_); }

 private:
  struct Source {
    PointField field;
    double scale = 1.0;
  };
  void set_by(const PointRequest& request);
  void set_by_rule(const std::string& rule);
  std::optional<PointField> find(const std::string& name) const;
  /// Of a point, with the scale; 0 without a field.
  double number(const PointCloud& cloud, std::uint64_t point, std::size_t quantity) const;
  void match_names();
  void settle_point();  ///< keeps x y z, or else the polar quantities
  [[noreturn]] void fail(const std::string& what) const;

  std::vector<PointField> fields_;
  std::array<std::optional<Source>, kQuantityCount> sources_;
  Axes axes_ = Axes::kFlu;
  std::string origin_;  ///< of the assignment
  std::string doubt_;   ///< another one that is possible
};

/// Names of the presets with their use, one line each.
std::string point_presets();

}  // namespace rio::bag
