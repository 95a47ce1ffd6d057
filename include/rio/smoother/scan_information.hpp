// SPDX-License-Identifier: BSD-3-Clause
// Accumulates the information of the measurements of one state about the state, the calibration and
// landmarks, in matrices of fixed size, before it is added to the normal equations.
//
// (E1) local unknowns y = [pose 6 | velocity 3 | gyro bias 3 | extrinsics 6 | Doppler scale 1 |
//      time offset 1 | elevation error 1] and, for some measurements, one landmark l
// (E2) whitened rows r = J y + L l + n of one measurement share the weight w of the robust kernel:
//      A_yy += w J^T J,  A_ly += w L^T J,  A_ll += w L^T L,  g_y += w J^T r,  g_l += w L^T r
// A_yy is summed over many rows at once.
// (E3) The Dopplers of points share the noise of the gyro sample, of variance s per axis, with the
//      coefficients of the gyro bias b: R^-1 by the identity of Woodbury makes it
//      A -= A_yb K A_by,  g -= A_yb K g_b,  cost -= g_b^T K g_b / 2,  K = (A_bb + I / s)^-1
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <type_traits>

#include "rio/options.hpp"
#include "rio/smoother/kernel.hpp"
#include "rio/smoother/normal_equations.hpp"
#include "rio/smoother/window.hpp"
#include "rio/update/linearize.hpp"

namespace rio {

class ScanInformation {
 public:
  ScanInformation(const SmootherOptions& options, NormalEquations* system)
      : options_(options), system_(system) {}

  /// Starts over for the state of `layout`.
  void begin(const WindowLayout& layout);

  /// Adds rows of model M for z to the open measurement. False if x is outside its domain.
  template <MeasurementModel M, class... B>
  bool push(const M& model, const typename M::Measurement& z, BlockList<B...> blocks,
            const LinearizationPoint& x, BlockIndex index) {
    if (rows_ + M::kDim > kCapacity) flush();
    Evaluation<M> e;
    if (!model.evaluate(z, block_value<B>(x, index)..., e.r, &e.J, e.R)) return false;
    if constexpr (M::kDim > 1) {
      whiten(&e);
    } else {
      const double scale = 1.0 / std::sqrt(e.R(0, 0));
      e.J *= scale;
      e.r *= scale;
    }
    append<M::kDim>(e.J, e.r, blocks, x);
    return true;
  }

  /// Closes the open measurement.
  /// @param weight factor of its information, before the kernel
  /// @param landmark_column in the system; -1 = of no landmark
  void close(double weight, int landmark_column = -1);
  /// Discards the rows of the open measurement.
  void drop() { rows_ = first_; }

  /// (E3) for the measurements closed so far, which must not touch landmarks.
  /// @param variance s [rad^2/s^2]
  void share_rate_noise(double variance);

  /// Adds all closed measurements to the system; returns their cost.
  double end();

 private:
  static constexpr int kBody = 12;  // pose, velocity and gyro bias: the first unknowns of a state
  static constexpr int kExtrinsics = kBody;
  static constexpr int kDopplerScale = kExtrinsics + Extrinsics::kDof;
  static constexpr int kTimeOffset = kDopplerScale + 1;
  static constexpr int kElevationError = kTimeOffset + 1;
  static constexpr int kLocal = kElevationError + 1;
  static constexpr int kCapacity = cholesky::kPanel;  // no product is deeper
  static_assert(body::kGyroBias + 3 == kBody);

  void set_columns(int first, int count, int column);

  /// First local unknown of a block (E1).
  template <class Block>
  static constexpr int local_column() {
    if constexpr (std::is_same_v<Block, BodyPose>) return body::kAttitude;
    if constexpr (std::is_same_v<Block, BodyVelocity>) return body::kVelocity;
    if constexpr (std::is_same_v<Block, GyroBias>) return body::kGyroBias;
    if constexpr (std::is_same_v<Block, Extrinsics>) return kExtrinsics;
    if constexpr (std::is_same_v<Block, DopplerScale>) return kDopplerScale;
    if constexpr (std::is_same_v<Block, ElevationError>) return kElevationError;
  }

  template <int kDim, class... B>
  void append(const JacobianOf<kDim, BlockList<B...>::kDof>& J, const ResidualOf<kDim>& r,
              BlockList<B...> blocks, const LinearizationPoint& x) {
    auto rows = J_.template middleCols<kDim>(rows_);
    rows.setZero();
    const auto place = [&]<class Block>(std::type_identity<Block>) {
      const auto block =
          J.template middleCols<Block::kDof>(BlockList<B...>::template column<Block>()).transpose();
      if constexpr (std::is_same_v<Block, Landmark>) {
        L_.template middleCols<kDim>(rows_) = block;
      } else {
        rows.template middleRows<Block::kDof>(local_column<Block>()) = block;
      }
    };
    (place(std::type_identity<B>{}), ...);
    rows.row(kTimeOffset) = time_derivative<kDim>(J, blocks, x).transpose();
    r_.template segment<kDim>(rows_) = r;
    for (int i = 0; i < kDim; ++i) undo(x.step, rows_++);
  }
  /// Maps a row to the errors of the state before it was stepped back, (E2) of linearize.hpp.
  void undo(const StepBack& step, int row);

  void add_landmark(int column, int first, int count);

  /// Adds the closed rows to A_yy; the open ones move to the front.
  void flush();

  SmootherOptions options_;
  NormalEquations* system_;
  int state_ = 0;
  std::array<int, static_cast<std::size_t>(kLocal)> columns_{};
  Eigen::Matrix<double, kLocal, kCapacity> J_;  // transposed: a column for each row
  Eigen::Matrix<double, 3, kCapacity> L_;       // transposed
  Eigen::Matrix<double, kCapacity, 1> r_;
  int rows_ = 0;
  int first_ = 0;  // of the open measurement
  Eigen::Matrix<double, kLocal, kLocal> A_;
  Eigen::Matrix<double, kLocal, 1> g_;
  double cost_ = 0.0;
};

}  // namespace rio
