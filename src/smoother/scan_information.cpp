// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/scan_information.hpp"

#include <Eigen/LU>

namespace rio {

void ScanInformation::begin(const WindowLayout& layout) {
  state_ = layout.state;
  set_columns(0, kBody, body::kSize * layout.state);
  set_columns(kExtrinsics, Extrinsics::kDof, layout.column<Extrinsics>(0));
  set_columns(kDopplerScale, 1, layout.column<DopplerScale>(0));
  set_columns(kTimeOffset, 1, layout.time_offset_column());
  set_columns(kElevationError, 1, layout.column<ElevationError>(0));
  A_.setZero();
  g_.setZero();
  rows_ = 0;
  first_ = 0;
  cost_ = 0.0;
}

void ScanInformation::close(double weight, int landmark_column) {
  const int count = rows_ - first_;
  const double chi_squared = r_.segment(first_, count).squaredNorm();
  const bool own_size = landmark_column >= 0 && options_.landmark_kernel_size > 0.0;
  const double size = own_size ? options_.landmark_kernel_size : options_.kernel_size;
  const KernelValue value = evaluate_kernel(options_.kernel, size * count, chi_squared);
  cost_ += 0.5 * weight * value.cost;
  const double scale = std::sqrt(weight * value.weight);
  J_.middleCols(first_, count) *= scale;
  L_.middleCols(first_, count) *= scale;
  r_.segment(first_, count) *= scale;
  if (landmark_column >= 0) add_landmark(landmark_column, first_, count);
  first_ = rows_;
}

void ScanInformation::share_rate_noise(double variance) {
  if (!(variance > 0.0)) return;
  flush();
  constexpr int kBias = body::kGyroBias;
  Eigen::Matrix<double, kLocal, 3> by_bias;
  by_bias.topRows<kBias>() = A_.block<3, kBias>(kBias, 0).transpose();
  by_bias.bottomRows<kLocal - kBias>() = A_.block<kLocal - kBias, 3>(kBias, kBias);
  Matrix3d own = by_bias.middleRows<3>(kBias).selfadjointView<Eigen::Lower>();
  by_bias.middleRows<3>(kBias) = own;
  own.diagonal().array() += 1.0 / variance;
  const Matrix3d K = own.inverse();
  const Vector3d g_bias = g_.segment<3>(kBias);
  const Eigen::Matrix<double, kLocal, 3> gain = by_bias * K;
  A_.triangularView<Eigen::Lower>() -= gain * by_bias.transpose();
  g_ -= gain * g_bias;
  cost_ -= 0.5 * g_bias.dot(K * g_bias);
}

double ScanInformation::end() {
  flush();
  system_->add(state_, columns_, A_, g_);
  return cost_;
}

void ScanInformation::set_columns(int first, int count, int column) {
  for (int i = 0; i < count; ++i) {
    columns_[static_cast<std::size_t>(first) + static_cast<std::size_t>(i)] =
        column < 0 ? -1 : column + i;
  }
}

void ScanInformation::undo(const StepBack& step, int row) {
  if (step.seconds == 0.0) return;
  auto J = J_.col(row);
  const Vector3d phi = J.segment<3>(body::kAttitude);
  const Vector3d v = J.segment<3>(body::kVelocity);
  J.segment<3>(body::kAttitude) = step.attitude.transpose() * phi + step.velocity.transpose() * v;
  J.segment<3>(body::kGyroBias) += step.bias.transpose() * phi;
  J.segment<3>(body::kVelocity) -= step.seconds * J.segment<3>(body::kPosition);
}

void ScanInformation::add_landmark(int column, int first, int count) {
  Eigen::Matrix<double, 3, kLocal> A_ly = Eigen::Matrix<double, 3, kLocal>::Zero();
  Matrix3d A_ll = Matrix3d::Zero();
  Vector3d g_l = Vector3d::Zero();
  for (int i = first; i < first + count; ++i) {
    A_ly += L_.col(i) * J_.col(i).transpose();
    A_ll += L_.col(i) * L_.col(i).transpose();
    g_l += L_.col(i) * r_[i];
  }
  system_->add_coupled(state_, column, columns_, A_ll, A_ly, g_l);
}

void ScanInformation::flush() {
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

}  // namespace rio
