// SPDX-License-Identifier: BSD-3-Clause
#include "rio/smoother/prior.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "rio/core/symmetric.hpp"
#include "rio/state/calibration.hpp"
#include "rio/update/look_correlation.hpp"

namespace rio {

namespace {

/// In place, on the leading n unknowns of a quadratic x^T A x / 2 - g^T x: new unknowns y, x = B y
/// with B = I except for the 3x3 block `own` at `at`:  A <- B^T A B, g <- B^T g. Only the lower
/// triangle of the symmetric A is read and valid afterwards.
void multiply_block(int n, int at, const Matrix3d& own, Eigen::MatrixXd* A, Eigen::VectorXd* g) {
  auto columns = A->block(at, at, n - at, 3);
  for (int r = 0; r < columns.rows(); ++r) columns.row(r) = (columns.row(r) * own).eval();
  for (int c = 0; c < at + 3; ++c) {
    A->block<3, 1>(at, c) = (own.transpose() * A->block<3, 1>(at, c)).eval();
  }
  g->segment<3>(at) = (own.transpose() * g->segment<3>(at)).eval();
}

/// Of the unknowns that one product takes together.
using PanelVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, cholesky::kPanel, 1>;

}  // namespace

Prior::Prior(const Layout& layout, int max_states)
    : layout_(layout),
      g_(Eigen::VectorXd::Zero(body::kSize * (max_states - 1) + layout.capacity())),
      A_(Eigen::MatrixXd::Zero(g_.size(), g_.size())),
      work_(A_),
      work_g_(g_),
      xi_(g_),
      w_(g_),
      A_xi_(g_) {
  states_.reserve(static_cast<std::size_t>(max_states));
  pending_walk_.fill(Vector3d::Zero());
}

void Prior::assign(const Eigen::Ref<const Eigen::MatrixXd>& A,
                   const Eigen::Ref<const Eigen::VectorXd>& g, const Window& window,
                   std::size_t first, int leading, const Estimate& x) {
  states_.clear();
  for (int s = 0; s < leading; ++s) {
    states_.push_back(window[first + static_cast<std::size_t>(s)].nav);
  }
  std::fill(pending_walk_.begin() + static_cast<std::ptrdiff_t>(landmarks_.size()),
            pending_walk_.end(), Vector3d::Zero());
  landmarks_ = x.landmarks;
  for (std::size_t r = 0; r < layout_.radars(); ++r) radars_[r] = x.of_radar(r);
  auxiliary_ = x.auxiliary;
  A_.topLeftCorner(size(), size()) = A;
  g_.head(size()) = g;
  for (int s = 0; s < leading; ++s) {  // the inverse of (E4) where xi = 0
    const Matrix3d R = states_[static_cast<std::size_t>(s)].q_WB.toRotationMatrix();
    multiply_block(size(), body::kSize * s + body::kAttitude, R.transpose(), &A_, &g_);
  }
  mirror_lower(A_.topLeftCorner(size(), size()));
  xi_.head(size()).setZero();
  fill_heading_part(window, first, x, Matrix3d::Identity());
  w_ *= -1.0;
  add_heading_part(&A_, &g_);
}

double Prior::add_to(NormalEquations* system, const Window& window, const Estimate& x) {
  evaluate(window, x);
  const int n = size();
  auto xi = xi_.head(n);
  A_xi_.head(n).noalias() = A() * xi;
  const double cost = 0.5 * xi.dot(A_xi_.head(n)) - g().dot(xi);
  work_.topLeftCorner(n, n) = A();
  work_g_.head(n) = g() - A_xi_.head(n);
  const Matrix3d Zt = gamma(0, -heading() * Vector3d::UnitZ());
  fill_heading_part(window, 0, x, Zt);
  add_heading_part(&work_, &work_g_);
  for (int s = 0; s < leading_states(); ++s) {
    const Matrix3d R = window[static_cast<std::size_t>(s)].nav.q_WB.toRotationMatrix();
    multiply_block(n, body::kSize * s + body::kAttitude, turn_jacobian(s).inverse() * Zt * R,
                   &work_, &work_g_);
  }
  turn_back(heading());
  for (std::size_t r = 0; layout_.has_extrinsics() && r < layout_.radars(); ++r) {
    const int at = border(layout_.of_radar(r).extrinsics());
    multiply_block(n, at, gamma(1, -xi.segment<3>(at)).inverse(), &work_, &work_g_);
  }
  system->add_quadratic(leading_states(), work_.topLeftCorner(n, n), work_g_.head(n));
  return cost;
}

void Prior::add_landmark_noise(const Estimate& x, const Vector3d& p_WB, double walk,
                               double distance) {
  if (!(walk * distance > 0.0) || landmarks_.empty()) return;
  constexpr std::size_t kTogether = cholesky::kPanel / Landmark::kDof;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    pending_walk_[i] += landmark_walk(x.landmarks[i], p_WB, walk, distance);
  }
  if (turn_ >= landmarks_.size()) turn_ = 0;
  const std::size_t first = turn_;
  turn_ = std::min(first + kTogether, landmarks_.size());
  PanelVector inverse(Landmark::kDof * static_cast<Eigen::Index>(turn_ - first));
  for (std::size_t i = first; i < turn_; ++i) {
    inverse.segment<3>(3 * static_cast<Eigen::Index>(i - first)) = pending_walk_[i].cwiseInverse();
    pending_walk_[i].setZero();
  }
  add_noise(landmark(first), inverse);
}

