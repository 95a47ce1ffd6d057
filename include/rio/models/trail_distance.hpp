// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: current distance to a point detected in a past scan, by the current pose and the clone.
//
// q = R_BS m + p_BS (past detection m in body axes at its scan),  W = R_c q + p_c (clone c),
// e = R_BS^T (R_WB^T (W - p_WB) - p_BS),  u = e/|e|,  a = R_BS u
// (E1) h = |e|
// (E2) R = sigma_d^2, the rows of a trail independent
// Reference: Michalczyk et al. 2023, eq. 8-9.
#pragma once

#include "rio/models/concept.hpp"
#include "rio/models/detection.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

class TrailDistanceModel {
 public:
  static constexpr Model kModel = Model::kTrailDistance;
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, ClonePose, Extrinsics>;

  struct Measurement {
    double range = 0.0;                  ///< current [m]
    Vector3d past_S = Vector3d::Zero();  ///< past detection, radar axes at its scan [m]
  };

  /// @param sigma_distance constant sigma [m]
  explicit TrailDistanceModel(double sigma_distance) : sigma_distance_(sigma_distance) {}

  static Measurement measurement(const Detection& now, const Detection& past) {
    return {now.range, past.point_S};
  }

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const RigidPose& clone_T_WB,
                const RigidPose& T_BS, ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept;

 private:
  double sigma_distance_;
};

static_assert(MeasurementModel<TrailDistanceModel>);

}  // namespace rio
