// SPDX-License-Identifier: BSD-3-Clause
// How the axes of a radar may lie to those of the body, its sign of the Doppler included: the
// hypotheses of motion_check.hpp, and how they and the way to mend them are said.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "check/finding.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// A hypothesis about what the velocities of the radar are.
struct Axes {
  Matrix3d R = Matrix3d::Identity();  ///< from the radar's axes to the body's; improper if mirrored
  bool doppler_flipped = false;       ///< then R holds the sign
  double turn = 0.0;                  ///< angle to the configured mounting [rad]
};

/// The configured mounting first, then it with the Doppler flipped, then by growing angle.
std::vector<Axes> candidates(const Quaternion& told);

/// Between two rotations [rad].
double angle_between(const Matrix3d& a, const Matrix3d& b);

/// A mirror is two axes swapped or one of the wrong sign: which of whose. Empty if it is neither.
std::optional<std::string> mirror_text(const Matrix3d& M, const char* whose);

/// What is wrong with the configured mounting, if these are the axes.
std::string describe(const Matrix3d& told, const Axes& axes);

/// The line that mends it. @param radar its number
std::string change_of(const Matrix3d& told, const Axes& axes, const Options& options, Source source,
                      std::size_t radar);

}  // namespace rio::check