void Prior::add_parameter_noise(const Eigen::VectorXd& walk, double seconds) {
  if (!(walk.sum() * seconds > 0.0)) return;
  constexpr double kNothing = 1e-30;  // of those that do not walk
  const int count = static_cast<int>(walk.size());
  for (int first = 0; first < count; first += cholesky::kPanel) {
    const int width = std::min(cholesky::kPanel, count - first);
    const PanelVector inverse =
        (seconds * walk.segment(first, width)).cwiseMax(kNothing).cwiseInverse();
    add_noise(border(body::kSize + first), inverse);
  }
}

// (A^-1 + E C E^T)^-1 = A - A E (C^-1 + E^T A E)^-1 E^T A with C^-1 = diag(inverse), of the
// unknowns E (Woodbury 1950). No effect if C^-1 + E^T A E is not positive definite: A has no
// information about E.
void Prior::add_noise(int at, const Eigen::Ref<const Eigen::VectorXd>& inverse) {
  const int n = size();
  const auto width = static_cast<int>(inverse.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, cholesky::kPanel, cholesky::kPanel> L =
      A_.block(at, at, width, width);
  auto W = work_.topLeftCorner(n, width);
  W = A_.middleCols(at, width).topRows(n);  // A E
  L.diagonal() += inverse;
  if (!factorise_in_place(L)) return;
  cholesky::divide_right(L, W);
  auto y = work_.col(width).head(width);
  y = g_.segment(at, width);
  L.triangularView<Eigen::Lower>().solveInPlace(y);
  A_.topLeftCorner(n, n).selfadjointView<Eigen::Lower>().rankUpdate(W, -1.0);
  mirror_lower(A_.topLeftCorner(n, n));
  g_.head(n).noalias() -= W * y;
}

void Prior::consider(const Eigen::VectorXd& variances) {
  if (!layout_.has_elevation_error()) return;
  constexpr double kNothing = 1e-9;  // information of landmarks that the prior does not know
  const int n = size();
  auto L = work_.topLeftCorner(n, n);
  L = A();
  L.diagonal().array() += kNothing;
  if (!factorise_in_place(L)) return;
  auto whitened = work_g_.head(n);  // L^-1 g
  whitened = g();
  L.triangularView<Eigen::Lower>().solveInPlace(whitened);
  for (std::size_t r = 0; r < layout_.radars(); ++r) {
    const int column = layout_.of_radar(r).elevation_error();
    const int at = border(column);
    auto part = A_xi_.head(n);  // L^-1 e: its square is the variance, its product the mean
    part.setZero();
    part[at] = 1.0;
    L.triangularView<Eigen::Lower>().solveInPlace(part);
    const double mean = radars_[r].elevation_error + part.dot(whitened);
    const double noise = variances[column - body::kSize] - part.squaredNorm();
    part = A_.col(at).head(n);
    const double share = noise > 0.0 ? 1.0 / (1.0 / noise + part[at]) : 0.0;
    A_.topLeftCorner(n, n).selfadjointView<Eigen::Lower>().rankUpdate(part, -share);
    mirror_lower(A_.topLeftCorner(n, n));
    g_.head(n) -= (share * g_[at] + mean * (1.0 - share * part[at])) * part;
  }
}

void Prior::remove_landmark(std::size_t i, std::size_t last) {
  if (i >= landmarks_.size()) return;
  const int at = landmark(i);
  const Vector3d infinite = Vector3d::Zero();
  add_noise(at, infinite);
  // the window's last landmark moves to i; the prior's own last one may be an earlier one
  const std::size_t own_last = landmarks_.size() - 1;
  const int n = size();
  if (last != own_last) {  // another landmark takes the place: no information about it
    A_.middleRows(at, 3).leftCols(n).setZero();
    A_.middleCols(at, 3).topRows(n).setZero();
    g_.segment<3>(at).setZero();
    pending_walk_[i].setZero();
    return;
  }
  if (i != own_last) {
    const int source = landmark(own_last);
    A_.block(at, 0, 3, n) = A_.block(source, 0, 3, n);
    A_.block(0, at, n, 3) = A_.block(0, source, n, 3);
    g_.segment<3>(at) = g_.segment<3>(source);
    landmarks_[i] = landmarks_[own_last];
    pending_walk_[i] = pending_walk_[own_last];
  }
  landmarks_.pop_back();
}

void Prior::evaluate(const Window& window, const Estimate& x) {
  const Quaternion turn = window[0].nav.q_WB * states_[0].q_WB.conjugate();
  const Quaternion back = Quaternion(turn.w(), 0.0, 0.0, -turn.z()).normalized();  // Z^T
  for (int s = 0; s < leading_states(); ++s) {
    const NavState& then = states_[static_cast<std::size_t>(s)];
    const NavState& now = window[static_cast<std::size_t>(s)].nav;
    auto xi = xi_.segment<body::kSize>(body::kSize * s);
    xi.segment<3>(body::kAttitude) = quaternion_log(back * now.q_WB * then.q_WB.conjugate());
    xi.segment<3>(body::kPosition) = back * now.p_WB - then.p_WB;
    xi.segment<3>(body::kVelocity) = back * now.v_WB - then.v_WB;
    xi.segment<3>(body::kGyroBias) = now.gyro_bias - then.gyro_bias;
    xi.segment<3>(body::kAccelBias) = now.accel_bias - then.accel_bias;
  }
  xi_[kHeading] = -quaternion_log(back).z();
  for (std::size_t r = 0; r < layout_.radars(); ++r) {
    const Layout layout = layout_.of_radar(r);
    const CalibrationVector moved = corrections_between(radars_[r], x.of_radar(r));
    for (int i = 0; i < moved.size(); ++i) {
      const int column = calibration_column(layout, i);
      if (column >= 0) xi_[border(column)] = moved[i];
    }
    if (layout.has_elevation_error()) {
      xi_[border(layout.elevation_error())] =
          x.of_radar(r).elevation_error - radars_[r].elevation_error;
    }
  }
  xi_.segment(border(layout_.auxiliary()), layout_.auxiliary_size()) =
      (x.auxiliary - auxiliary_).head(layout_.auxiliary_size());
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    xi_.segment<3>(landmark(i)) = back * x.landmarks[i].p_W - landmarks_[i].p_W;
  }
}

