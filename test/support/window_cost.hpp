// SPDX-License-Identifier: BSD-3-Clause
// The cost of a sliding window as Ceres residuals, written anew from the documentation of the
// models for automatic differentiation: a referee for the smoother. The unknowns are errors
// relative to a reference point, in the order of namespace body and of the blocks:
//   state 15 | T_BS 6 | radar errors 2 | time offset 1 | landmark 3
// so that the solution of Ceres is the distance of its minimum from that point.
// Their automatic derivatives take gigabytes of compiler: each window_cost*.cpp holds some.
#pragma once

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Core>
#include <array>
#include <vector>

#include "rio/smoother/smoother.hpp"

namespace rio::test {

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;
template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;

/// Rotation matrix of a rotation vector.
template <class T>
Matrix3<T> rotation(const Vector3<T>& phi) {
  Matrix3<T> R;
  ceres::AngleAxisToRotationMatrix(phi.data(), R.data());
  return R;
}
/// Rotation vector of a rotation matrix.
template <class T>
Vector3<T> rotation_vector(const Matrix3<T>& R) {
  Vector3<T> phi;
  ceres::RotationMatrixToAngleAxis(R.data(), phi.data());
  return phi;
}

/// The angle of a rotation about the vertical: what is left has none about it.
template <class T>
T heading(const Matrix3<T>& R) {
  using std::atan2;
  T wxyz[4];
  ceres::RotationMatrixToQuaternion(R.data(), wxyz);
  return 2.0 * atan2(wxyz[3], wxyz[0]);
}

template <class T>
struct StateOf {
  Matrix3<T> R;
  Vector3<T> p, v, gyro_bias, accel_bias;

  StateOf(const NavState& at, const T* error) {
    const Eigen::Map<const Eigen::Matrix<T, 15, 1>> e(error);
    R = at.q_WB.toRotationMatrix().cast<T>() *
        rotation<T>(e.template segment<3>(body::kAttitude).eval());
    p = at.p_WB.cast<T>() + e.template segment<3>(body::kPosition);
    v = at.v_WB.cast<T>() + e.template segment<3>(body::kVelocity);
    gyro_bias = at.gyro_bias.cast<T>() + e.template segment<3>(body::kGyroBias);
    accel_bias = at.accel_bias.cast<T>() + e.template segment<3>(body::kAccelBias);
  }
};

template <class T>
struct MountOf {
  Matrix3<T> R;
  Vector3<T> p;

  MountOf(const Pose& at, const T* error) {
    const Eigen::Map<const Eigen::Matrix<T, 6, 1>> e(error);
    R = at.rotation.toRotationMatrix().cast<T>() * rotation<T>(e.template head<3>().eval());
    p = at.translation.cast<T>() + e.template tail<3>();
  }
};

/// Where the referee counts from, and which scan of the window measures.
struct ScanCost {
  WindowState scan;  ///< its state is the reference
  Pose T_BS;
  RadarErrors::Value radar_errors;
  double time_offset = 0.0;

  /// The radar as it measured: the state of the scan, earlier by what the time offset has grown.
  template <class T>
  struct Radar {
    Matrix3<T> R_WS;
    Vector3<T> p_WS, v_S;
    T scale, elevation;  ///< what the detections are still wrong by
  };
  template <class T>
  Radar<T> radar(const T* state, const T* mount, const T* errors, const T* offset) const {
    StateOf<T> x(scan.nav, state);
    const MountOf<T> m(T_BS, mount);
    T later = offset[0] + time_offset - scan.scanned[0].time_offset;
    if (scan.at_rest()) later = T(0.0);  // it stands
    const Vector3<T> w = scan.gyro_B.cast<T>() - x.gyro_bias;
    const Vector3<T> accel_W = x.R * scan.accel_B.cast<T>();
    x.R = x.R * rotation<T>((-later * w).eval());
    x.p -= later * x.v;
    x.v -= later * accel_W;
    Radar<T> out;
    out.R_WS = x.R * m.R;
    out.p_WS = x.R * m.p + x.p;
    out.v_S = m.R.transpose() * (x.R.transpose() * x.v + w.cross(m.p));
    out.scale = 1.0 + errors[0] + radar_errors[0] - scan.scanned[0].radar_errors[0];
    out.elevation = errors[1] + radar_errors[1] - scan.scanned[0].radar_errors[1];
    return out;
  }
};

struct DopplerCost {
  ScanCost base;
  DopplerModel::Measurement z;
  bool direction_noise = true;
  /// Given, the variance is this and does not follow the velocity [m^2/s^2].
  std::optional<double> frozen_variance;
  double length = 1.0;  ///< of the direction: 1 + tr Sigma_u / 2 if its errors are corrected

