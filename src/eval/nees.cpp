// SPDX-License-Identifier: BSD-3-Clause
#include "rio/eval/nees.hpp"

#include <Eigen/Cholesky>

namespace rio::eval {

BodyError body_error(const NavState& estimate, const NavState& truth) {
  BodyError error;
  error.segment<3>(body::kAttitude) = quaternion_log(estimate.q_WB.conjugate() * truth.q_WB);
  error.segment<3>(body::kPosition) = truth.p_WB - estimate.p_WB;
  error.segment<3>(body::kVelocity) = truth.v_WB - estimate.v_WB;
  error.segment<3>(body::kGyroBias) = truth.gyro_bias - estimate.gyro_bias;
  error.segment<3>(body::kAccelBias) = truth.accel_bias - estimate.accel_bias;
  return error;
}

double nees(const Eigen::Ref<const Eigen::VectorXd>& error,
            const Eigen::Ref<const Eigen::MatrixXd>& P) {
  RIO_ASSERT(P.rows() == error.size() && P.cols() == error.size());
  const Eigen::LLT<Eigen::MatrixXd> llt(P);
  if (llt.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
  Eigen::VectorXd white = error;
  llt.matrixL().solveInPlace(white);
  return white.squaredNorm();
}

AneesBounds anees_bounds(int dof, int runs, double probability) {
  RIO_ASSERT(dof > 0 && runs > 0);
  const double total = static_cast<double>(dof) * runs;
  const double miss = 0.5 * (1.0 - probability);
  return {chi2_quantile(miss, total) / runs, chi2_quantile(1.0 - miss, total) / runs};
}

}  // namespace rio::eval
