// SPDX-License-Identifier: BSD-3-Clause
// What the measurements of one state say of it, of the calibration and of landmarks, summed up in
// matrices of fixed size before it enters the normal equations.
//
// (E1) local unknowns y = [pose 6 | velocity 3 | gyro bias 3 | extrinsics 6 | radar errors 2 |
//      time offset 1] and, for some measurements, one landmark l
// (E2) whitened rows r = J y + L l + n of one measurement share the weight w of the robust kernel:
//      A_yy += w J^T J,  A_ly += w L^T J,  A_ll += w L^T L,  g_y += w J^T r,  g_l += w L^T r
// A_yy is summed over many rows at once.
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

  /// Begins anew for the state of `layout`.
  void begin(const WindowLayout& layout) {
    state_ = layout.state;
    for (int i = 0; i < kBody; ++i) columns_[static_cast<std::size_t>(i)] = own_column(layout, i);
    set_columns(kExtrinsics, Extrinsics::kDof, layout.column<Extrinsics>(0));
    set_columns(kRadarErrors, RadarErrors::kDof, layout.column<RadarErrors>(0));
    set_columns(kTimeOffset, 1, layout.time_offset_column());
    A_.setZero();
    g_.setZero();
    rows_ = 0;
    first_ = 0;
    cost_ = 0.0;
  }

  /// Rows of model M for z, part of the open measurement. False if x is outside its domain.
  template <MeasurementModel M>
  bool push(const M& model, const typename M::Measurement& z, const LinearizationPoint& x,
            BlockIndex index) {
    if (rows_ + M::kDim > kCapacity) flush();
    Evaluation<M> e;
    if (!evaluate_at(model, z, typename M::Blocks{}, x, index, &e)) return false;
    if constexpr (M::kDim == 1) {
      const double scale = 1.0 / std::sqrt(e.R(0, 0));
      e.J *= scale;
      e.r *= scale;
    }
    append<M::kDim>(e.J, e.r, typename M::Blocks{}, x);
    return true;
  }

  /// Ends the open measurement, which has the weight `weight` before the kernel.
  /// @param landmark_column in the system; -1 = of no landmark
  void close(double weight, int landmark_column = -1) {
    const int count = rows_ - first_;
    const double chi_squared = r_.segment(first_, count).squaredNorm();
    const KernelValue value =
        evaluate_kernel(options_.kernel, options_.kernel_size * count, chi_squared);
    cost_ += 0.5 * weight * value.cost;
    const double scale = std::sqrt(weight * value.weight);
    J_.middleCols(first_, count) *= scale;
    L_.middleCols(first_, count) *= scale;
    r_.segment(first_, count) *= scale;
    if (landmark_column >= 0) add_landmark(landmark_column, first_, count);
    first_ = rows_;
  }
  /// Takes the rows of the open measurement back.
  void drop() { rows_ = first_; }

  /// All that was closed enters the system; the result is its cost.
  double end() {
    flush();
    system_->add(state_, columns_, A_, g_);
    return cost_;
  }

 private:
  static constexpr int kBody = 12;  // pose, velocity and gyro bias: the first unknowns of a state
  static constexpr int kExtrinsics = kBody;
  static constexpr int kRadarErrors = kExtrinsics + Extrinsics::kDof;
  static constexpr int kTimeOffset = kRadarErrors + RadarErrors::kDof;
  static constexpr int kLocal = kTimeOffset + 1;
  static constexpr int kCapacity = cholesky::kPanel;  // no product is deeper
  static_assert(body::kGyroBias + 3 == kBody);

  static int own_column(const WindowLayout& layout, int i) {
    return body::kSize * layout.state + i;
  }
  void set_columns(int first, int count, int column) {
    for (int i = 0; i < count; ++i) {
      columns_[static_cast<std::size_t>(first) + static_cast<std::size_t>(i)] =
          column < 0 ? -1 : column + i;
    }
  }

  /// First local unknown of a block (E1).
  template <class Block>
  static constexpr int local_column() {
    if constexpr (std::is_same_v<Block, BodyPose>) return body::kAttitude;
    if constexpr (std::is_same_v<Block, BodyVelocity>) return body::kVelocity;
    if constexpr (std::is_same_v<Block, GyroBias>) return body::kGyroBias;
    if constexpr (std::is_same_v<Block, Extrinsics>) return kExtrinsics;
    if constexpr (std::is_same_v<Block, RadarErrors>) return kRadarErrors;
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
  /// From errors of the state stepped back to errors of the state, (E2) of linearize.hpp.
  void undo(const StepBack& step, int row) {
    if (step.seconds == 0.0) return;
    auto J = J_.col(row);
    const Vector3d phi = J.segment<3>(body::kAttitude);
    const Vector3d v = J.segment<3>(body::kVelocity);
    J.segment<3>(body::kAttitude) = step.attitude.transpose() * phi + step.velocity.transpose() * v;
    J.segment<3>(body::kGyroBias) += step.bias.transpose() * phi;
    J.segment<3>(body::kVelocity) -= step.seconds * J.segment<3>(body::kPosition);
  }

  void add_landmark(int column, int first, int count) {
    Eigen::Matrix<double, 3, kLocal> A_ly = Eigen::Matrix<double, 3, kLocal>::Zero();
    Matrix3d A_ll = Matrix3d::Zero();
    Vector3d g_l = Vector3d::Zero();
    for (int i = first; i < first + count; ++i) {
      A_ly += L_.col(i) * J_.col(i).transpose();
      A_ll += L_.col(i) * L_.col(i).transpose();
      g_l += L_.col(i) * r_[i];
    }
    system_->add_coupled(column, columns_, A_ll, A_ly, g_l);
  }

  /// The closed rows into A_yy; the open ones move to the front.
  void flush() {
    const auto rows = J_.leftCols(first_);
    A_.selfadjointView<Eigen::Lower>().rankUpdate(rows);
    g_.noalias() += rows * r_.head(first_);
    for (int i = first_; i < rows_; ++i) {
      J_.col(i - first_) = J_.col(i);
      L_.col(i - first_) = L_.col(i);
      r_[i - first_] = r_[i];
    }
    rows_ -= first_;
    first_ = 0;
  }

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
