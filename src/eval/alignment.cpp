// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/alignment.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <stdexcept>

namespace rio::eval {

namespace {

/// Relative size below which a direction of C is rounding rather than motion.
constexpr double kDegenerate = 1e-12;

struct Moments {
  Vector3d truth_mean = Vector3d::Zero();
  Vector3d estimate_mean = Vector3d::Zero();
  Matrix3d correlation = Matrix3d::Zero();  ///< C of (E1)
};

Moments moments(const std::vector<PosePair>& pairs) {
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

Pose about_means(const Quaternion& rotation, const Moments& m) {
  return {rotation, m.truth_mean - rotation * m.estimate_mean};  // (E1)
}

}  // namespace

std::optional<AlignmentKind> alignment_kind(const std::string& name) {
  if (name == "none") return AlignmentKind::kNone;
  if (name == "origin") return AlignmentKind::kOrigin;
  if (name == "yaw") return AlignmentKind::kYaw;
  if (name == "se3") return AlignmentKind::kSe3;
  return std::nullopt;
}

Alignment align_origin(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {};
  const PosePair& first = pairs.front();
  if (!first.truth.q.coeffs().allFinite()) {
    throw std::runtime_error("the truth has no attitude: align by yaw or se3, not by origin");
  }
  const Quaternion rotation = (first.truth.q * first.estimate.q.conjugate()).normalized();
  return {{rotation, first.truth.p - rotation * first.estimate.p}, true};
}

Alignment align_yaw(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {{}, false};
  const Moments m = moments(pairs);
  const Matrix3d& C = m.correlation;
  const double sine = C(1, 0) - C(0, 1);
  const double cosine = C(0, 0) + C(1, 1);
  const bool unique = std::hypot(sine, cosine) > kDegenerate * C.norm();
  const double yaw = unique ? std::atan2(sine, cosine) : 0.0;  // (E2)
  return {about_means(quaternion_exp({0.0, 0.0, yaw}), m), unique};
}

Alignment align_se3(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {{}, false};
  const Moments m = moments(pairs);
  const Eigen::JacobiSVD<Matrix3d> svd(m.correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d& U = svd.matrixU();
  const Matrix3d& V = svd.matrixV();
  // without the sign the best orthogonal matrix may be a reflection
  const Vector3d signs(1.0, 1.0, U.determinant() * V.determinant() < 0.0 ? -1.0 : 1.0);
  const Matrix3d R = U * signs.asDiagonal() * V.transpose();  // (E3)
  const Vector3d& s = svd.singularValues();
  return {about_means(Quaternion(R).normalized(), m), s(1) > kDegenerate * s(0)};
}

Alignment find_alignment(const std::vector<PosePair>& pairs, AlignmentKind kind) {
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

std::vector<PosePair> transformed(const Pose& T, std::vector<PosePair> pairs) {
  for (PosePair& pair : pairs) pair.estimate = transformed(T, pair.estimate);
  return pairs;
}

}  // namespace rio::eval
