// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: range, direction and Doppler of a detection matched with a persistent landmark. Each
// detection is used once: it either initialises a landmark or measures one.
//
// e = R_BS^T (R_WB^T (l - p_WB) - p_BS), u = e/|e|, v_S the velocity of the radar in its axes
// (E1) range      h = |e|
// (E2) direction  h = t_az . u and t_el . u, t the unit tangents at the measured direction: the
//                 measured values are 0, the noise is that of each angle; the second plus the
//                 error common to all elevations
// (E3) Doppler    h = -u . v_S with the landmark's direction u, which is better known than the
//                 detection's; v_S is multiplied by 1 + scale error; (E7) of models/doppler.hpp
//                 for the v_S that the mounting turns; in the column of e by the mounting it is the
//                 predicted one, as in that of the landmark, with which it cancels
// Across the line of sight e is uncertain by decimetres, where |e| is curved. Its terms of second
// order, with M the covariance of the predicted direction, the error common to all elevations given
// [rad^2]:
// (E4) E|e| - |e^| = |e^|/2 tr M,   additional variance |e^|^2/2 tr M^2
// References: Michalczyk et al. 2023, eq. 13 (e); the paper uses the range alone. Bar-Shalom, Li,
// Kirubarajan 2001, sec. 10.3 (second-order EKF) (E4).
#pragma once

#include "rio/models/concept.hpp"
#include "rio/models/detection.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_birth.hpp"
#include "rio/state/blocks.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// Range and direction (E1) (E2).
struct LandmarkPointModel {
  static constexpr Model kModel = Model::kLandmarkPoint;
  static constexpr int kDim = 3;
  using Blocks = BlockList<BodyPose, Extrinsics, Landmark, ElevationError>;

  struct Measurement {
    double range = 0.0;                              ///< [m]
    double sigma_range = 0.0;                        ///< [m]
    Vector3d sigma_azimuth_S = Vector3d::UnitY();    ///< one-sigma change of the direction, not 0
    Vector3d sigma_elevation_S = Vector3d::UnitZ();  ///< same, perpendicular to it
  };

  static Measurement measurement(const Detection& d) {
    return {d.range, d.sigma_range, d.sigma_azimuth_S, d.sigma_elevation_S};
  }

  /// Second-order terms of the predicted range (E4).
  struct RangeCurvature {
    double mean;      ///< expected range minus range of the expected point [m]
    double variance;  ///< [m^2]
  };

  /// @param M covariance of the predicted direction along azimuth and elevation [rad^2]
  static RangeCurvature range_curvature(double range, const Eigen::Matrix2d& M) {
    return {0.5 * range * M.trace(), 0.5 * range * range * M.squaredNorm()};
  }

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const RigidPose& T_BS,
                const Vector3d& p_WL, double elevation_error, ResidualOf<kDim>& r,
                JacobianOf<kDim, Blocks::kDof>* J, JacobianOf<kDim, kDim>& R) const noexcept;
};
static_assert(MeasurementModel<LandmarkPointModel>);

/// Doppler (E3), a further row of the same measurement.
struct LandmarkDopplerModel {
  static constexpr Model kModel = Model::kLandmarkPoint;
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, BodyVelocity, GyroBias, Extrinsics, DopplerScale, Landmark>;

  struct Measurement {
    double range_rate = 0.0;             ///< [m/s]
    double sigma_doppler = 0.0;          ///< [m/s]
    Vector3d gyro_B = Vector3d::Zero();  ///< measured angular rate at the scan [rad/s]
    SteadyOffset steady{};               ///< (E7) of models/doppler.hpp
  };

  static Measurement measurement(const Detection& d, const Vector3d& gyro_B) {
    return {d.range_rate, d.sigma_doppler, gyro_B, {}};
  }

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                const Vector3d& gyro_bias, const RigidPose& T_BS, double scale_error,
                const Vector3d& p_WL, ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept;
};
static_assert(MeasurementModel<LandmarkDopplerModel>);

}  // namespace rio
