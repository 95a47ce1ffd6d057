// SPDX-License-Identifier: BSD-3-Clause
#include "support/window_cost.hpp"

#include <ceres/dynamic_numeric_diff_cost_function.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "support/symmetric.hpp"

namespace rio::test {

namespace {

using Vector15d = Eigen::Matrix<double, 15, 1>;
using ConstVector3 = Eigen::Map<const Vector3d>;

/// Rotation matrix of a rotation vector.
Matrix3d rotation(const Vector3d& phi) {
  Matrix3d R;
  ceres::AngleAxisToRotationMatrix(phi.data(), R.data());
  return R;
}
/// Rotation vector of a rotation matrix.
Vector3d rotation_vector(const Matrix3d& R) {
  Vector3d phi;
  ceres::RotationMatrixToAngleAxis(R.data(), phi.data());
  return phi;
}
/// The angle of a rotation about the vertical: what is left has none about it.
double heading(const Matrix3d& R) {
  double wxyz[4];
  ceres::RotationMatrixToQuaternion(R.data(), wxyz);
  return 2.0 * std::atan2(wxyz[3], wxyz[0]);
}

struct State {
  Matrix3d R;
  Vector3d p, v, gyro_bias, accel_bias;

  State(const NavState& at, const double* error) {
    const Eigen::Map<const Vector15d> e(error);
    R = at.q_WB.toRotationMatrix() * rotation(e.segment<3>(body::kAttitude));
    p = at.p_WB + e.segment<3>(body::kPosition);
    v = at.v_WB + e.segment<3>(body::kVelocity);
    gyro_bias = at.gyro_bias + e.segment<3>(body::kGyroBias);
    accel_bias = at.accel_bias + e.segment<3>(body::kAccelBias);
  }
};

struct Mount {
  Matrix3d R;
  Vector3d p;

