// SPDX-License-Identifier: BSD-3-Clause
// For the matching: the covariance of every landmark relative to the radar.
#include "rio/core/so3.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

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
  Eigen::Matrix<double, kShared, 3> cross = Eigen::Matrix<double, kShared, 3>::Zero();
  for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
    LandmarkState& landmark = estimate_.landmarks[i];
    const int own = layout_.landmark(static_cast<int>(i));
    for (const Part& row : parts) {
      cross.middleRows(row.at, row.size) = P.block(row.column, own, row.size, 3);
    }
    const Matrix3d e = skew(R_SW * (landmark.p_W - p_WS));
    const Matrix3d in_turn = turn.lazyProduct(cross);
    const Matrix3d in_shift = shift.lazyProduct(cross);
    const Matrix3d mixed = e * both + (e * in_turn + in_shift) * R_SW.transpose();
    const Matrix3d own_S = R_SW * P.block<3, 3>(own, own) * R_SW.transpose();
    landmark.covariance_S = own_S + shifted - e * turned * e + mixed + mixed.transpose();
  }
}

}  // namespace rio
