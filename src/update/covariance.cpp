// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/covariance.hpp"

#include "rio/core/small_cholesky.hpp"
#include "rio/core/symmetric.hpp"

namespace rio {

Covariance::Covariance(const Layout& layout)
    : layout_(layout),
      P_(Eigen::MatrixXd::Zero(layout.capacity(), layout.capacity())),
      scratch_(Eigen::MatrixXd::Zero(body::kSize, layout.capacity())),
      size_(layout.size(0)) {}

void Covariance::reset(const BodyCovariance& P0, const Eigen::VectorXd& parameters) {
  P_.setZero();
  size_ = layout_.size(0);
  P_.topLeftCorner<body::kSize, body::kSize>() = 0.5 * (P0 + P0.transpose());
  P_.diagonal().segment(body::kSize, parameters.size()) = parameters;
}

void Covariance::propagate(const Matrix15d& phi, const Matrix15d& noise) {  // (E1)
  constexpr int kBody = body::kSize;
  const int rest = size_ - kBody;
  const Matrix15d propagated = congruence(phi, P_.topLeftCorner<kBody, kBody>()) + noise;
  P_.topLeftCorner<kBody, kBody>() = 0.5 * (propagated + propagated.transpose());
  constexpr int kMoving = body::kGyroBias;  // the biases are constant
  const Eigen::Matrix<double, kMoving, kBody> moving = phi.topRows<kMoving>();
  for (int c = kBody; c < kBody + rest; ++c) {
    Eigen::Matrix<double, kMoving, 1> cross = Eigen::Matrix<double, kMoving, 1>::Zero();
    for (int k = 0; k < kBody; ++k) cross += P_(k, c) * moving.col(k);
    P_.block<kMoving, 1>(0, c) = cross;
  }
  P_.block(kBody, 0, rest, kMoving) = P_.block(0, kBody, kMoving, rest).transpose();
}

void Covariance::replace(std::initializer_list<int> at,
                         const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  for (const int column : at) {
    P_.middleRows<3>(column).setZero();
    P_.middleCols<3>(column).setZero();
  }
  int i = 0;
  for (const int row : at) {
    int j = 0;
    for (const int column : at) {
      const Matrix3d block = covariance.block<3, 3>(i, j);
      P_.block<3, 3>(row, column) = 0.5 * (block + covariance.block<3, 3>(j, i).transpose());
      j += 3;
    }
    i += 3;
  }
}

void Covariance::assign_parameters(int at, const Eigen::Ref<const Eigen::MatrixXd>& by_body,
                                   const Eigen::Ref<const Eigen::MatrixXd>& noise) {
  const Eigen::Index n = by_body.rows();
  auto JP = scratch_.topLeftCorner(n, size_);
  for (int c = 0; c < size_; ++c) JP.col(c) = by_body.lazyProduct(P_.col(c).head<body::kSize>());
  JP.middleCols(at, n) = noise;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int k = 0; k < body::kSize; ++k) JP.col(at + i) += by_body(i, k) * JP.col(k);
  }
  P_.block(at, 0, n, size_) = JP;
  P_.block(0, at, size_, n) = JP.transpose();
  mirror_lower(P_.block(at, at, n, n));
}

void Covariance::inflate_velocity(double variance, double duration) {  // (E3)
  for (int i = 0; i < 3; ++i) {
    const int p = body::kPosition + i;
    const int v = body::kVelocity + i;
    P_(v, v) += variance;
    P_(p, v) += duration * variance;
    P_(v, p) += duration * variance;
    P_(p, p) += duration * duration * variance;
  }
}

void Covariance::measure_velocity(const Vector3d& residual_W, const Matrix3d& noise_W,
                                  Eigen::VectorXd* dx) {  // (E4)
  auto W = scratch_.topLeftCorner(3, size_);              // L^-1 P_v, S = L L^T
  W = P_.middleRows(body::kVelocity, 3).leftCols(size_);
  const Matrix3d S = P_.block<3, 3>(body::kVelocity, body::kVelocity) + noise_W;
  const Matrix3d inverse = SmallCholesky<3>(S).whitened(Matrix3d(Matrix3d::Identity()));  // L^-1
  for (int c = 0; c < size_; ++c) W.col(c) = (inverse * W.col(c)).eval();
  dx->setZero();
  dx->head(size_).noalias() = W.transpose() * (inverse * residual_W).eval();
  for (int c = 0; c < size_; ++c) {
    for (int r = 0; r <= c; ++r) P_(c, r) = P_(r, c) -= W.col(r).dot(W.col(c));
  }
}

template <int kRows>
void Covariance::assign(int at, const std::array<LinearRow, static_cast<std::size_t>(kRows)>& rows,
                        const Eigen::Matrix<double, kRows, kRows>& noise) {
  auto JP = scratch_.topLeftCorner(kRows, size_);
  JP.setZero();
  for (int i = 0; i < kRows; ++i) {
    rows[static_cast<std::size_t>(i)].for_each_segment(
        [&](int column, const double* h, int length) {
          for (int k = 0; k < length; ++k) JP.row(i) += h[k] * P_.row(column + k).head(size_);
        });
  }
  P_.block(at, 0, kRows, size_) = JP;
  P_.block(0, at, size_, kRows) = JP.transpose();
  for (int i = 0; i < kRows; ++i) {
    for (int j = 0; j <= i; ++j) {
      double own = noise(i, j);
      rows[static_cast<std::size_t>(j)].for_each_segment(
          [&](int column, const double* h, int length) {
            for (int k = 0; k < length; ++k) own += JP(i, column + k) * h[k];
          });
      P_(at + i, at + j) = P_(at + j, at + i) = own;
    }
  }
}

void Covariance::assign_clone(int slot, const std::array<LinearRow, 6>& rows) {
  assign<6>(layout_.clone(slot), rows, Eigen::Matrix<double, 6, 6>::Zero());
}

void Covariance::add_landmark([[maybe_unused]] int index, const std::array<LinearRow, 3>& rows,
                              const Matrix3d& noise) {
  RIO_ASSERT(layout_.landmark(index) == size_ && size_ + 3 <= layout_.capacity());
  size_ += 3;
  assign<3>(size_ - 3, rows, noise);
}

void Covariance::remove_landmark(int index) {
  const int at = layout_.landmark(index);
  const int last = size_ - 3;
  if (at != last) {
    P_.block(at, 0, 3, size_) = P_.block(last, 0, 3, size_);
    P_.block(0, at, size_, 3) = P_.block(0, last, size_, 3);
  }
  size_ = last;
}

double Covariance::product(const LinearRow& a, const LinearRow& b) const {
  double sum = 0.0;
  a.for_each_segment([&](int column_a, const double* h_a, int length_a) {
    b.for_each_segment([&](int column_b, const double* h_b, int length_b) {
      for (int j = 0; j < length_b; ++j) {
        const double* p = &P_(column_a, column_b + j);
        double dot = 0.0;
        for (int i = 0; i < length_a; ++i) dot += h_a[i] * p[i];
        sum += dot * h_b[j];
      }
    });
  });
  return sum;
}

double Covariance::product(const LinearRow& row, int column) const {
  double sum = 0.0;
  row.for_each_segment([&](int first, const double* h, int length) {
    sum += P_.col(column).segment(first, length).dot(Eigen::Map<const Eigen::VectorXd>(h, length));
  });
  return sum;
}

}  // namespace rio