Matrix3d Prior::turn_jacobian(int s) const {
  Vector3d phi = xi_.segment<3>(body::kSize * s + body::kAttitude);
  if (s > 0) return gamma(1, phi);
  phi.z() = 0.0;
  Matrix3d J = gamma(1, phi);
  J.col(2) = Vector3d::UnitZ();
  return J;
}

void Prior::fill_heading_part(const Window& window, std::size_t first, const Estimate& x,
                              const Matrix3d& Zt) {
  const Vector3d z = Vector3d::UnitZ();
  w_.head(size()).setZero();
  for (int s = 0; s < leading_states(); ++s) {
    const NavState& now = window[first + static_cast<std::size_t>(s)].nav;
    auto w = w_.segment<body::kSize>(body::kSize * s);
    if (s > 0) w.segment<3>(body::kAttitude) = -turn_jacobian(s).inverse() * z;
    w.segment<3>(body::kPosition) = -z.cross(Zt * now.p_WB);
    w.segment<3>(body::kVelocity) = -z.cross(Zt * now.v_WB);
  }
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    w_.segment<3>(landmark(i)) = -z.cross(Zt * x.landmarks[i].p_W);
  }
}

void Prior::add_heading_part(Eigen::MatrixXd* A, Eigen::VectorXd* g) {
  const int n = size();
  const auto w = w_.head(n);
  auto A_w = A_xi_.head(n);
  A_w.noalias() = A->topLeftCorner(n, n) * w;
  const double w_A_w = w.dot(A_w);
  A->col(kHeading).head(n) += A_w;
  A->row(kHeading).head(n) += A_w.transpose();
  (*A)(kHeading, kHeading) += w_A_w;
  (*g)[kHeading] += w.dot(g->head(n));
}

void Prior::turn_back(double heading) {
  const double cosine = std::cos(heading);
  const double sine = std::sin(heading);
  const auto turn = [&](double* x, double* y) {  // the columns of Z^T are the rows of Z
    const double x_before = *x;
    *x = cosine * x_before - sine * *y;
    *y = sine * x_before + cosine * *y;
  };
  const int n = size();
  const auto for_each_turned = [&](const auto& f) {  // each block that is a vector in W
    for (int s = 0; s < leading_states(); ++s) {
      f(body::kSize * s + body::kPosition);
      f(body::kSize * s + body::kVelocity);
    }
    for (int at = landmark(0); at < n; at += Landmark::kDof) f(at);
  };
  for_each_turned([&](int at) {
    for (int r = at; r < n; ++r) turn(&work_(r, at), &work_(r, at + 1));
    turn(&work_g_[at], &work_g_[at + 1]);
  });
  for (int c = 0; c < n; ++c) {
    for_each_turned([&](int at) {
      if (c < at + 2) turn(&work_(at, c), &work_(at + 1, c));
    });
  }
}

}  // namespace rio
