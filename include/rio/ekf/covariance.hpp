// SPDX-License-Identifier: BSD-3-Clause
// Stages 1, 2, 6, 7: the covariance P of the whole error state. The only file that edits P.
//
// (E1) propagate: P_bb <- Phi P_bb Phi^T + Q, P_bx <- Phi P_bx              (ICRA 2023, eq. 7)
// (E2) clone:     rows and columns of the body pose are copied               (ibid., eq. 5)
// (E3) landmark:  P_ll = H P H^T + N, P_lx = H P                              (ibid., eq. 10-11)
// (E4) update:    W = P H^T L^-T, S = H P H^T + R = L L^T, P <- P - W W^T, in panels of rows
// (E5) re-express: P <- M P M^T, so that the right-invariant error does not change when the
// estimate
//      does: yaw and position about the world stay unobservable (Hao, Tian and He 2025)
// (E6) re-open:   P <- P + G V G^T, G = [tau I; I] on position and velocity
// ICRA 2023 is Michalczyk et al., ICRA 2023. Nothing here allocates after construction. Clones make
// P singular by design: it is never factorised.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <type_traits>

#include "rio/propagate/strapdown.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/gate.hpp"
#include "rio/update/linear_rows.hpp"

namespace rio {

class Covariance {
 public:
  explicit Covariance(const Layout& layout)
      : layout_(layout),
        P_(Eigen::MatrixXd::Zero(layout.capacity(), layout.capacity())),
        backup_(P_),
        W_(Eigen::MatrixXd::Zero(layout.capacity(), kPanel)),
        scratch_(Eigen::MatrixXd::Zero(body::kSize, layout.capacity())),
        size_(layout.size(0)) {}

  int size() const { return size_; }
  /// The whole covariance, symmetric to the last bit.
  Eigen::Ref<const Eigen::MatrixXd> matrix() const { return P_.topLeftCorner(size_, size_); }
  auto body() const { return P_.topLeftCorner<body::kSize, body::kSize>(); }

  /// Body block and extrinsics prior; no clones, no landmarks.
  void reset(const BodyCovariance& P0, const UpdateOptions& options) {
    P_.setZero();
    size_ = layout_.size(0);
    P_.topLeftCorner<body::kSize, body::kSize>() = 0.5 * (P0 + P0.transpose());
    if (layout_.has_extrinsics()) {
      const double rotation = options.extrinsic_rotation_sigma;
      const double translation = options.extrinsic_translation_sigma;
      P_.diagonal().segment<3>(layout_.extrinsics()).setConstant(rotation * rotation);
      P_.diagonal().segment<3>(layout_.extrinsics() + 3).setConstant(translation * translation);
    }
  }

  void propagate(const Matrix15d& phi, const Matrix15d& noise) {  // (E1)
    constexpr int kBody = body::kSize;
    const int rest = size_ - kBody;
    const Matrix15d propagated = phi * P_.topLeftCorner<kBody, kBody>() * phi.transpose() + noise;
    P_.topLeftCorner<kBody, kBody>() = 0.5 * (propagated + propagated.transpose());
    auto cross = scratch_.leftCols(rest);
    cross.noalias() = phi * P_.block(0, kBody, kBody, rest);
    P_.block(0, kBody, kBody, rest) = cross;
    P_.block(kBody, 0, rest, kBody) = cross.transpose();
  }

  /// The velocity turns out to be uncertain by `variance` [m^2/s^2] per axis since `duration` [s].
  void reopen_velocity(double variance, double duration) {  // (E6)
    for (int i = 0; i < 3; ++i) {
      const int p = body::kPosition + i;
      const int v = body::kVelocity + i;
      P_(v, v) += variance;
      P_(p, v) += duration * variance;
      P_(v, p) += duration * variance;
      P_(p, p) += duration * duration * variance;
    }
  }

  /// Whatever pose was in `slot` is marginalised.
  void clone_body_pose(int slot) {  // (E2)
    const int at = layout_.clone(slot);
    P_.block(at, 0, 6, size_) = P_.block(body::kAttitude, 0, 6, size_);
    P_.block(0, at, size_, 6) = P_.block(0, body::kAttitude, size_, 6);
  }

  /// Appends landmark `index` (the number of landmarks so far).
  /// @param noise covariance of the landmark given the state [m^2]
  void add_landmark(int index, const Eigen::Matrix<double, 3, 6>& d_l_d_body,
                    const Eigen::Matrix<double, 3, 6>& d_l_d_extrinsics, const Matrix3d& noise) {
    const int at = layout_.landmark(index);
    RIO_ASSERT(at == size_ && at + 3 <= layout_.capacity());
    auto row = scratch_.topRows<3>().leftCols(at);  // (E3)
    row.noalias() = d_l_d_body * P_.block(body::kAttitude, 0, 6, at);
    if (layout_.has_extrinsics()) {
      row.noalias() += d_l_d_extrinsics * P_.block(layout_.extrinsics(), 0, 6, at);
    }
    Matrix3d own = noise + row.middleCols<6>(body::kAttitude) * d_l_d_body.transpose();
    if (layout_.has_extrinsics()) {
      own += row.middleCols<6>(layout_.extrinsics()) * d_l_d_extrinsics.transpose();
    }
    P_.block(at, 0, 3, at) = row;
    P_.block(0, at, at, 3) = row.transpose();
    P_.block<3, 3>(at, at) = 0.5 * (own + own.transpose());
    size_ = at + 3;
  }

