// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/ego_velocity_measurement.hpp"

#include <algorithm>

#include "rio/core/small_cholesky.hpp"
#include "rio/models/aids.hpp"

namespace rio {

std::optional<Matrix3d> residual_covariance(const DetectionList& scan, const EgoVelocity& set) {
  if (!set.valid || !set.covariance || set.inliers <= 3) return std::nullopt;
  Matrix3d A = Matrix3d::Zero();
  double residuals = 0.0;
  double noise = 0.0;
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    if (!set.inlier[i]) continue;
    const Detection& d = scan.items[i];
    const double e = set.range_rate[i] + d.direction_S.dot(set.v_S);
    A += d.direction_S * d.direction_S.transpose();
    residuals += e * e;
    noise += d.sigma_doppler * d.sigma_doppler;
  }
  const SmallCholesky<3> root(A);
  if (!root.positive()) return std::nullopt;
  const double variance = std::max(residuals / (set.inliers - 3), noise / set.inliers);  // (E1)
  return Matrix3d(variance * root.inverse());
}

std::optional<AidingMeasurement> ego_velocity_measurement(const DetectionList& scan,
                                                          const EgoVelocity& set,
                                                          const Estimate& x) {
  const std::optional<Matrix3d> covariance_S = residual_covariance(scan, set);
  if (!covariance_S) return std::nullopt;
  const RigidPose T_BS(x.T_BS);
  const Matrix3d lever = skew(T_BS.p);
  BodyVelocityModel::Measurement z;
  z.v_B = T_BS.R * set.v_S;
  z.covariance_B =
      T_BS.R * *covariance_S * T_BS.R.transpose() + x.gyro_variance * lever * lever.transpose();
  z.lever_B = T_BS.p;
  z.gyro_B = x.gyro_B;
  return AidingMeasurement(x.nav.time, BodyVelocityModel{}, z);
}

}  // namespace rio