  Mount(const Pose& at, const double* error)
      : R(at.rotation.toRotationMatrix() * rotation(ConstVector3(error))),
        p(at.translation + ConstVector3(error + 3)) {}
};

}  // namespace

ScanCost::Radar ScanCost::radar(const double* state, const double* mount, const double* scale_error,
                                const double* offset) const {
  State x(scan.nav, state);
  const Mount m(T_BS, mount);
  const double grown = offset[0] + time_offset - scan.scanned[0].time_offset;
  const double later = scan.at_rest() ? 0.0 : grown;  // at rest it stands
  const Vector3d w = scan.gyro_B - x.gyro_bias;
  const Vector3d accel_W = x.R * scan.accel_B;
  x.R = x.R * rotation(-later * w);
  x.p -= later * x.v;
  x.v -= later * accel_W;
  Radar out;
  out.R_WS = x.R * m.R;
  out.p_WS = x.R * m.p + x.p;
  out.v_S = m.R.transpose() * (x.R.transpose() * x.v + w.cross(m.p));
  const SteadyMotion steady = scan.at_rest() ? SteadyMotion{} : scan.steady;
  out.steady_S = m.R.transpose() * (steady.v_B + steady.rate_B.cross(m.p));
  out.scale = 1.0 + scale_error[0] + doppler_scale - scan.scanned[0].doppler_scale;
  return out;
}

ScanCost::Radar ScanCost::uncalibrated(const double* state, const double* offset) const {
  constexpr double kZero[6] = {};
  return radar(state, kZero, kZero, offset);
}

double DopplerCost::variance(const Vector3d& scaled_v_S) const {
  if (frozen_variance) return *frozen_variance;
  double out = z.sigma_doppler * z.sigma_doppler;
  if (direction_noise) out += scaled_v_S.dot(z.direction_cov * scaled_v_S);
  return z.variance_factor * out;
}

void DopplerCost::operator()(const double* state, const double* mount, const double* scale_error,
                             const double* offset, double* r) const {
  const ScanCost::Radar radar = base.radar(state, mount, scale_error, offset);
  const ScanCost::Radar before = base.uncalibrated(state, offset);
  const Vector3d steady = radar.scale * radar.steady_S;
  const Vector3d v = before.scale * before.v_S + steady - before.scale * before.steady_S;
  r[0] = (z.range_rate + length * z.direction_S.dot(v)) / std::sqrt(variance(v));
}

void PointCost::operator()(const double* state, const double* mount, const double* scale_error,
                           const double* offset, const double* elevation,
                           const double* landmark_error, double* r) const {
  const ScanCost::Radar radar = base.radar(state, mount, scale_error, offset);
  const Vector3d point =
      radar.R_WS.transpose() * (landmark + ConstVector3(landmark_error) - radar.p_WS);
  const double range = point.norm();
  const Vector3d u = point / range;
  const double az = z.sigma_azimuth_S.norm();
  const double el = z.sigma_elevation_S.norm();
  r[0] = (z.range - range) / z.sigma_range;
  r[1] = -u.dot(z.sigma_azimuth_S / az) / az;
  r[2] = -(u.dot(z.sigma_elevation_S / el) + elevation_error + elevation[0]) / el;
  if (doppler) {
    const ScanCost::Radar before = base.uncalibrated(state, offset);
    const double calibrated =
        radar.scale * u.dot(radar.steady_S) - before.scale * u.dot(before.steady_S);
    r[3] = (doppler->range_rate + before.scale * u.dot(before.v_S) + calibrated) /
           doppler->sigma_doppler;
  }
}

void RangeCost::operator()(const double* state, const double* mount, const double* scale_error,
                           const double* offset, const double* landmark_error, double* r) const {
  const ScanCost::Radar radar = base.radar(state, mount, scale_error, offset);
  r[0] = (range - (landmark + ConstVector3(landmark_error) - radar.p_WS).norm()) / sigma;
}

void TrailCost::operator()(const double* state, const double* past_state, const double* mount,
                           const double* scale_error, const double* offset, double* r) const {
  const ScanCost::Radar radar = base.radar(state, mount, scale_error, offset);
  const State then(past, past_state);
  const Mount m(base.T_BS, mount);
  const Vector3d point = then.R * (m.R * z.past_S + m.p) + then.p;
  r[0] = (z.range - (point - radar.p_WS).norm()) / sigma;
}

void RestCost::operator()(const double* state, double* r) const {
  const State x(at, state);
  Eigen::Map<Eigen::Matrix<double, 6, 1>> out(r);
  out << -(x.R.transpose() * x.v) / z.sigma_velocity, (z.gyro_B - x.gyro_bias) / z.sigma_rate;
}

ImuCost::ImuCost(const Preintegration& imu, double gravity, const NavState& i, const NavState& j)
    : first(i),
      last(j),
      increment(imu.increment()),
      gyro_bias(imu.gyro_bias()),
      accel_bias(imu.accel_bias()),
      A(imu.transition()),
      whitening(test::whitening(imu.covariance())),
      seconds(to_seconds(imu.duration())),
      g_W(0.0, 0.0, -gravity) {}

void ImuCost::operator()(const double* state_i, const double* state_j, double* r) const {
  const State i(first, state_i);
  const State j(last, state_j);
  const Vector3d dbg = i.gyro_bias - gyro_bias;
  const Vector3d dba = i.accel_bias - accel_bias;
  const auto part = [&](int row, int column) -> Matrix3d { return A.block<3, 3>(row, column); };
  const Matrix3d dR =
      increment.delta_q.toRotationMatrix() * rotation(part(body::kAttitude, body::kGyroBias) * dbg);
  const Vector3d dv = increment.delta_v + part(body::kVelocity, body::kGyroBias) * dbg +
                      part(body::kVelocity, body::kAccelBias) * dba;
  const Vector3d dp = increment.delta_p + part(body::kPosition, body::kGyroBias) * dbg +
                      part(body::kPosition, body::kAccelBias) * dba;
  const Matrix3d R_iW = i.R.transpose();
  Vector15d e;
  e << rotation_vector(dR.transpose() * R_iW * j.R),
      R_iW * (j.p - i.p - i.v * seconds - 0.5 * seconds * seconds * g_W) - dp,
      R_iW * (j.v - i.v - seconds * g_W) - dv, j.gyro_bias - i.gyro_bias,
      j.accel_bias - i.accel_bias;
  Eigen::Map<Vector15d> out(r);
  out = whitening * e;
}

void PriorCost::factorise(const Eigen::MatrixXd& A, const Eigen::VectorXd& g) {
  const Eigen::VectorXd scale =
      A.diagonal().unaryExpr([](double a) { return a > 0.0 ? 1.0 / std::sqrt(a) : 0.0; });
  Eigen::MatrixXd vectors;
  const Eigen::VectorXd values = eigenvalues(scale.asDiagonal() * A * scale.asDiagonal(), &vectors);
  constexpr double kRounding = 1e-12;  // of a unit diagonal of some hundred rows
  const Eigen::Index n = A.rows();
  const Eigen::Index zero = (values.array() < kRounding).count();
  const Eigen::MatrixXd V = vectors.rightCols(n - zero);
  const Eigen::VectorXd s = values.tail(n - zero).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double d) { return d > 0.0 ? 1.0 / d : 0.0; });
  root = s.asDiagonal() * V.transpose() * inverse.asDiagonal();
  offset = s.cwiseInverse().asDiagonal() * (V.transpose() * (scale.asDiagonal() * g));
}