  /// Landmark `index` leaves; the last one takes its place.
  void remove_landmark(int index) {
    const int at = layout_.landmark(index);
    const int last = size_ - 3;
    if (at != last) {
      P_.block(at, 0, 3, size_) = P_.block(last, 0, 3, size_);
      P_.block(0, at, size_, 3) = P_.block(0, last, size_, 3);
    }
    size_ = last;
  }

  /// Every landmark walks by this variance per axis [m^2].
  void add_landmark_noise(double variance) {
    P_.diagonal().segment(layout_.landmark(0), size_ - layout_.landmark(0)).array() += variance;
  }

  /// Covariance of landmark `index` relative to the radar, given the derivatives of that position.
  Matrix3d landmark_in_radar(int index, const Eigen::Matrix<double, 3, 6>& d_e_d_body,
                             const Eigen::Matrix<double, 3, 6>& d_e_d_extrinsics,
                             const Matrix3d& d_e_d_l) const {
    const int at = layout_.landmark(index);
    // J times the columns of one block; fixed sizes, so that nothing is allocated
    const auto columns = [&](int column, auto length) {
      constexpr int kLength = decltype(length)::value;
      Eigen::Matrix<double, 3, kLength> JP =
          d_e_d_body * P_.block<6, kLength>(body::kAttitude, column);
      JP += d_e_d_l * P_.block<3, kLength>(at, column);
      if (layout_.has_extrinsics()) {
        JP += d_e_d_extrinsics * P_.block<6, kLength>(layout_.extrinsics(), column);
      }
      return JP;
    };
    constexpr std::integral_constant<int, 3> kPoint;
    constexpr std::integral_constant<int, 6> kPose;
    Matrix3d S = columns(body::kAttitude, kPose) * d_e_d_body.transpose();
    S += columns(at, kPoint) * d_e_d_l.transpose();
    if (layout_.has_extrinsics()) {
      S += columns(layout_.extrinsics(), kPose) * d_e_d_extrinsics.transpose();
    }
    return 0.5 * (S + S.transpose());
  }

