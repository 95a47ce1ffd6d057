// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: Doppler of a static point: the radar's velocity seen along the direction to the point.
//
// w = gyro - b_g,  v_S = R_BS^T (R_WB^T v_WB + w x p_BS)
// (E1) h = -u^T v_S                             positive = receding
//      v_S is multiplied by 1 + scale error
// (E2) R = sigma_D^2 + v_S^T Sigma_u v_S        the direction is noisy too
// (E3) u^ = u - Sigma_u v_S r / (R + P_h)       expected true direction given the innovation r
// (E4) J uses u^
// (E5) u in (E1) is multiplied by 1 + tr Sigma_u / 2: E u = (1 - tr Sigma_u / 2) u_true
// (E6) R at u^: (E2) with v_S - (u^T v_S) (u^ - u) in the place of v_S
// (E5) and (E6), of second order in the direction's error, come with (E3).
// (E7) J in mounting and scale error is that at the steady motion
//      (propagate/steady_motion.hpp): at v_S + dv and w + dw
// The noise n of the gyro sample enters all Dopplers of a scan together, as -n takes the place of
// the error of b_g: so its coefficients are those of the gyro bias.
// The ratio of the two R of (E6) is computed by the caller from the prediction and stays constant,
// so that the cost of the window has a gradient. Derivation: data/theory.md, 5.
// Reference: Michalczyk et al. 2024, eq. 4; (E2) Xu et al., eq. 10-12, plus the Doppler's own
// noise; (E5) Lerro, Bar-Shalom 1993 (debiased conversion).
#pragma once

#include "rio/models/concept.hpp"
#include "rio/models/detection.hpp"
#include "rio/state/blocks.hpp"

namespace rio {

/// dv and dw of (E7); zero for the exact Jacobian.
struct SteadyOffset {
  Vector3d velocity_S = Vector3d::Zero();  ///< of the radar, in its axes [m/s]
  Vector3d rate_B = Vector3d::Zero();      ///< of the body [rad/s]
};

class DopplerModel {
 public:
  static constexpr Model kModel = Model::kDoppler;
  static constexpr int kDim = 1;
  using Blocks = BlockList<BodyPose, BodyVelocity, GyroBias, Extrinsics, DopplerScale>;

  struct Measurement {
    double range_rate = 0.0;                    ///< [m/s]
    double sigma_doppler = 0.0;                 ///< [m/s]
    Vector3d direction_S = Vector3d::UnitX();   ///< measured u
    Matrix3d direction_cov = Matrix3d::Zero();  ///< Sigma_u
    Vector3d gyro_B = Vector3d::Zero();         ///< measured angular rate at the scan [rad/s]
    double predicted_var = 0.0;    ///< P_h: variance of h due to the state's error [m^2/s^2]
    double variance_factor = 1.0;  ///< (E6): multiplies R
    SteadyOffset steady{};         ///< (E7)
  };

  /// (E3) (E6): mean and covariance of the true direction given the innovation r.
  struct ExpectedDirection {
    Vector3d u_S = Vector3d::Zero();
    Matrix3d covariance = Matrix3d::Zero();
    double variance = 0.0;         ///< R (E2)
    double variance_factor = 1.0;  ///< (E6)
  };
  /// Beyond three sigmas of r, u_S is returned unchanged: that is no direction error.
  /// @param v_S times 1 + scale error
  static ExpectedDirection expected_direction(const Measurement& z, const Vector3d& u_S,
                                              const Vector3d& v_S) noexcept;

  /// @param directions kExact: R = sigma_D^2; from kNoisy on (E2); from kCorrected on (E3) to
  /// (E5), before that u itself in the Jacobian. The caller sets the factor of (E6)
  explicit DopplerModel(DopplerDirections directions) : directions_(directions) {}

  static Measurement measurement(const Detection& d, const Vector3d& gyro_B);

  bool evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                const Vector3d& gyro_bias, const RigidPose& T_BS, double scale_error,
                ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                JacobianOf<kDim, kDim>& R) const noexcept;

 private:
  DopplerDirections directions_;
};

static_assert(MeasurementModel<DopplerModel>);

}  // namespace rio
