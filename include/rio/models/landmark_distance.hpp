// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: distance to a persistent landmark.
//
// e = R_BS^T (R_WB^T (l - p_WB) - p_BS),  u = e/|e|,  a = R_BS u
// (E1) h = |e|                                       Michalczyk et al. 2023, eq. 13-14
#pragma once

#include "rio/models/concept.hpp"
#include "rio/models/detection.hpp"
#include "rio/state/blocks.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

class LandmarkDistanceModel {
 public:
  static constexpr Model kModel = Model::kLandmarkDistance;
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, Extrinsics, Landmark>;

  struct Measurement {
    double range = 0.0;  ///< [m]
  };

  /// @param sigma_distance constant sigma of the measured range [m]
  explicit LandmarkDistanceModel(double sigma_distance) : sigma_distance_(sigma_distance) {}

  static Measurement measurement(const Detection& d) { return {d.range}; }

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const RigidPose& T_BS,
                const Vector3d& p_WL, ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept;

 private:
  double sigma_distance_;
};

static_assert(MeasurementModel<LandmarkDistanceModel>);

}  // namespace rio
