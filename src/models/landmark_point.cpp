// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/landmark_point.hpp"

namespace rio {

LandmarkPointModel::RangeCurvature LandmarkPointModel::range_curvature(double range,
                                                                       const Eigen::Matrix2d& M) {
  return {0.5 * range * M.trace(), 0.5 * range * range * M.squaredNorm()};
}

bool LandmarkPointModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                  const RigidPose& T_BS, const Vector3d& p_WL, ResidualOf<kDim>& r,
                                  JacobianOf<kDim, Blocks::kDof>* J,
                                  JacobianOf<kDim, kDim>& R) const noexcept {
  const ObservedPoint point(T_WB, T_BS, p_WL);
  const double h = point.e_S.norm();
  if (!(h > kMinRange)) return false;
  const Vector3d u = point.e_S / h;
  const double sigma_az = z.sigma_azimuth_S.norm();
  const double sigma_el = z.sigma_elevation_S.norm();
  const Vector3d t_az = z.sigma_azimuth_S / sigma_az;
  const Vector3d t_el = z.sigma_elevation_S / sigma_el;
  r << z.range - h, -t_az.dot(u), -t_el.dot(u);  // (E1) (E2)
  R.setZero();
  R.diagonal() << z.sigma_range * z.sigma_range, sigma_az * sigma_az, sigma_el * sigma_el;
  if (J == nullptr) return true;

  Matrix3d D;  // derivative of (range, direction) by e
  D.row(0) = u.transpose();
  D.row(1) = (t_az - t_az.dot(u) * u).transpose() / h;
  D.row(2) = (t_el - t_el.dot(u) * u).transpose() / h;
  *J = D * point.d_e;
  return true;
}

bool LandmarkDopplerModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                    const Vector3d& v_WB, const Vector3d& gyro_bias,
                                    const RigidPose& T_BS, double scale_error, const Vector3d& p_WL,
                                    ResidualOf<kDim>& r, JacobianOf<kDim, Blocks::kDof>* J,
                                    JacobianOf<kDim, kDim>& R) const noexcept {
  const ObservedPoint point(T_WB, T_BS, p_WL);
  const double h = point.e_S.norm();
  if (!(h > kMinRange)) return false;
  const Vector3d u = point.e_S / h;
  const Vector3d w = z.gyro_B - gyro_bias;
  const Vector3d v_B = T_WB.R.transpose() * v_WB;
  const Vector3d radar_v_B = v_B + w.cross(T_BS.p);
  const Vector3d v_S = T_BS.R.transpose() * radar_v_B;
  const double scale = 1.0 + scale_error;
  r[0] = z.range_rate + scale * u.dot(v_S);  // (E3)
  R(0, 0) = z.sigma_doppler * z.sigma_doppler;
  if (J == nullptr) return true;

  const Vector3d scaled_u = scale * u;
  const Vector3d a = T_BS.R * scaled_u;
  const Vector3d a_W = T_WB.R * a;
  const Eigen::RowVector3d d_h_d_e = (u.dot(v_S) * scaled_u - scale * v_S).transpose() / h;
  using Point = ObservedPoint::Blocks;
  const Eigen::Matrix<double, 1, Point::kDof> d_h = d_h_d_e * point.d_e;
  J->block<1, 6>(0, Blocks::column<BodyPose>()) = d_h.segment<6>(Point::column<BodyPose>());
  J->block<1, 3>(0, Blocks::column<BodyPose>()) += v_B.cross(a).transpose();
  J->block<1, 3>(0, Blocks::column<BodyVelocity>()) = -a_W.transpose();
  J->block<1, 3>(0, Blocks::column<GyroBias>()) = T_BS.p.cross(a).transpose();
  J->block<1, 6>(0, Blocks::column<Extrinsics>()) = d_h.segment<6>(Point::column<Extrinsics>());
  const Vector3d steady_v_S = v_S + z.steady.velocity_S;
  const Vector3d steady_w = w + z.steady.rate_B;
  J->block<1, 3>(0, Blocks::column<Extrinsics>()) += steady_v_S.cross(scaled_u).transpose();
  J->block<1, 3>(0, Blocks::column<Extrinsics>() + 3) += steady_w.cross(a).transpose();
  (*J)(0, Blocks::column<DopplerScale>()) = -u.dot(steady_v_S);
  J->block<1, 3>(0, Blocks::column<Landmark>()) = d_h.segment<3>(Point::column<Landmark>());
  return true;
}

}  // namespace rio