  /// h_a P h_b^T.
  double product(const LinearRow& a, const LinearRow& b) const {
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

  /// Innovation covariance of a block, at most Gate::kMaxDof rows.
  using BlockMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Gate::kMaxDof, Gate::kMaxDof>;
  void innovation_covariance(const RowBatch& batch, const RowBlock& block, BlockMatrix* S) const {
    const auto m = static_cast<Eigen::Index>(block.count);
    S->resize(m, m);
    for (Eigen::Index i = 0; i < m; ++i) {
      const LinearRow& row = batch.rows()[block.first + static_cast<std::size_t>(i)];
      (*S)(i, i) = product(row, row) + row.variance;
      for (Eigen::Index j = 0; j < i; ++j) {
        const LinearRow& other = batch.rows()[block.first + static_cast<std::size_t>(j)];
        (*S)(i, j) = (*S)(j, i) = product(row, other) + block.shared_variance;
      }
    }
  }

  /// All rows of the batch at once; `dx` is the correction. False, with P unchanged, if an
  /// innovation covariance is not positive definite or the result is not finite.
  bool update(const RowBatch& batch, Eigen::VectorXd* dx) {  // (E4)
    backup_.topLeftCorner(size_, size_) = P_.topLeftCorner(size_, size_);
    dx->head(size_).setZero();
    std::size_t block = 0;
    bool ok = true;
    while (ok && block < batch.blocks().size()) {
      const std::size_t begin = block;
      std::size_t rows = 0;
      while (block < batch.blocks().size() && rows + batch.blocks()[block].count <= kPanel) {
        rows += batch.blocks()[block++].count;
      }
      ok = update_panel(batch, begin, block, static_cast<Eigen::Index>(rows), dx);
    }
    ok = ok && dx->head(size_).allFinite() && P_.topLeftCorner(size_, size_).allFinite() &&
         P_.diagonal().head(size_).minCoeff() >= 0.0;
    if (!ok) P_.topLeftCorner(size_, size_) = backup_.topLeftCorner(size_, size_);
    return ok;
  }

  /// (E5): the errors of `before` re-expressed for `after`, the same state after a correction.
  ///   theta <- R+^T R- theta;  dp <- dp - [p+ - p-] R- theta, likewise v and landmarks; a clone's
  ///   own rotation error carries the clone.
  void reexpress(const Estimate& before, const Estimate& after) {
    auto P = P_.topLeftCorner(size_, size_);
    apply_reexpression(P, before, after);
    P.transposeInPlace();
    apply_reexpression(P, before, after);
    mirror_lower();
  }

 private:
  static constexpr int kPanel = 32;  // rows per rank update: the packing buffers stay on the stack

  bool update_panel(const RowBatch& batch, std::size_t first_block, std::size_t end_block,
                    Eigen::Index m, Eigen::VectorXd* dx) {
    const std::size_t first = batch.blocks()[first_block].first;
    auto W = W_.topLeftCorner(size_, m);
    Eigen::Matrix<double, kPanel, 1> innovation = Eigen::Matrix<double, kPanel, 1>::Zero();
    Eigen::Matrix<double, kPanel, kPanel> S = Eigen::Matrix<double, kPanel, kPanel>::Identity();
    for (Eigen::Index k = 0; k < m; ++k) {
      const LinearRow& row = batch.rows()[first + static_cast<std::size_t>(k)];
      auto w = W.col(k);
      w.setZero();
      innovation[k] = row.residual;
      row.for_each_segment([&](int column, const double* values, int length) {
        const Eigen::Map<const Eigen::VectorXd> h(values, length);
        w.noalias() += P_.block(0, column, size_, length) * h;
        innovation[k] -= h.dot(dx->segment(column, length));
      });
      for (Eigen::Index j = 0; j <= k; ++j) {  // S = H W, lower triangle
        double s = 0.0;
        row.for_each_segment([&](int column, const double* h, int length) {
          for (int i = 0; i < length; ++i) s += h[i] * W(column + i, j);
        });
        S(k, j) = s;
      }
    }
    Eigen::Index at = 0;
    for (std::size_t b = first_block; b < end_block; ++b) {
      const RowBlock& block = batch.blocks()[b];
      for (std::size_t i = 0; i < block.count; ++i) {
        const auto k = at + static_cast<Eigen::Index>(i);
        S(k, k) += batch.rows()[block.first + i].variance;
        for (Eigen::Index j = at; j < k; ++j) S(k, j) += block.shared_variance;
      }
      at += static_cast<Eigen::Index>(block.count);
    }
    const Eigen::LLT<Eigen::Ref<Eigen::Matrix<double, kPanel, kPanel>>> llt(S);
    if (llt.info() != Eigen::Success) return false;
    for (Eigen::Index k = 0; k < m; ++k) {  // W <- W L^-T, innovation <- L^-1 innovation
      const Eigen::Matrix<double, kPanel, 1> l = S.row(k).transpose();
      W.col(k).noalias() -= W.leftCols(k) * l.head(k);
      innovation[k] = (innovation[k] - l.head(k).dot(innovation.head(k))) / l[k];
      W.col(k) /= l[k];
    }
    for (Eigen::Index k = 0; k < m; ++k) dx->head(size_) += innovation[k] * W.col(k);
    P_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
    mirror_lower();
    return true;
  }

  void mirror_lower() {
    for (Eigen::Index c = 1; c < size_; ++c) {
      for (Eigen::Index r = 0; r < c; ++r) P_(r, c) = P_(c, r);
    }
  }

  /// P <- M P.
  template <class Matrix>
  void apply_reexpression(Matrix& P, const Estimate& before, const Estimate& after) const {
    const Matrix3d R_before = before.nav.q_WB.toRotationMatrix();
    const auto carry = [&P](int row, const Vector3d& shift, const Matrix3d& R, int theta) {
      const Matrix3d A = skew(shift) * R;
      for (Eigen::Index c = 0; c < P.cols(); ++c) {
        P.col(c).template segment<3>(row) -= A * P.col(c).template segment<3>(theta);
      }
    };
    const auto rotate = [&P](int theta, const Matrix3d& A) {
      for (Eigen::Index c = 0; c < P.cols(); ++c) {
        P.col(c).template segment<3>(theta) = (A * P.col(c).template segment<3>(theta)).eval();
      }
    };
    carry(body::kPosition, after.nav.p_WB - before.nav.p_WB, R_before, body::kAttitude);
    carry(body::kVelocity, after.nav.v_WB - before.nav.v_WB, R_before, body::kAttitude);
    for (std::size_t i = 0; i < before.landmarks.size(); ++i) {
      carry(layout_.landmark(static_cast<int>(i)), after.landmarks[i].p_W - before.landmarks[i].p_W,
            R_before, body::kAttitude);
    }
    rotate(body::kAttitude, after.nav.q_WB.toRotationMatrix().transpose() * R_before);
    for (std::size_t i = 0; i < before.clones.size(); ++i) {
      const RigidPose& from = before.clones[i].T_WB;
      const RigidPose& to = after.clones[i].T_WB;
      const int theta = layout_.clone(static_cast<int>(i));
      carry(theta + 3, to.p - from.p, from.R, theta);
      rotate(theta, to.R.transpose() * from.R);
    }
  }

  Layout layout_;
  Eigen::MatrixXd P_;
  Eigen::MatrixXd backup_;
  Eigen::MatrixXd W_;
  Eigen::MatrixXd scratch_;
  int size_;
};

}  // namespace rio
