// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/reexpression.hpp"

#include <array>

#include "rio/core/combine_columns.hpp"
#include "rio/core/so3.hpp"

namespace rio {

Reexpression::Reexpression(int capacity) : U_(capacity, 3), V_(capacity, 3), combined_(capacity) {}

void Reexpression::apply(const Layout& layout, const Estimate& before, const Estimate& after,
                         Covariance* covariance) {
  Eigen::Ref<Eigen::MatrixXd> P = covariance->matrix();
  const auto carry = [this](int row, const Vector3d& shift, const Matrix3d& R) {
    U_.middleRows<3>(row) = -skew(shift) * R;
  };
  const auto turn = [this](int theta, const Matrix3d& R_after, const Matrix3d& R_before) {
    U_.middleRows<3>(theta) = R_after.transpose() * R_before - Matrix3d::Identity();
  };
  for (std::size_t i = 0; layout.max_clones() > 0 && i < before.clones.size(); ++i) {
    const RigidPose& from = before.clones[i].T_WB;
    const RigidPose& to = after.clones[i].T_WB;
    const int theta = layout.clone(static_cast<int>(i));
    U_.topRows(P.rows()).setZero();
    turn(theta, to.R, from.R);
    carry(theta + 3, to.p - from.p, from.R);
    transform(theta, P);
  }
  const Matrix3d R = before.nav.q_WB.toRotationMatrix();
  U_.topRows(P.rows()).setZero();
  turn(body::kAttitude, after.nav.q_WB.toRotationMatrix(), R);
  carry(body::kPosition, after.nav.p_WB - before.nav.p_WB, R);
  carry(body::kVelocity, after.nav.v_WB - before.nav.v_WB, R);
  for (std::size_t i = 0; i < before.landmarks.size(); ++i) {
    carry(layout.landmark(static_cast<int>(i)), after.landmarks[i].p_W - before.landmarks[i].p_W,
          R);
  }
  transform(body::kAttitude, P);
}

void Reexpression::transform(int theta, Eigen::Ref<Eigen::MatrixXd> P) {
  const Eigen::Index n = P.rows();
  auto U = U_.topRows(n);
  auto V = V_.topRows(n);
  V.topRows(theta) = P.block(theta, 0, 3, theta).transpose();
  V.bottomRows(n - theta) = P.block(theta, theta, n - theta, 3);
  const Matrix3d own = Matrix3d(V.middleRows<3>(theta)).selfadjointView<Eigen::Lower>();
  V.middleRows<3>(theta) = own;
  V.noalias() += U * (0.5 * own);
  for (Eigen::Index c = 0; c < n; ++c) {  // P <- P + U V^T + V U^T, lower triangle
    const Eigen::Index rest = n - c;
    const std::array<const double*, 6> columns = {&V(c, 0), &U(c, 0), &V(c, 1),
                                                  &U(c, 1), &V(c, 2), &U(c, 2)};
    const std::array<double, 6> factors = {U(c, 0), V(c, 0), U(c, 1), V(c, 1), U(c, 2), V(c, 2)};
    combine_columns(columns.size(), columns.data(), factors.data(), rest, combined_.data());
    P.col(c).tail(rest) += combined_.head(rest);
  }
}

}  // namespace rio
