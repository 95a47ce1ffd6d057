// SPDX-License-Identifier: BSD-3-Clause
// Possible axes of a radar relative to those of the body, with its sign of the Doppler: the
// hypotheses of motion_check.hpp, and the texts for them and for their correction.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "check/advice.hpp"
#include "check/motion.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// What the ranges say of the sign of the Doppler.
enum class DopplerSign { kUnknown, kAsConfigured, kLeansOpposite, kOpposite };

inline bool seems_opposite(DopplerSign sign) {
  return sign == DopplerSign::kLeansOpposite || sign == DopplerSign::kOpposite;
}

/// A hypothesis on the axes and sign of the radar velocities.
struct Axes {
  Matrix3d R = Matrix3d::Identity();  ///< from radar axes to body axes; improper if mirrored
  bool doppler_flipped = false;       ///< if so, R includes the sign
  double turn = 0.0;                  ///< angle to the configured mounting [rad]
  /// Direction in radar axes; the motion does not show the turn about it. Zero: it shows all.
  Vector3d about = Vector3d::Zero();

  bool as_configured() const { return !doppler_flipped && turn < 1e-6; }
};

/// The configured mounting first, then the same with the Doppler flipped, then by increasing angle.
std::vector<Axes> candidates(const Quaternion& configured);

/// Whether the sign of the Doppler allows these axes: what looks like the other sign may be
/// mirrored points, or an inverted accelerometer.
bool allowed(const Axes& axes, const Matrix3d& configured, DopplerSign sign);

/// Between two rotations [rad].
double angle_between(const Matrix3d& a, const Matrix3d& b);

/// A mirror is two swapped axes or one of the wrong sign: names them. Empty if it is neither.
std::optional<std::string> mirror_text(const Matrix3d& M, const char* whose);
/// The same of the points, if these are the true axes.
std::optional<std::string> mirror_of_points(const Axes& axes, const Matrix3d& configured);

/// The error of the configured mounting, if these are the true axes.
/// @param sign opposite: it is no mirror
std::string describe(const Matrix3d& configured, const Axes& axes, DopplerSign sign);

/// What corrects it: other axes of the points if they are known to be mounted as configured, else
/// the mounting.
/// @param fitted the axes as the mounting to propose
std::string change_of(const Matrix3d& configured, const Axes& axes, const FittedRotation& fitted,
                      DopplerSign sign, const Options& options, const Advice& advice);

}  // namespace rio::check
