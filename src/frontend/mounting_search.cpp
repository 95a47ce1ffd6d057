// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/mounting_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "rio/core/small_cholesky.hpp"
#include "rio/core/so3.hpp"
#include "rotation_fit.hpp"

namespace rio {

namespace {

constexpr double kLasting = 0.08;    // error of a scene's directions (data/theory.md, 12) [rad]
constexpr double kLastingFor = 2.0;  // [s]
constexpr double kTurning = 10.0;    // in which the heading may turn the accelerometer bias [s]
constexpr double kExact = 1e-6;      // sigma of what is not estimated, SI units
constexpr double kMoving = 0.2;      // slower tells no direction [m/s]
constexpr double kVague = 0.5;       // sigma of a scan's velocity that tells none [m/s]
constexpr double kLinear =
    0.25;                        // sigma from which updates refine a mounting: 1 - cos is 3 % [rad]
constexpr double kOther = 0.35;  // minima farther apart are two mountings [rad]
constexpr double kTold = 9.0;    // difference of chi-squared that tells them apart
constexpr double kLeast = 2.0;   // motion before a solution: errors of directions last as long [s]
constexpr double kPatience = 5.0;         // motion after which an axis is not shown any more [s]
constexpr double kPatienceInClimb = 7.5;  // same, of the vertical axis: a climb ends [s]
constexpr double kSteep = 0.7;            // sine of 45 deg
constexpr double kEvery = 0.5;            // of motion between solutions [s]

using Block = MountingSearch::Block;

/// A^-1 b
Block solve(const Block& A, const Block& b) {
  return Eigen::LDLT<Block>(A).solve(b);
}

/// Elimination of all but the first n unknowns of M.
struct Schur {
  Eigen::LDLT<Block> rest;  ///< M_rr
  Block complement;         ///< M_nn - M_nr M_rr^-1 M_rn
  Block gain;               ///< M_rr^-1 M_rn

