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

#include <algorithm>
#include <array>
#include <cmath>

#include "rio/types.hpp"

namespace rio {

/// [v]: skew(v) * w = v x w.
inline Matrix3d skew(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

namespace so3_detail {

inline constexpr std::array<double, 7> kFactorial = {1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0};

/// Terms of a series for x < 1 and for x < 0.01: the remainder is below double precision.
inline constexpr int kTerms = 10;
inline constexpr int kFewTerms = 5;
inline constexpr double kSmall = 0.01;

/// (-1)^k / (2k+m)! by m and k.
inline constexpr auto kCoefficients = [] {
  std::array<std::array<double, kTerms + 1>, 7> c{};
  for (int m = 0; m < 7; ++m) {
    double term = 1.0 / kFactorial[static_cast<std::size_t>(m)];
    for (int k = 0; k <= kTerms; ++k) {
      c[static_cast<std::size_t>(m)][static_cast<std::size_t>(k)] = term;
      term /= -(2.0 * (k + 1) + m) * (2.0 * (k + 1) + m - 1.0);
    }
  }
  return c;
}();

/// (E1) for m in 0..6.
inline double series(int m, double x) {
  const auto index = static_cast<std::size_t>(m);
  if (x < 1.0) {
    const auto& c = kCoefficients[index];
    double sum = 0.0;
    for (auto k = static_cast<std::size_t>(x < kSmall ? kFewTerms : kTerms); k-- > 0;) {
      sum = sum * x + c[k];
    }
    return sum;
  }
  const double t = std::sqrt(x);
  if (m == 0) return std::cos(t);
  if (m == 1) return std::sin(t) / t;
  return (1.0 / kFactorial[index - 2] - series(m - 2, x)) / x;
}

}  // namespace so3_detail

/// S_1 to S_6 at one x >= 0: all that (E2) and its derivatives need.
class GammaSeries {
 public:
  explicit GammaSeries(double x) {
    s_[6] = so3_detail::series(6, x);
    s_[5] = so3_detail::series(5, x);
    for (int m = 4; m > 0; --m) {  // downward recursion; for x >= 1 its differences cancel
      const auto i = static_cast<std::size_t>(m);
      s_[i] = x < 1.0 ? 1.0 / so3_detail::kFactorial[i] - x * s_[i + 2] : so3_detail::series(m, x);
    }
  }
  double operator[](int m) const { return s_[static_cast<std::size_t>(m)]; }
  /// dS_m/dx for m in 1..4.
  double derivative(int m) const { return 0.5 * (m * (*this)[m + 2] - (*this)[m + 1]); }

 private:
  std::array<double, 7> s_;
};

/// (E2) for m in 0..2; Gamma_0(phi) is the rotation matrix Exp(phi).
inline Matrix3d gamma(int m, const Vector3d& phi, double next, double after) {
  const Vector3d scaled = after * phi;
  // [phi]^2 = phi phi^T - |phi|^2 I
  const double diagonal =
      1.0 / so3_detail::kFactorial[static_cast<std::size_t>(m)] - scaled.dot(phi);
  Matrix3d out = skew(next * phi);
  out += scaled * phi.transpose();
  for (int i = 0; i < 3; ++i) out(i, i) += diagonal;
  return out;
}
/// @param S at |phi|^2
inline Matrix3d gamma(int m, const Vector3d& phi, const GammaSeries& S) {
  return gamma(m, phi, S[m + 1], S[m + 2]);
}
inline Matrix3d gamma(int m, const Vector3d& phi) {
  const double x = phi.squaredNorm();
  return gamma(m, phi, so3_detail::series(m + 1, x), so3_detail::series(m + 2, x));
}

/// d(Gamma_m(phi) a)/dphi, 3x3, for m in 0..2: product rule on (E2).
/// @param S at |phi|^2
inline Matrix3d d_gamma_a_d_phi(int m, const Vector3d& phi, const Vector3d& a,
                                const GammaSeries& S) {
  const Vector3d cross = phi.cross(a);
  // d([phi]^2 a)/dphi = phi a^T + (phi . a) I - 2 a phi^T
  const Vector3d twice = phi.cross(cross);
  Vector3d along = S.derivative(m + 1) * cross;
  along += S.derivative(m + 2) * twice;
  along -= S[m + 2] * a;
  along *= 2.0;
  const Vector3d scaled = S[m + 2] * a;
  const double diagonal = scaled.dot(phi);
  Matrix3d out = skew(-S[m + 1] * a);
  out += along * phi.transpose();
  out += phi * scaled.transpose();
  for (int i = 0; i < 3; ++i) out(i, i) += diagonal;
  return out;
}

/// Rotation of the rotation vector phi [rad].
inline Quaternion quaternion_exp(const Vector3d& phi) {
  const double quarter = 0.25 * phi.squaredNorm();  // (|phi|/2)^2
  const Vector3d xyz = 0.5 * so3_detail::series(1, quarter) * phi;
  return Quaternion(so3_detail::series(0, quarter), xyz.x(), xyz.y(), xyz.z()).normalized();
}

/// Rotation vector of q [rad], |result| <= pi.
inline Vector3d quaternion_log(const Quaternion& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Vector3d xyz = sign * q.vec();
  const double sine = xyz.norm();
  const double w = sign * q.w();
  // atan(s)/s = 1 - s^2/3 + ...: two terms are exact to 1e-16 below the bound
  if (sine < 1e-5) return 2.0 / w * (1.0 - sine * sine / (3.0 * w * w)) * xyz;
  return 2.0 * std::atan2(sine, w) / sine * xyz;
}

/// The smallest rotation that turns the direction of a into that of b, both non-zero. Opposite
/// directions: half a turn about an axis perpendicular to a.
inline Quaternion rotation_between(const Vector3d& a, const Vector3d& b) {
  constexpr double kOpposite = 1e-12;
  const Vector3d from = a.normalized();
  const Vector3d sum = from + b.normalized();
  if (sum.norm() < kOpposite) {
    const Vector3d axis = from.unitOrthogonal();
    return Quaternion(0.0, axis.x(), axis.y(), axis.z());
  }
  const Vector3d middle = sum.normalized();  // half the rotation
  const Vector3d xyz = from.cross(middle);
  return Quaternion(from.dot(middle), xyz.x(), xyz.y(), xyz.z()).normalized();
}

/// Variances of an attitude error: about the vertical, and of roll and pitch together [rad^2].
struct AttitudeVariance {
  double heading = 0.0;
  double tilt = 0.0;
};
/// @param P covariance of the error of q_WB, body axes; rounding may have left it indefinite
inline AttitudeVariance attitude_variance(const Quaternion& q_WB, const Matrix3d& P) {
  const Vector3d up_B = q_WB.conjugate() * Vector3d::UnitZ();
  const double heading = up_B.dot(P * up_B);
  return {std::max(0.0, heading), std::max(0.0, P.trace() - heading)};
}

}  // namespace rio
