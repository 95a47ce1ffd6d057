// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: the position of a detection compared with that of its landmark, in radar axes.
//
// e = R_BS^T (R_WB^T (l - p_WB) - p_BS)
// (E1) h = e, z = m, the detection in radar axes
// (E2) R = Sigma_m, the polar noise of the detection
// Reference: Xu et al., eq. 15-18, who write it in world axes: a rotation of (E1) and (E2), which
// leaves the weighted norm unchanged.
#pragma once

#include "rio/models/concept.hpp"
#include "rio/models/detection.hpp"
#include "rio/models/landmark_birth.hpp"
#include "rio/state/blocks.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

struct LandmarkPositionModel {
  static constexpr Model kModel = Model::kLandmarkPosition;
  static constexpr int kDim = 3;
  using Blocks = ObservedPoint::Blocks;

  struct Measurement {
    Vector3d point_S = Vector3d::UnitX();        ///< [m]
    Matrix3d covariance = Matrix3d::Identity();  ///< Sigma_m, not singular [m^2]
  };

  static Measurement measurement(const Detection& d) { return {d.point_S, point_covariance(d)}; }

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const RigidPose& T_BS,
                const Vector3d& p_WL, ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept;
};

static_assert(MeasurementModel<LandmarkPositionModel>);

}  // namespace rio