  Schur(const Block& M, Eigen::Index n)
      : rest(Block(M.bottomRightCorner(M.rows() - n, M.rows() - n))) {
    const Block cross = M.bottomLeftCorner(M.rows() - n, n);
    gain = rest.solve(cross);
    complement = M.topLeftCorner(n, n) - dot(cross, gain);
  }
};

/// The velocity of a scan without the shrinkage by the noise N of its directions (errors in
/// variables, ego_velocity.hpp (E4)): (A - N)^-1 A v; none if they are as noisy as they are spread.
/// @param speed by which they turn into noise [m/s]: not that of the scan, since weights that know
///        its noise would prefer short velocities
std::optional<RadarVelocity> unshrunk(const DetectionList& scan, const EgoVelocity& velocity,
                                      double speed) {
  Matrix3d A = Matrix3d::Zero();
  Matrix3d noise = Matrix3d::Zero();
  Matrix3d weighted = Matrix3d::Zero();
  for (std::size_t i = 0; i < scan.items.size(); ++i) {
    if (!velocity.inlier[i]) continue;
    const Detection& d = scan.items[i];
    const Matrix3d square = d.direction_S * d.direction_S.transpose();
    const Matrix3d of_direction = direction_covariance(d);
    A += square;
    noise += of_direction;
    weighted +=
        (d.sigma_doppler * d.sigma_doppler + 0.5 * speed * speed * of_direction.trace()) * square;
  }
  const SmallCholesky<3> root(A - noise);
  if (!root.positive()) return std::nullopt;
  const Matrix3d inverse = root.inverse();
  return RadarVelocity{inverse * (A * velocity.v_S), inverse * weighted * inverse};
}

bool cheaper(const RotationMinimum& a, const RotationMinimum& b) {
  return a.cost < b.cost;
}

}  // namespace

MountingSearch::MountingSearch(const Options& options)
    : configured_(options.radar.T_BS),
      priors_(options.calibration),
      gravity_(options.imu.gravity),
      doppler_scale_(1.0 + options.radar.doppler_scale),
      ransac_(options.frontend, options.frontend.unwrap_doppler ? options.radar.max_doppler : 0.0) {
  reset();
}

void MountingSearch::reset() {
  const Vector3d& p = configured_.translation;
  const double sigma = std::max(priors_.translation_sigma, kExact);
  Block A = Block::Zero(3, kSize);
  A.middleCols<3>(kLever).diagonal().setConstant(1.0 / sigma);
  A.col(kOne) = -p / sigma;
  sum_ = dot(A, A);
  last_.reset();
  expected_ = motion_ = solved_ = 0.0;
}

void MountingSearch::restart_drift() {
  if (!last_) return;
  const Block kept = Schur(sum_, kKept).complement;
  sum_.setZero();
  sum_.topLeftCorner(kKept, kKept) = kept;
  last_.reset();
}

std::optional<Mounting> MountingSearch::add(const DetectionList& scan, const Estimate& x,
                                            const BodyCovariance& P) {
  const double dt = advance(x, P);
  ransac_.estimate(scan, std::nullopt, &velocity_);
  if (dt > 0.0 && velocity_.valid && velocity_.covariance) {
    const auto velocity = unshrunk(scan, velocity_, x.nav.v_WB.norm());
    const Vector3d& v_S = velocity ? velocity->v_S : velocity_.v_S;
    if (v_S.norm() > kMoving) motion_ += std::min(dt, kEvery);
    if (velocity) accumulate(*velocity, x, dt);
  }
  if (motion_ < kLeast || motion_ < solved_ + kEvery) return std::nullopt;
  solved_ = motion_;
  return solve(x.nav.q_WB.toRotationMatrix());
}

double MountingSearch::advance(const Estimate& x, const BodyCovariance& P) {
  const Matrix3d R_WB = x.nav.q_WB.toRotationMatrix();
  if (!last_) {
    Block J = Block::Zero(kDrift, body::kSize);  // of (e, d, a) by the error of the body
    J.block<3, 3>(0, body::kPosition).setIdentity();
    J.block<3, 3>(3, body::kVelocity).setIdentity();
    J.block<3, 3>(6, body::kAttitude) = -gravity_ * skew(Vector3d::UnitZ()) * R_WB;
    J.block<3, 3>(6, body::kAccelBias) = -R_WB;
    Block covariance = J * Block(P) * J.transpose();
    covariance.diagonal().array() += kExact * kExact;  // an exact start has none
    sum_.bottomRightCorner(kDrift, kDrift) =
        rio::solve(covariance, Block::Identity(kDrift, kDrift));
    last_ = x.nav.time;
    return 0.0;
  }
  const double dt = to_seconds(x.nav.time - *last_);
  last_ = x.nav.time;
  if (!(dt > 0.0)) return 0.0;
  Block F = Block::Identity(kDrift, kDrift);
  F.block<3, 3>(0, 3).diagonal().setConstant(dt);
  F.block<3, 3>(3, 6).diagonal().setConstant(dt);
  const double noise = std::max(kExact * kExact, x.accel_density) * dt;
  Eigen::Matrix<double, kDrift, 1> information;  // of the noise of (E2)
  information.head<3>().setConstant(3.0 / (noise * dt * dt));
  information.segment<3>(3).setConstant(1.0 / noise);
  const Matrix3d bias = R_WB * P.block<3, 3>(body::kAccelBias, body::kAccelBias) * R_WB.transpose();
  const double level = std::max(bias(0, 0), bias(1, 1));  // the heading turns it
  information.tail<3>() =
      (kTurning / dt) *
      (Vector3d(level, level, bias(2, 2)).array() + kExact * kExact).inverse().matrix();
  const Block to_next = information.asDiagonal() * F;
  sum_.bottomRightCorner(kDrift, kDrift) += dot(F, to_next);
  const Schur past(sum_, kKept);
  const Block from_next = past.rest.solve(Block(to_next.transpose()));
  sum_.topLeftCorner(kKept, kKept) = past.complement;
  const Block cross = to_next * past.gain;
  sum_.bottomLeftCorner(kDrift, kKept) = cross;
  sum_.topRightCorner(kKept, kDrift) = cross.transpose();
  sum_.bottomRightCorner(kDrift, kDrift) = -to_next * from_next;
  sum_.diagonal().segment<kDrift>(kKept) += information;
  return dt;
}

void MountingSearch::accumulate(const RadarVelocity& velocity, const Estimate& x, double dt) {
  const double white = velocity.covariance.trace() / 3.0;
  if (white > kVague * kVague) return;
  const Vector3d v_S = velocity.v_S / doppler_scale_;
  const double lasting = kLasting * kLasting * x.nav.v_WB.squaredNorm();
  const double weight = 1.0 / (white + lasting * std::max(1.0, kLastingFor / dt));
  expected_ += 3.0 * weight * (white + lasting);

  const Matrix3d R_BW = x.nav.q_WB.conjugate().toRotationMatrix();
  Block A = Block::Zero(3, kSize);
  for (int i = 0; i < 3; ++i) {
    A.middleCols<3>(kRotation + 3 * i).diagonal().setConstant(v_S[i]);
  }
  A.middleCols<3>(kLever) = -skew(x.gyro_B - x.nav.gyro_bias);
  A.col(kOne) = -R_BW * x.nav.v_WB;
  A.middleCols<3>(kVelocity) = -R_BW;
  A *= std::sqrt(weight);
  sum_ += dot(A, A);
}

std::optional<Mounting> MountingSearch::solve(const Matrix3d& R_WB) const {
  const Schur rotation(sum_, kLever);  // without p, e, d, a
  RotationCost cost;
  cost.M = rotation.complement;
  cost.prior = configured_.rotation.toRotationMatrix();
  cost.prior_information = 1.0 / (priors_.rotation_sigma * priors_.rotation_sigma);

  const std::array<RotationMinimum, 24> all = rotation_minima(cost);
  RotationMinimum best = *std::min_element(all.begin(), all.end(), cheaper);
  const double excess = std::max(1.0, best.cost / expected_);
  const double bound = best.cost + kTold * excess;
  for (const RotationMinimum& m : all) {
    const bool nearer = cost.offset(m.R).norm() < cost.offset(best.R).norm();
    if (m.cost < bound && nearer) best = m;
  }
  const bool alone = std::none_of(all.begin(), all.end(), [&](const RotationMinimum& m) {
    return m.cost < bound && turn_between(best.R, m.R).norm() > kOther;
  });

  constexpr int kLinearPart = kSize - kLever;
  constexpr int kAll = 3 + kLinearPart;  // phi, p, e, d, a
  Block J = Block::Zero(kSize, kAll);
  J.topLeftCorner(kLever, 3) = stacked_jacobian(best.R);
  J.bottomRightCorner(kLinearPart, kLinearPart).setIdentity();
  Block information = dot(J, sum_ * J);
  information.diagonal().head<3>().array() += cost.prior_information;
  Mounting found;
  found.covariance = excess * rio::solve(information, Block::Identity(kAll, 12)).topRows(12);
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(found.covariance.topLeftCorner<3, 3>());
  const Vector3d sigmas = axes.eigenvalues().cwiseSqrt();
  const bool shown = alone && sigmas[2] < kLinear;
  const Vector3d axis = axes.eigenvectors().col(2);
  const bool steep = std::abs((R_WB * (best.R * axis)).z()) > kSteep;
  const double patience = steep ? kPatienceInClimb : kPatience;
  if (sigmas[1] > kLinear || (!shown && motion_ < patience)) return std::nullopt;
  if (!shown) {  // the axis that the motion does not show: as configured
    const Matrix3d scale =
        Matrix3d::Identity() + (kLinear / sigmas[2] - 1.0) * axis * axis.transpose();
    found.covariance.topRows<3>() =
        scale * Eigen::Matrix<double, 3, 12>(found.covariance.topRows<3>());
    found.covariance.leftCols<3>() =
        Eigen::Matrix<double, 12, 3>(found.covariance.leftCols<3>()) * scale;
  }
  const Block x = -rotation.gain * stacked(best.R, 1.0);
  found.T_BS = {Quaternion(best.R), x.topRows<3>()};
  found.position_error_W = x.middleRows<3>(3);
  found.velocity_error_W = x.middleRows<3>(6);
  return found;
}

}  // namespace rio
