// SPDX-License-Identifier: BSD-3-Clause
// The vocabulary of the state: the blocks a measurement model may touch, with the value each holds,
// its degrees of freedom and its retraction.
//
// Every rotation error is local (right): R = R^ Exp(dphi); everything else is additive.
#pragma once

#include <tuple>
#include <type_traits>

#include "rio/core/so3.hpp"  // a model that includes its blocks has the rotations, too
#include "rio/types.hpp"

namespace rio {

/// A pose ready for arithmetic: x_A = R x_B + p.
struct RigidPose {
  Matrix3d R = Matrix3d::Identity();
  Vector3d p = Vector3d::Zero();

  RigidPose() = default;
  RigidPose(const Matrix3d& rotation, const Vector3d& translation) : R(rotation), p(translation) {}
  explicit RigidPose(const Pose& pose) : R(pose.rotation.toRotationMatrix()), p(pose.translation) {}
};

/// Blocks of pose type: error [dphi, dp].
struct PoseBlock {
  using Value = RigidPose;
  static constexpr int kDof = 6;
  static Value retract(const Value& x, const Eigen::Matrix<double, kDof, 1>& error) {
    return {x.R * gamma(0, error.head<3>()), x.p + error.tail<3>()};
  }
};
/// Blocks of vector type.
template <int kSize>
struct VectorBlock {
  using Value = Eigen::Matrix<double, kSize, 1>;
  static constexpr int kDof = kSize;
  static Value retract(const Value& x, const Value& error) { return x + error; }
};

/// Blocks of one number.
struct ScalarBlock {
  using Value = double;
  static constexpr int kDof = 1;
  static Value retract(Value x, const Eigen::Matrix<double, kDof, 1>& error) {
    return x + error[0];
  }
};

struct BodyPose : PoseBlock {};           ///< T_WB at the scan: columns kAttitude, kPosition
struct BodyVelocity : VectorBlock<3> {};  ///< v_WB [m/s]
struct GyroBias : VectorBlock<3> {};      ///< [rad/s]
struct ClonePose : PoseBlock {};          ///< T_WB at a past scan
struct Extrinsics : PoseBlock {};         ///< T_BS
struct Landmark : VectorBlock<3> {};      ///< p_WL [m]
/// Relative error of the range rates left after the detections were corrected by its estimate.
struct DopplerScale : ScalarBlock {};
/// Error common to the elevations of a radar's landmarks, measured minus true [rad]. It is
/// considered, not estimated (StateEstimate::consider).
struct ElevationError : ScalarBlock {};

/// Base of a state that an extension adds: additive, a random walk; at the start zero, or the value
/// given to AuxiliaryStates::declare_at. The derived block declares, as static constexpr members,
///   const char* kName   unique among the auxiliary states of an estimator
///   double kSigma       prior, per element [its unit]
///   double kWalk        density of its random walk, per element [its unit / sqrt(s)]
/// and takes part in the estimation once Options::auxiliary.declare<Block>() was called. A kind of
/// which there are several, like anchors, declares kIndexed = true: a measurement says which one.
struct AuxiliaryBlockBase {
  static constexpr bool kIndexed = false;
};
template <int kSize>
struct AuxiliaryBlock : VectorBlock<kSize>, AuxiliaryBlockBase {};

/// The blocks of one model, in the column order of its Jacobian.
template <class... B>
struct BlockList {
  using Values = std::tuple<typename B::Value...>;
  static constexpr int kDof = (B::kDof + ...);

  template <class X>
  static constexpr bool has() {
    return (std::is_same_v<X, B> || ...);
  }
  /// First Jacobian column of block X.
  template <class X>
  static constexpr int column() {
    int offset = 0;
    bool found = false;
    ((found = found || std::is_same_v<X, B>, offset += found ? 0 : B::kDof), ...);
    return offset;
  }
};

}  // namespace rio
