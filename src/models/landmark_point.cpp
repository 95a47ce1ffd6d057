// SPDX-License-Identifier: BSD-3-Clause
#include "rio/models/landmark_point.hpp"

namespace rio {

bool LandmarkPointModel::evaluate(const Measurement& z, const RigidPose& T_WB,
                                  const RigidPose& T_BS, const Vector3d& p_WL,
                                  double elevation_error, ResidualOf<kDim>& r,
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
  r << z.range - h, -t_az.dot(u), -t_el.dot(u) - elevation_error;  // (E1) (E2)
  R.setZero();
  R.diagonal() << z.sigma_range * z.sigma_range, sigma_az * sigma_az, sigma_el * sigma_el;
  if (J == nullptr) return true;

  Matrix3d D;  // derivative of (range, direction) by e
  D.row(0) = u.transpose();
  D.row(1) = (t_az - t_az.dot(u) * u).transpose() / h;
  D.row(2) = (t_el - t_el.dot(u) * u).transpose() / h;
  J->leftCols<ObservedPoint::Blocks::kDof>() = D * point.d_e;
  J->col(Blocks::column<ElevationError>()) = Vector3d::UnitZ();
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
  DopplerModel::Measurement along;  // of a point in the direction u
  along.range_rate = z.range_rate;
  along.sigma_doppler = z.sigma_doppler;
  along.direction_S = u;
  along.gyro_B = z.gyro_B;
  along.steady = z.steady;
  JacobianOf<kDim, DopplerModel::Blocks::kDof> d;
  DopplerModel(DopplerDirections::kExact)  // (E3)
      .evaluate(along, T_WB, v_WB, gyro_bias, T_BS, scale_error, r, J != nullptr ? &d : nullptr, R);
  if (J == nullptr) return true;

  const double scale = 1.0 + scale_error;
  const Vector3d scaled_u = scale * u;
  const Vector3d v_S = radar_velocity(T_WB, v_WB, z.gyro_B - gyro_bias, T_BS);
  const Eigen::RowVector3d d_h_d_e = (u.dot(v_S) * scaled_u - scale * v_S).transpose() / h;
  using Point = ObservedPoint::Blocks;
  const Eigen::Matrix<double, 1, Point::kDof> by_point = d_h_d_e * point.d_e;
  J->head<DopplerModel::Blocks::kDof>() = d;
  J->segment<6>(Blocks::column<BodyPose>()) += by_point.segment<6>(Point::column<BodyPose>());
  J->segment<6>(Blocks::column<Extrinsics>()) += by_point.segment<6>(Point::column<Extrinsics>());
  J->segment<3>(Blocks::column<Landmark>()) = by_point.segment<3>(Point::column<Landmark>());
  return true;
}

}  // namespace rio