  template <class T>
  T variance(const Vector3<T>& scaled_v_S) const {
    if (frozen_variance) return T(*frozen_variance);
    T out = T(z.sigma_doppler * z.sigma_doppler);
    if (direction_noise) out += scaled_v_S.dot(z.direction_cov.cast<T>() * scaled_v_S);
    return z.variance_factor * out;
  }
  template <class T>
  bool operator()(const T* state, const T* mount, const T* errors, const T* offset, T* r) const {
    using std::cos;
    using std::sin;
    using std::sqrt;
    const auto radar = base.radar(state, mount, errors, offset);
    const Vector3<T> u = cos(radar.elevation) * z.direction_S.cast<T>() -
                         sin(radar.elevation) * z.upwards_S.cast<T>();
    const Vector3<T> v = radar.scale * radar.v_S;
    r[0] = (z.range_rate + length * u.dot(v)) / sqrt(variance<T>(v));
    return true;
  }
};

struct PointCost {
  ScanCost base;
  LandmarkPointModel::Measurement z;
  std::optional<LandmarkDopplerModel::Measurement> doppler;
  Vector3d landmark;

  template <class T>
  bool operator()(const T* state, const T* mount, const T* errors, const T* offset,
                  const T* landmark_error, T* r) const {
    const auto radar = base.radar(state, mount, errors, offset);
    const Eigen::Map<const Vector3<T>> e(landmark_error);
    const Vector3<T> point = radar.R_WS.transpose() * (landmark.cast<T>() + e - radar.p_WS);
    const T range = point.norm();
    const Vector3<T> u = point / range;
    const double az = z.sigma_azimuth_S.norm();
    const double el = z.sigma_elevation_S.norm();
    r[0] = (z.range - range) / z.sigma_range;
    r[1] = -u.dot((z.sigma_azimuth_S / az).cast<T>()) / az;
    r[2] = (-u.dot((z.sigma_elevation_S / el).cast<T>()) - radar.elevation) / el;
    if (doppler) {
      r[3] = (doppler->range_rate + radar.scale * u.dot(radar.v_S)) / doppler->sigma_doppler;
    }
    return true;
  }
};

struct RangeCost {
  ScanCost base;
  double range = 0.0;
  double sigma = 0.0;
  Vector3d landmark;

  template <class T>
  bool operator()(const T* state, const T* mount, const T* errors, const T* offset,
                  const T* landmark_error, T* r) const {
    const auto radar = base.radar(state, mount, errors, offset);
    const Eigen::Map<const Vector3<T>> e(landmark_error);
    r[0] = (range - (landmark.cast<T>() + e - radar.p_WS).norm()) / sigma;
    return true;
  }
};

struct TrailCost {
  ScanCost base;
  NavState past;
  TrailDistanceModel::Measurement z;
  double sigma = 0.0;

  template <class T>
  bool operator()(const T* state, const T* past_state, const T* mount, const T* errors,
                  const T* offset, T* r) const {
    const auto radar = base.radar(state, mount, errors, offset);
    const StateOf<T> then(past, past_state);
    const MountOf<T> m(base.T_BS, mount);
    const Vector3<T> point = then.R * (m.R * z.past_S.cast<T>() + m.p) + then.p;
    r[0] = (z.range - (point - radar.p_WS).norm()) / sigma;
    return true;
  }
};

struct RestCost {
  NavState at;
  RestModel::Measurement z;

  template <class T>
  bool operator()(const T* state, T* r) const {
    const StateOf<T> x(at, state);
    Eigen::Map<Eigen::Matrix<T, 6, 1>> out(r);
    out.template head<3>() = -(x.R.transpose() * x.v) / T(z.sigma_velocity);
    out.template tail<3>() = (z.gyro_B.cast<T>() - x.gyro_bias) / T(z.sigma_rate);
    return true;
  }
};

/// (E1) and (E4) of imu_factor.hpp, from the increments alone.
struct ImuCost {
  ImuCost(const Preintegration& imu, double gravity, const NavState& i, const NavState& j);

  NavState first, last;
  ImuIncrement increment;
  Vector3d gyro_bias, accel_bias;
  Matrix15d A;
  Matrix15d whitening;
  double seconds;
  Vector3d g_W;

