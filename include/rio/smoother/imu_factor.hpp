// SPDX-License-Identifier: BSD-3-Clause
// The preintegrated IMU factor between two neighbouring states of the sliding window.
//
// With dR, dv, dp the increments of preintegration.hpp corrected to the biases of state i by (E3)
// there, T their duration and u_v = R_i^T (v_j - v_i - g T),
// u_p = R_i^T (p_j - p_i - v_i T - g T^2 / 2):
// (E1) r_phi = Log(dR^T R_i^T R_j),  r_p = u_p - dp,  r_v = u_v - dv,
//      r_bg = bg_j - bg_i,  r_ba = ba_j - ba_i
// (E2) dr_phi/dphi_j = Jr^-1,  dr_phi/dphi_i = -Jr^-1 R_j^T R_i,
//      dr_phi/dbg_i = -Jr^-1 Exp(r_phi)^T Jr(c) A_phi,g,  Jr = Jr(r_phi),  c = A_phi,g dbg
// (E3) dr_p/dphi_i = [u_p],  dr_v/dphi_i = [u_v]; the rest of r_p, r_v is linear
// (E4) whitened: L^-1 r and L^-1 J with S = L L^T
// r is x_j minus its prediction from x_i: zero at the prediction, and of covariance S at the truth.
// J = dr/dx is the derivative of the RESIDUAL, so that r(x + dx) = r + J dx and the step solves
// J^T J dx = -J^T r. (The measurement models write r = z - h and J = dh/dx = -dr/dx instead.)
// Reference: Forster et al., 2017, eq. 45 and appendix C.
#pragma once

#include "rio/core/small_cholesky.hpp"
#include "rio/core/so3.hpp"
#include "rio/smoother/preintegration.hpp"
#include "rio/types.hpp"

namespace rio {

/// Residual and Jacobian between state i (columns 0..14) and state j (columns 15..29). Fixed size,
/// no allocation.
class ImuFactor {
 public:
  using Residual = Eigen::Matrix<double, body::kSize, 1>;
  using Jacobian = Eigen::Matrix<double, body::kSize, 2 * body::kSize>;

  /// Not valid().
  ImuFactor() = default;
  /// Copies the preintegration; gravity along -z of W [m/s^2].
  ImuFactor(const Preintegration& imu, double gravity);

  /// False if there was no step or not all of them were finite: then evaluate() must not be called.
  bool valid() const { return valid_; }
  void invalidate() { valid_ = false; }
  const Preintegration& imu() const { return imu_; }

  /// (E4): unit covariance. J may be null.
  void evaluate(const NavState& xi, const NavState& xj, Residual* r, Jacobian* J) const;

  /// (E1) to (E3): [rad, m, m/s, rad/s, m/s^2], covariance imu().covariance(). J may be null.
  void evaluate_unwhitened(const NavState& xi, const NavState& xj, Residual* r, Jacobian* J) const;

 private:
  Preintegration imu_;
  Vector3d gravity_W_ = Vector3d::Zero();
  SmallCholesky<body::kSize> root_{Matrix15d::Zero()};  ///< L of (E4)
  bool valid_ = false;
};

}  // namespace rio
