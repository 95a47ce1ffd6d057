// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/doppler.hpp"

namespace rio {

namespace {

/// (E2).
double variance_of(const DopplerModel::Measurement& z, const Vector3d& v_S) {
  return z.sigma_doppler * z.sigma_doppler + v_S.dot(z.direction_cov * v_S);
}

}  // namespace

DopplerModel::Measurement DopplerModel::measurement(const Detection& d, const Vector3d& gyro_B) {
  return {
      d.range_rate, d.sigma_doppler, d.direction_S, direction_covariance(d), gyro_B, 0.0, 1.0, {}};
}

DopplerModel::ExpectedDirection DopplerModel::expected_direction(const Measurement& z,
                                                                 const Vector3d& u_S,
                                                                 const Vector3d& v_S) noexcept {
  constexpr double kOutlier = 9.0;  // beyond three sigmas it is no direction error
  const Vector3d spread = z.direction_cov * v_S;
  const double r = z.range_rate + u_S.dot(v_S);
  const double R = variance_of(z, v_S);
  const double S = R + z.predicted_var;
  if (!(r * r < kOutlier * S)) return {u_S, z.direction_cov, R, 1.0};
  const Vector3d change = -spread * (r / S);
  return {u_S + change, z.direction_cov - spread * spread.transpose() / S, R,
          variance_of(z, v_S - u_S.dot(v_S) * change) / R};
}

bool DopplerModel::evaluate(const Measurement& z, const RigidPose& T_WB, const Vector3d& v_WB,
                            const Vector3d& gyro_bias, const RigidPose& T_BS, double scale_error,
                            ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                            JacobianOf<kDim, kDim>& R) const noexcept {
  const Vector3d w = z.gyro_B - gyro_bias;
  const Vector3d v_B = T_WB.R.transpose() * v_WB;
  const Vector3d radar_v_B = v_B + w.cross(T_BS.p);
  const Vector3d v_S = T_BS.R.transpose() * radar_v_B;
  const double scale = 1.0 + scale_error;
  const bool corrected = directions_ >= DopplerDirections::kCorrected;
  const double length = corrected ? 1.0 + 0.5 * z.direction_cov.trace() : 1.0;  // (E5)
  Vector3d u = length * z.direction_S;
  r[0] = z.range_rate + scale * u.dot(v_S);  // (E1)
  if (corrected) {
    const ExpectedDirection expected = expected_direction(z, u, scale * v_S);
    R(0, 0) = z.variance_factor * expected.variance;
    u = expected.u_S;  // (E3) (E4)
  } else {
    R(0, 0) = directions_ == DopplerDirections::kExact ? z.sigma_doppler * z.sigma_doppler
                                                       : variance_of(z, scale * v_S);
  }
  if (J == nullptr) return true;

  const Vector3d scaled_u = scale * u;
  const Vector3d a = T_BS.R * scaled_u;  // direction in body axes
  const Vector3d a_W = T_WB.R * a;
  J->block<1, 3>(0, Blocks::column<BodyPose>()) = v_B.cross(a).transpose();
  J->block<1, 3>(0, Blocks::column<BodyPose>() + 3).setZero();
  J->block<1, 3>(0, Blocks::column<BodyVelocity>()) = -a_W.transpose();
  J->block<1, 3>(0, Blocks::column<GyroBias>()) = T_BS.p.cross(a).transpose();
  const Vector3d steady_v_S = v_S + z.steady.velocity_S;  // (E7)
  const Vector3d steady_w = w + z.steady.rate_B;
  J->block<1, 3>(0, Blocks::column<Extrinsics>()) = steady_v_S.cross(scaled_u).transpose();
  J->block<1, 3>(0, Blocks::column<Extrinsics>() + 3) = steady_w.cross(a).transpose();
  (*J)(0, Blocks::column<DopplerScale>()) = -u.dot(steady_v_S);
  return true;
}

}  // namespace rio
