// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/reexpression.hpp"

namespace rio {

namespace {

/// P <- M P.
void apply(const Layout& layout, const Estimate& before, const Estimate& after,
           Eigen::Ref<Eigen::MatrixXd> P) {
  const Matrix3d R_before = before.nav.q_WB.toRotationMatrix();
  const auto carry = [&P](int row, const Vector3d& shift, const Matrix3d& R, int theta) {
    const Matrix3d A = skew(shift) * R;
    for (Eigen::Index c = 0; c < P.cols(); ++c) {
      const Vector3d old = P.col(c).segment<3>(theta);
      P.col(c).segment<3>(row) -= A * old;
    }
  };
  const auto rotate = [&P](int theta, const Matrix3d& A) {
    for (Eigen::Index c = 0; c < P.cols(); ++c) {
      const Vector3d old = P.col(c).segment<3>(theta);
      P.col(c).segment<3>(theta) = A * old;
    }
  };
  carry(body::kPosition, after.nav.p_WB - before.nav.p_WB, R_before, body::kAttitude);
  carry(body::kVelocity, after.nav.v_WB - before.nav.v_WB, R_before, body::kAttitude);
  for (std::size_t i = 0; i < before.landmarks.size(); ++i) {
    carry(layout.landmark(static_cast<int>(i)), after.landmarks[i].p_W - before.landmarks[i].p_W,
          R_before, body::kAttitude);
  }
  rotate(body::kAttitude, after.nav.q_WB.toRotationMatrix().transpose() * R_before);
  for (std::size_t i = 0; i < before.clones.size(); ++i) {
    const RigidPose& from = before.clones[i].T_WB;
    const RigidPose& to = after.clones[i].T_WB;
    const int theta = layout.clone(static_cast<int>(i));
    carry(theta + 3, to.p - from.p, from.R, theta);
    rotate(theta, to.R.transpose() * from.R);
  }
}

}  // namespace

void reexpress(const Layout& layout, const Estimate& before, const Estimate& after,
               Covariance* covariance) {
  Eigen::Ref<Eigen::MatrixXd> P = covariance->matrix();
  apply(layout, before, after, P);
  P.transposeInPlace();
  apply(layout, before, after, P);
  for (Eigen::Index c = 1; c < P.cols(); ++c) {
    for (Eigen::Index r = 0; r < c; ++r) P(r, c) = P(c, r);
  }
}

}  // namespace rio
