// SPDX-License-Identifier: BSD-3-Clause
// Rotations: skew matrix, Exp, Log, and the integrals of Exp that strapdown integration needs.
//
// (E1) S_m(x) = sum_k (-x)^k / (2k+m)!, x = |phi|^2: S_0 = cos t, S_1 = sin t / t, ...
//      S_m = 1/m! - x S_{m+2},  dS_m/dx = (m S_{m+2} - S_{m+1}) / 2
// (E2) Gamma_m(phi) = sum_k [phi]^k / (k+m)! = I/m! + S_{m+1} [phi] + S_{m+2} [phi]^2
//      Gamma_0 = Exp, Gamma_1 = left Jacobian, Gamma_2 = the double integral's kernel.
// Reference: Bloesch et al., 2012 (Gamma_m); Solà et al., 2018, eq. 143-147 (Jacobians of SO(3)).
// Valid for every phi; the series is used for |phi| < 1 rad, the recursion beyond.
#pragma once

#include <array>

#include "rio/export.hpp"
#include "rio/types.hpp"

namespace rio {

/// [v]: skew(v) * w = v x w.
inline Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m(0, 0) = m(1, 1) = m(2, 2) = 0.0;
  m(2, 1) = v.x();
  m(1, 2) = -v.x();
  m(0, 2) = v.y();
  m(2, 0) = -v.y();
  m(1, 0) = v.z();
  m(0, 1) = -v.z();
  return m;
}

/// S_1 to S_6 at one x >= 0: all that (E2) and its derivatives need.
class GammaSeries {
 public:
  RIO_API explicit GammaSeries(double x);
  double operator[](int m) const { return s_[static_cast<std::size_t>(m)]; }
  /// dS_m/dx for m in 1..4.
  double derivative(int m) const { return 0.5 * (m * (*this)[m + 2] - (*this)[m + 1]); }
  /// (E1) for m in 0..6 alone.
  RIO_API static double term(int m, double x);

 private:
  std::array<double, 7> s_;
};

/// (E2) for m in 0..2; Gamma_0(phi) is the rotation matrix Exp(phi).
RIO_API Matrix3d gamma(int m, const Vector3d& phi);
/// @param S at |phi|^2
RIO_API Matrix3d gamma(int m, const Vector3d& phi, const GammaSeries& S);

/// d(Gamma_m(phi) a)/dphi, 3x3, for m in 0..2: product rule on (E2).
/// @param S at |phi|^2
RIO_API Matrix3d d_gamma_a_d_phi(int m, const Vector3d& phi, const Vector3d& a,
                                 const GammaSeries& S);

/// Rotation of the rotation vector phi [rad].
RIO_API Quaternion quaternion_exp(const Vector3d& phi);

/// Rotation vector of q [rad], |result| <= pi.
RIO_API Vector3d quaternion_log(const Quaternion& q);

/// The smallest rotation that turns the direction of a into that of b, both non-zero. Opposite
/// directions: half a turn about an axis perpendicular to a.
RIO_API Quaternion rotation_between(const Vector3d& a, const Vector3d& b);

/// The 24 rotations that map axes to axes.
std::array<Matrix3d, 24> right_angles();

/// Variances of an attitude error: about the vertical, and of roll and pitch together [rad^2].
struct AttitudeVariance {
  double heading = 0.0;
  double tilt = 0.0;
};
/// @param P covariance of the error of q_WB, body axes; rounding may have left it indefinite
RIO_API AttitudeVariance attitude_variance(const Quaternion& q_WB, const Matrix3d& P);

}  // namespace rio
