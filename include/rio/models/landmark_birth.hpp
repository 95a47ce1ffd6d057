// SPDX-License-Identifier: BSD-3-Clause
// Stage 6: landmark augmentation by the inverse observation model, and the position of a landmark
// in radar axes. Neither is a measurement; both have the form of a model, so that their Jacobians
// are mapped to the error state in the same way.
//
// (E1) l = R_WB (R_BS m + p_BS) + p_WB                      Michalczyk et al. 2023, eq. 12
// (E2) l = l(x^) + H_x dx + n,  cov(n) = H_m Sigma_m H_m^T    ibid., eq. 10-11, Sigma_m polar
// (E3) e = R_BS^T (R_WB^T (l - p_WB) - p_BS)                ibid., eq. 13
// m of (E1) is the measured point less the error d common to all elevations, m_z - d |m_z| t_el
// with t_el the unit tangent of elevation.
#pragma once

#include "rio/models/concept.hpp"
#include "rio/models/detection.hpp"
#include "rio/state/blocks.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// A new landmark at the position of a detection (E1), with H_x and the noise of (E2).
struct LandmarkBirth {
  using Blocks = BlockList<BodyPose, Extrinsics, ElevationError>;

  Vector3d p_WL;                    ///< [m]
  JacobianOf<3, Blocks::kDof> d_l;  ///< H_x
  Matrix3d noise;                   ///< cov(n) [m^2]

  LandmarkBirth(const RigidPose& T_WB, const RigidPose& T_BS, double elevation_error,
                const Detection& d);
};

/// A landmark in radar axes (E3) with its derivatives.
struct ObservedPoint {
  using Blocks = BlockList<BodyPose, Extrinsics, Landmark>;

  Vector3d e_S;                     ///< [m]
  JacobianOf<3, Blocks::kDof> d_e;  ///< in the errors of the blocks

  ObservedPoint(const RigidPose& T_WB, const RigidPose& T_BS, const Vector3d& p_WL);
};

}  // namespace rio
