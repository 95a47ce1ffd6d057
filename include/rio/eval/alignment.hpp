// SPDX-License-Identifier: BSD-3-Clause
// Rigid transforms that align an estimate with the truth before errors are computed.
//
// (E1) C = sum (p_true - mean)(p_est - mean)^T;  translation = mean_true - R mean_est
// (E2) yaw:   R = Rz(atan2(C10 - C01, C00 + C11)) maximises tr(R^T C) over rotations about z
// (E3) SE(3): C = U S V^T, R = U diag(1, 1, det(U) det(V)) V^T maximises it over all rotations
// Reference: Umeyama, 1991, eq. 39-43 without scale; Zhang and Scaramuzza, 2018, sec. III (yaw).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/eval/pairing.hpp"

namespace rio::eval {

/// Degrees of freedom removed before the comparison.
enum class AlignmentKind {
  kNone,    ///< compare as is: estimate and truth share the frame W
  kOrigin,  ///< the first poses coincide
  kYaw,     ///< yaw and position (4 degrees of freedom): what an inertial estimator cannot observe
  kSe3,     ///< any rigid motion (6 degrees of freedom)
};

/// The kind called "none", "origin", "yaw" or "se3".
std::optional<AlignmentKind> alignment_kind(const std::string& name);

/// Transform from the estimate to the truth.
struct Alignment {
  Pose transform{};
  /// False if the positions do not determine the rotation (no horizontal extent for the yaw, all on
  /// a line for SE(3)): position errors are still minimal, attitude errors are meaningless.
  bool unique = true;
};

/// Makes the first estimate coincide with the first true pose. No pairs: identity.
/// @throws std::runtime_error if that has no attitude (NaN), as one of a total station
Alignment align_origin(const std::vector<PosePair>& pairs);

/// Yaw about W's z axis and translation of least squared position error. No pairs: identity.
Alignment align_yaw(const std::vector<PosePair>& pairs);

/// Rotation and translation of least squared position error. No pairs: identity.
Alignment align_se3(const std::vector<PosePair>& pairs);

/// The alignment of the given kind; throws as align_origin() does.
Alignment find_alignment(const std::vector<PosePair>& pairs, AlignmentKind kind);

/// The pose transformed by T: p -> T.rotation p + T.translation.
inline StampedPose transformed(const Pose& T, const StampedPose& pose) {
  return {pose.time, T.rotation * pose.p + T.translation, (T.rotation * pose.q).normalized()};
}

/// The pairs with their estimates transformed by T.
std::vector<PosePair> transformed(const Pose& T, std::vector<PosePair> pairs);

}  // namespace rio::eval