  template <class T>
  bool operator()(const T* state_i, const T* state_j, T* residual) const {
    const StateOf<T> i(first, state_i);
    const StateOf<T> j(last, state_j);
    const Vector3<T> dbg = i.gyro_bias - gyro_bias.cast<T>();
    const Vector3<T> dba = i.accel_bias - accel_bias.cast<T>();
    const auto part = [&](int row, int column) -> Matrix3<T> {
      return A.block<3, 3>(row, column).cast<T>();
    };
    const Matrix3<T> dR = increment.delta_q.toRotationMatrix().cast<T>() *
                          rotation<T>((part(body::kAttitude, body::kGyroBias) * dbg).eval());
    const Vector3<T> dv = increment.delta_v.cast<T>() +
                          part(body::kVelocity, body::kGyroBias) * dbg +
                          part(body::kVelocity, body::kAccelBias) * dba;
    const Vector3<T> dp = increment.delta_p.cast<T>() +
                          part(body::kPosition, body::kGyroBias) * dbg +
                          part(body::kPosition, body::kAccelBias) * dba;
    const Matrix3<T> R_iW = i.R.transpose();
    const Vector3<T> g = g_W.cast<T>();
    Eigen::Matrix<T, 15, 1> r;
    r << rotation_vector<T>((dR.transpose() * R_iW * j.R).eval()),
        R_iW * (j.p - i.p - i.v * seconds - 0.5 * seconds * seconds * g) - dp,
        R_iW * (j.v - i.v - seconds * g) - dv, j.gyro_bias - i.gyro_bias,
        j.accel_bias - i.accel_bias;
    Eigen::Map<Eigen::Matrix<T, 15, 1>> out(residual);
    out = whitening.cast<T>() * r;
    return true;
  }
};

/// A cost with automatic derivatives, for Ceres to own.
/// @param sizes of its blocks  @param rows of its residual
template <class Cost, std::size_t kBlocks>
ceres::CostFunction* differentiated(const Cost& cost, const std::array<int, kBlocks>& sizes,
                                    int rows);

/// The prior of prior.hpp, (E1) to (E3), about the point where it was made. With D A D = V s V^T
/// the cost xi^T A xi / 2 - g^T xi is |r|^2 / 2 up to a constant for
/// r = s^1/2 V^T D^-1 xi - s^-1/2 V^T D g.
struct PriorCost {
  std::vector<NavState> made_states, now_states;
  Pose made_T_BS, now_T_BS;
  Vector3d made_errors, now_errors;  ///< radar errors, time offset
  std::vector<Vector3d> made_landmarks, now_landmarks;
  bool extrinsics = false, radar_errors = false, time_offset = false;
  Eigen::MatrixXd root;    ///< s^1/2 V^T D^-1
  Eigen::VectorXd offset;  ///< s^-1/2 V^T D g

  void factorise(const Eigen::MatrixXd& A, const Eigen::VectorXd& g);

  /// Parameters: leading states, T_BS, radar errors, time offset, landmarks.
  template <class T>
  bool operator()(const T* const* parameters, T* residual) const {
    using VectorT = Eigen::Matrix<T, Eigen::Dynamic, 1>;
    VectorT xi(root.cols());
    Eigen::Index at = 0;
    const StateOf<T> oldest(now_states[0], parameters[0]);
    const T psi = heading<T>(oldest.R * made_states[0].q_WB.toRotationMatrix().transpose());
    const Matrix3<T> back = rotation<T>(Vector3<T>(T(0.0), T(0.0), -psi));
    std::size_t block = 0;
    for (std::size_t s = 0; s < made_states.size(); ++s, at += body::kSize) {
      const StateOf<T> x(now_states[s], parameters[block++]);
      const NavState& made = made_states[s];
      const Matrix3<T> turn = back * x.R * made.q_WB.toRotationMatrix().transpose().cast<T>();
      xi.template segment<15>(at) << rotation_vector<T>(turn), back * x.p - made.p_WB.cast<T>(),
          back * x.v - made.v_WB.cast<T>(), x.gyro_bias - made.gyro_bias.cast<T>(),
          x.accel_bias - made.accel_bias.cast<T>();
    }
    xi[body::kAttitude + 2] = psi;
    const MountOf<T> mount(now_T_BS, parameters[block++]);
    if (extrinsics) {
      const Matrix3<T> R = made_T_BS.rotation.toRotationMatrix().transpose().cast<T>() * mount.R;
      xi.template segment<6>(at) << rotation_vector<T>(R),
          mount.p - made_T_BS.translation.cast<T>();
      at += 6;
    }
    const T* errors = parameters[block++];
    for (int i = 0; radar_errors && i < 2; ++i) {
      xi[at++] = errors[i] + now_errors[i] - made_errors[i];
    }
    const T* late = parameters[block++];
    if (time_offset) xi[at++] = late[0] + now_errors[2] - made_errors[2];
    for (std::size_t i = 0; i < made_landmarks.size(); ++i, at += 3) {
      const Eigen::Map<const Vector3<T>> e(parameters[block++]);
      xi.template segment<3>(at) =
          back * (now_landmarks[i].cast<T>() + e) - made_landmarks[i].cast<T>();
    }
    Eigen::Map<VectorT> out(residual, root.rows());
    out = root.cast<T>() * xi - offset.cast<T>();
    return true;
  }
};

ceres::CostFunction* differentiated(PriorCost&& cost, const std::vector<int>& sizes);

}  // namespace rio::test
