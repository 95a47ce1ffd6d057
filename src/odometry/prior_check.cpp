// SPDX-License-Identifier: BSD-3-Clause
#include "prior_check.hpp"

#include <limits>

#include "rio/core/small_cholesky.hpp"
#include "rio/propagate/strapdown.hpp"

namespace rio {

bool is_finite(const NavState& s) {
  return s.q_WB.coeffs().allFinite() && s.p_WB.allFinite() && s.v_WB.allFinite() &&
         s.gyro_bias.allFinite() && s.accel_bias.allFinite();
}

bool is_plausible(const NavState& s, const BodyCovariance& P) {
  constexpr double kFarthest = 1e7;  // [m]
  constexpr double kMost = 1e4;      // [m/s, rad/s, m/s^2]
  constexpr double kSigma = 1e6;     // of anything
  const auto largest = [](const auto& values) { return values.cwiseAbs().maxCoeff(); };
  return largest(s.p_WB) <= kFarthest && largest(s.v_WB) <= kMost &&
         largest(s.gyro_bias) <= kMost && largest(s.accel_bias) <= kMost &&
         largest(P) <= kSigma * kSigma;
}

bool is_near_unit(const Quaternion& q) {
  if (!(q.coeffs().cwiseAbs().maxCoeff() < 2.0)) return false;  // its square could overflow
  const double norm = q.norm();
  return norm > 0.5 && norm < 2.0;
}

bool is_covariance(const BodyCovariance& P) {
  if (!(P.diagonal().minCoeff() >= 0.0)) return false;
  const Eigen::Matrix<double, body::kSize, 1> sigmas = P.diagonal().cwiseSqrt();
  const Matrix15d most = sigmas * sigmas.transpose();
  if (!(P.cwiseAbs().array() <= (1.0 + 1e-9) * most.array()).all()) return false;
  // C: correlations; the row of a zero variance is zero
  const double least = std::numeric_limits<double>::min();
  const Eigen::Matrix<double, body::kSize, 1> scale =
      P.diagonal().cwiseMax(least).cwiseSqrt().cwiseInverse();
  Matrix15d C = scale.asDiagonal() * P * scale.asDiagonal();
  if (!((C - C.transpose()).cwiseAbs().maxCoeff() <= 1e-9)) return false;
  C.diagonal().array() += 1e-9;  // positive definite if no eigenvalue of C is below -1e-9
  return SmallCholesky<body::kSize>(C).positive();
}

void add_unknown_pause(const ImuOptions& imu, double speed, BodyCovariance& P) {
  constexpr double kPause = 0.3;  // a driver that restarts [s]
  const auto add = [&P](int block, double sigma) {
    P.diagonal().segment<3>(block).array() += sigma * sigma;
  };
  add(body::kAttitude, imu.gap_rate_sigma * kPause);
  add(body::kPosition, speed * kPause);
  add(body::kVelocity, imu.gap_accel_sigma * kPause);
}

}  // namespace rio
