// SPDX-License-Identifier: BSD-3-Clause
// Rigid transforms that lay an estimate over the truth before errors are taken.
//
// (E1) C = sum (p_true - mean)(p_est - mean)^T;  translation = mean_true - R mean_est
// (E2) yaw:   R = Rz(atan2(C10 - C01, C00 + C11)) maximises tr(R^T C) over rotations about z
// (E3) SE(3): C = U S V^T, R = U diag(1, 1, det(U) det(V)) V^T maximises it over all rotations
// Reference: Umeyama, 1991, eq. 39-43 without scale; Zhang and Scaramuzza, 2018, sec. III (yaw).
#pragma once

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/eval/association.hpp"

namespace rio::eval {

/// Which freedom is taken out before the comparison.
enum class AlignmentKind {
  kNone,    ///< compare as is: estimate and truth share the frame W
  kOrigin,  ///< the first poses coincide
  kYaw,     ///< yaw and position (4 degrees of freedom): what an inertial estimator cannot observe
  kSe3,     ///< any rigid motion (6 degrees of freedom)
};

/// The kind called "none", "origin", "yaw" or "se3".
inline std::optional<AlignmentKind> alignment_kind(const std::string& name) {
  if (name == "none") return AlignmentKind::kNone;
  if (name == "origin") return AlignmentKind::kOrigin;
  if (name == "yaw") return AlignmentKind::kYaw;
  if (name == "se3") return AlignmentKind::kSe3;
  return std::nullopt;
}

/// Motion that takes the estimate to the truth.
struct Alignment {
  Pose transform{};
  /// False if the positions do not determine the rotation (no horizontal extent for the yaw, all on
  /// a line for SE(3)): position errors are minimal nevertheless, attitude errors mean nothing.
  bool unique = true;
};

namespace alignment_detail {

/// Relative size below which a direction of C is rounding rather than motion.
inline constexpr double kDegenerate = 1e-12;

struct Moments {
  Vector3d truth_mean = Vector3d::Zero();
  Vector3d estimate_mean = Vector3d::Zero();
  Matrix3d correlation = Matrix3d::Zero();  ///< C of (E1)
};

inline Moments moments(const std::vector<PosePair>& pairs) {
  Moments m;
  const double n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    m.truth_mean += pair.truth.p / n;
    m.estimate_mean += pair.estimate.p / n;
  }
  for (const PosePair& pair : pairs) {
    m.correlation +=
        (pair.truth.p - m.truth_mean) * (pair.estimate.p - m.estimate_mean).transpose();  // (E1)
  }
  return m;
}

inline Pose about_means(const Quaternion& rotation, const Moments& m) {
  return {rotation, m.truth_mean - rotation * m.estimate_mean};  // (E1)
}

}  // namespace alignment_detail

/// Makes the first estimate coincide with the first true pose. No pairs: identity.
inline Alignment align_origin(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {};
  const PosePair& first = pairs.front();
  const Quaternion rotation = (first.truth.q * first.estimate.q.conjugate()).normalized();
  return {{rotation, first.truth.p - rotation * first.estimate.p}, true};
}

/// Yaw about W's z axis and translation of least squared position error. No pairs: identity.
inline Alignment align_yaw(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {{}, false};
  const alignment_detail::Moments m = alignment_detail::moments(pairs);
  const Matrix3d& C = m.correlation;
  const double sine = C(1, 0) - C(0, 1);
  const double cosine = C(0, 0) + C(1, 1);
  const bool unique = std::hypot(sine, cosine) > alignment_detail::kDegenerate * C.norm();
  const double yaw = unique ? std::atan2(sine, cosine) : 0.0;  // (E2)
  return {alignment_detail::about_means(quaternion_exp({0.0, 0.0, yaw}), m), unique};
}

/// Rotation and translation of least squared position error. No pairs: identity.
inline Alignment align_se3(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {{}, false};
  const alignment_detail::Moments m = alignment_detail::moments(pairs);
  const Eigen::JacobiSVD<Matrix3d> svd(m.correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d& U = svd.matrixU();
  const Matrix3d& V = svd.matrixV();
  // without the sign the best orthogonal matrix may be a reflection
  const Vector3d signs(1.0, 1.0, U.determinant() * V.determinant() < 0.0 ? -1.0 : 1.0);
  const Matrix3d R = U * signs.asDiagonal() * V.transpose();  // (E3)
  const Vector3d& s = svd.singularValues();
  return {alignment_detail::about_means(Quaternion(R).normalized(), m),
          s(1) > alignment_detail::kDegenerate * s(0)};
}

/// The alignment of the given kind.
inline Alignment find_alignment(const std::vector<PosePair>& pairs, AlignmentKind kind) {
  switch (kind) {
    case AlignmentKind::kOrigin:
      return align_origin(pairs);
    case AlignmentKind::kYaw:
      return align_yaw(pairs);
    case AlignmentKind::kSe3:
      return align_se3(pairs);
    case AlignmentKind::kNone:
      break;
  }
  return {};
}

/// The pose moved by T: p -> T.rotation p + T.translation.
inline StampedPose transformed(const Pose& T, const StampedPose& pose) {
  return {pose.time, T.rotation * pose.p + T.translation, (T.rotation * pose.q).normalized()};
}

/// The pairs with their estimates moved by T.
inline std::vector<PosePair> transformed(const Pose& T, std::vector<PosePair> pairs) {
  for (PosePair& pair : pairs) pair.estimate = transformed(T, pair.estimate);
  return pairs;
}

}  // namespace rio::eval
