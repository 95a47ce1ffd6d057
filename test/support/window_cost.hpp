// SPDX-License-Identifier: BSD-3-Clause
// The cost of a sliding window as residuals, written anew from the documentation of the models and
// differentiated numerically: a referee for the smoother. The unknowns are errors relative to a
// reference point, in the order of namespace body and of the blocks:
//   state 15 | T_BS 6 | Doppler scale 1 | time offset 1 | elevation error 1 | landmark 3
// so that the solution of Ceres is the distance of its minimum from that point.
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "rio/smoother/smoother.hpp"

namespace rio::test {

/// Where the referee counts from, and which scan of the window measures.
struct ScanCost {
  WindowState scan;  ///< its state is the reference
  Pose T_BS;
  double doppler_scale = 0.0;
  double time_offset = 0.0;

  /// The radar as it measured: the state of the scan, earlier by what the time offset has grown.
  struct Radar {
    Matrix3d R_WS;
    Vector3d p_WS, v_S;
    double scale;       ///< what the range rates are still too large by
    Vector3d steady_S;  ///< the steady velocity (propagate/steady_motion.hpp)
  };
  Radar radar(const double* state, const double* mount, const double* scale_error,
              const double* offset) const;
  /// The same with the calibration of the reference: a Doppler changes with the calibration as if
  /// the radar moved at the steady velocity.
  Radar uncalibrated(const double* state, const double* offset) const;
};

struct DopplerCost {
  ScanCost base;
  DopplerModel::Measurement z;
  bool direction_noise = true;
  /// Given, the variance is this and does not follow the velocity [m^2/s^2].
  std::optional<double> frozen_variance;
  double length = 1.0;  ///< of the direction: 1 + tr Sigma_u / 2 if its errors are corrected

  double variance(const Vector3d& scaled_v_S) const;
  void operator()(const double* state, const double* mount, const double* scale_error,
                  const double* offset, double* r) const;
};

struct PointCost {
  ScanCost base;
  LandmarkPointModel::Measurement z;
  std::optional<LandmarkDopplerModel::Measurement> doppler;
  Vector3d landmark;
  double elevation_error = 0.0;

  void operator()(const double* state, const double* mount, const double* scale_error,
                  const double* offset, const double* elevation, const double* landmark_error,
                  double* r) const;
};

struct RangeCost {
  ScanCost base;
  double range = 0.0;
  double sigma = 0.0;
  Vector3d landmark;

  void operator()(const double* state, const double* mount, const double* scale_error,
                  const double* offset, const double* landmark_error, double* r) const;
};

struct TrailCost {
  ScanCost base;
  NavState past;
  TrailDistanceModel::Measurement z;
  double sigma = 0.0;

  void operator()(const double* state, const double* past_state, const double* mount,
                  const double* scale_error, const double* offset, double* r) const;
};

struct RestCost {
  NavState at;
  RestModel::Measurement z;

  void operator()(const double* state, double* r) const;
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

  void operator()(const double* state_i, const double* state_j, double* r) const;
};

/// The prior of prior.hpp, (E1) to (E3), about the point where it was made. With D A D = V s V^T
/// the cost xi^T A xi / 2 - g^T xi is |r|^2 / 2 up to a constant for
/// r = s^1/2 V^T D^-1 xi - s^-1/2 V^T D g.
struct PriorCost {
  /// All that the prior knows, at one time.
  struct Point {
    std::vector<NavState> states;  ///< the leading ones
    RadarState radar;
    std::vector<Vector3d> landmarks;
  };
  Layout layout;
  Point made;              ///< where the prior was made
  Point now;               ///< the reference
  Eigen::MatrixXd root;    ///< s^1/2 V^T D^-1
  Eigen::VectorXd offset;  ///< s^-1/2 V^T D g

  void factorise(const Eigen::MatrixXd& A, const Eigen::VectorXd& g);

  /// xi.
  /// @param blocks leading states, T_BS, Doppler scale, time offset, landmarks
  void error(const double* const* blocks, double* xi) const;
};

/// Residual r of the parameter blocks; true.
using Residual = std::function<bool(const double* const* blocks, double* r)>;

/// A residual with its derivatives, for Ceres to own: numerical ones, exact to 1e-11 for parameters
/// of the order of 1. Automatic ones would take a minute of compiler, and no fewer evaluations.
/// @param sizes of the blocks  @param rows of the residual
ceres::CostFunction* differentiated(Residual residual, const std::vector<int>& sizes, int rows);
ceres::CostFunction* differentiated(const PriorCost& cost, const std::vector<int>& sizes);

template <class Cost, std::size_t kBlocks>
ceres::CostFunction* differentiated(const Cost& cost, const std::array<int, kBlocks>& sizes,
                                    int rows) {
  const auto residual = [cost](const double* const* blocks, double* r) {
    const auto call = [&]<std::size_t... kIndex>(std::index_sequence<kIndex...>) {
      cost(blocks[kIndex]..., r);
    };
    call(std::make_index_sequence<kBlocks>{});
    return true;
  };
  return differentiated(Residual(residual), {sizes.begin(), sizes.end()}, rows);
}

}  // namespace rio::test
