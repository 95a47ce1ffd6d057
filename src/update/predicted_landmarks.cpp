// SPDX-License-Identifier: BSD-3-Clause
// For the matching: the covariance of every landmark relative to the radar.
#include "rio/core/so3.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

namespace {

/// How a point moves with its elevation [m/rad].
Vector3d raised_point(const Vector3d& point_S) {
  const double level = point_S.head<2>().norm();
  if (!(level > 0.0)) return Vector3d::Zero();
  const double climb = point_S.z() / level;
  return {-climb * point_S.x(), -climb * point_S.y(), level};
}

}  // namespace

void StateEstimate::predict_landmarks() {
  constexpr int kShared = 13;  // columns shared by all landmarks: pose, extrinsics, time offset
  const LinearizationPoint x(estimate_);
  const auto P = covariance_.matrix();
  struct Part {
    int column, at, size;
  };
  StaticVector<Part, 3> parts;
  (void)parts.push_back({body::kAttitude, 0, 6});
  if (layout_.has_extrinsics()) (void)parts.push_back({layout_.extrinsics(), 6, 6});
  if (layout_.has_time_offset()) (void)parts.push_back({layout_.time_offset(), 12, 1});
  Eigen::Matrix<double, kShared, kShared> shared = Eigen::Matrix<double, kShared, kShared>::Zero();
  for (const Part& row : parts) {
    for (const Part& column : parts) {
      shared.block(row.at, column.at, row.size, column.size) =
          P.block(row.column, column.column, row.size, column.size);
    }
  }
  // the point in radar axes e has the derivative [e] turn + shift by them, and R_SW by its landmark
  using Shared = Eigen::Matrix<double, 3, kShared>;
  const Matrix3d R_SB = x.T_BS.R.transpose();
  const Matrix3d R_SW = R_SB * x.T_WB.R.transpose();
  const Vector3d p_WS = x.T_WB.p + x.T_WB.R * x.T_BS.p;
  Shared turn = Shared::Zero();
  turn.leftCols<3>() = R_SB;
  turn.middleCols<3>(6).setIdentity();
  turn.rightCols<1>() = -R_SB * x.pose_rate.head<3>();
  Shared shift = Shared::Zero();
  shift.leftCols<6>() << R_SB * skew(x.T_BS.p), -R_SW;
  shift.middleCols<3>(9) = -R_SB;
  shift.rightCols<1>() = -shift.leftCols<6>() * x.pose_rate;
  const Shared turn_P = turn.lazyProduct(shared);
  const Matrix3d turned = turn_P.lazyProduct(turn.transpose());
  const Matrix3d both = turn_P.lazyProduct(shift.transpose());
  const Matrix3d shifted = Shared(shift.lazyProduct(shared)).lazyProduct(shift.transpose());
  // the error that all elevations share raises the measured point by it
  const int error = layout_.has_elevation_error() ? layout_.elevation_error() : -1;
  Eigen::Matrix<double, kShared, 1> by_error = Eigen::Matrix<double, kShared, 1>::Zero();
  for (const Part& row : parts) {
    if (error >= 0) by_error.segment(row.at, row.size) = P.block(row.column, error, row.size, 1);
  }
  const Vector3d turned_by_error = turn * by_error;
  const Vector3d shifted_by_error = shift * by_error;
  Eigen::Matrix<double, kShared, 3> cross = Eigen::Matrix<double, kShared, 3>::Zero();
  for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
    LandmarkState& landmark = estimate_.landmarks[i];
    const int own = layout_.landmark(static_cast<int>(i));
    for (const Part& row : parts) {
      cross.middleRows(row.at, row.size) = P.block(row.column, own, row.size, 3);
    }
    const Vector3d e_S = R_SW * (landmark.p_W - p_WS);
    const Matrix3d e = skew(e_S);
    const Matrix3d in_turn = turn.lazyProduct(cross);
    const Matrix3d in_shift = shift.lazyProduct(cross);
    const Matrix3d mixed = e * both + (e * in_turn + in_shift) * R_SW.transpose();
    const Matrix3d own_S = R_SW * P.block<3, 3>(own, own) * R_SW.transpose();
    landmark.covariance_S = own_S + shifted - e * turned * e + mixed + mixed.transpose();
    if (error < 0) continue;
    const Vector3d raised = raised_point(e_S);
    Vector3d with_error = e * turned_by_error + shifted_by_error;
    with_error += R_SW * P.block<3, 1>(own, error);
    with_error += 0.5 * P(error, error) * raised;
    const Matrix3d common = with_error * raised.transpose();
    landmark.covariance_S += common + common.transpose();
  }
}

}  // namespace rio