void PriorCost::error(const double* const* blocks, double* out) const {
  Eigen::Map<Eigen::VectorXd> xi(out, root.cols());
  const State oldest(now.states[0], blocks[0]);
  const double psi = heading(oldest.R * made.states[0].q_WB.toRotationMatrix().transpose());
  const Matrix3d back = rotation(Vector3d(0.0, 0.0, -psi));
  Eigen::Index at = 0;
  std::size_t block = 0;
  for (std::size_t s = 0; s < made.states.size(); ++s, at += body::kSize) {
    const State x(now.states[s], blocks[block++]);
    const NavState& then = made.states[s];
    xi.segment<15>(at) << rotation_vector(back * x.R * then.q_WB.toRotationMatrix().transpose()),
        back * x.p - then.p_WB, back * x.v - then.v_WB, x.gyro_bias - then.gyro_bias,
        x.accel_bias - then.accel_bias;
  }
  xi[body::kAttitude + 2] = psi;
  const Mount mount(now.radar.T_BS, blocks[block++]);
  if (layout.has_extrinsics()) {
    const Pose& then = made.radar.T_BS;
    xi.segment<6>(at) << rotation_vector(then.rotation.toRotationMatrix().transpose() * mount.R),
        mount.p - then.translation;
    at += 6;
  }
  const auto add_number = [&](bool estimated, double RadarState::*number) {
    const double error = blocks[block++][0];
    if (estimated) xi[at++] = error + now.radar.*number - made.radar.*number;
  };
  add_number(layout.has_doppler_scale(), &RadarState::doppler_scale);
  add_number(layout.has_time_offset(), &RadarState::time_offset);
  add_number(layout.has_elevation_error(), &RadarState::elevation_error);
  for (std::size_t i = 0; i < made.landmarks.size(); ++i, at += 3) {
    xi.segment<3>(at) =
        back * (now.landmarks[i] + ConstVector3(blocks[block++])) - made.landmarks[i];
  }
}

ceres::CostFunction* differentiated(Residual residual, const std::vector<int>& sizes, int rows) {
  ceres::NumericDiffOptions options;  // differences of h, h/2 and h/4: an error of the order h^6
  options.ridders_relative_initial_step_size = 1e-3;
  options.max_num_ridders_extrapolations = 3;
  auto* cost = new ceres::DynamicNumericDiffCostFunction<Residual, ceres::RIDDERS>(
      new Residual(std::move(residual)), ceres::TAKE_OWNERSHIP, options);
  for (const int size : sizes) cost->AddParameterBlock(size);
  cost->SetNumResiduals(rows);
  return cost;
}

ceres::CostFunction* differentiated(const PriorCost& cost, const std::vector<int>& sizes) {
  const auto residual = [cost](const double* const* blocks, double* r) {
    Eigen::VectorXd xi(cost.root.cols());
    cost.error(blocks, xi.data());
    Eigen::Map<Eigen::VectorXd>(r, cost.root.rows()) = cost.root * xi - cost.offset;
    return true;
  };
  return differentiated(Residual(residual), sizes, static_cast<int>(cost.root.rows()));
}

}  // namespace rio::test
