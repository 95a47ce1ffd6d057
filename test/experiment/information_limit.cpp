// SPDX-License-Identifier: BSD-3-Clause
// The error state is [body 15 | calibration 9 | landmarks 3 each], P its covariance.
//
// At the true state, with e the reflector in radar axes, r = |e|, u = e / r, v_S the velocity of
// the radar in its axes, t_az and t_el the unit tangents of the angles:
// (E1) e = R_BS^T (R_WB^T (l - p_WB) - p_BS),  v_S = R_BS^T (R_WB^T v_WB + w x p_BS)
// (E2) z = (r, t_az . u, t_el . u + elevation bias, -(1 + scale) u . v_S),  J = dz/dx, whitened
// (E3) dz/dt_d = -(J_phi w + J_p v_WB + J_v a_W): a late stamp is a shift along the motion
// (E4) known reflector:  P <- P - P J^T (J P J^T + I)^-1 J P
// (E5) new reflector, first three rows J_x dx + J_l dl + n = 0:  dl = -J_l^-1 (J_x dx + n); then
//      (E4) with its Doppler. Reference: Michalczyk et al. 2023, eq. 10-11.
// (E6) propagation: P_bb <- Phi P_bb Phi^T + Q, P_bx <- Phi P_bx
#include "experiment/information_limit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "rio/core/so3.hpp"
#include "rio/models/detection.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/static_alignment.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/state/blocks.hpp"
#include "rio/state/estimate.hpp"

namespace rio::experiment {

namespace {

constexpr int kBody = body::kSize;
constexpr int kRotation = kBody;         // of T_BS
constexpr int kTranslation = kBody + 3;  // same
constexpr int kDopplerScale = kBody + 6;
constexpr int kElevation = kBody + 7;
constexpr int kTimeOffset = kBody + 8;
constexpr int kCommon = kBody + 9;  // of all detections; the landmarks follow
constexpr int kRows = 4;            // of a detection: range, azimuth, elevation, Doppler

using Rows = Eigen::Matrix<double, kRows, kCommon + 3>;

/// (E2) of one detection; the last three columns are the landmark's.
class DetectionRows {
 public:
  DetectionRows(const sim::Trajectory::Point& truth, const Pose& T_BS)
      : truth_(truth), T_BS_(T_BS) {
    v_B_ = T_WB_.R.transpose() * truth.nav.v_WB;
    v_S_ = T_BS_.R.transpose() * (v_B_ + truth.gyro_B.cross(T_BS_.p));
  }

  Vector3d in_radar(const Vector3d& p_WL) const { return to_radar(T_WB_, T_BS_, p_WL); }

  /// @param noise of a detection at in_radar(p_WL)
  Rows operator()(const Vector3d& p_WL, const Detection& noise) const {
    const Vector3d& u = noise.direction_S;
    const double sigma_az = noise.sigma_azimuth_S.norm();
    const double sigma_el = noise.sigma_elevation_S.norm();
    Eigen::Matrix<double, kRows, 3> dz_de;
    dz_de.row(0) = u.transpose();
    dz_de.row(1) = noise.sigma_azimuth_S.transpose() / (sigma_az * noise.range);
    dz_de.row(2) = noise.sigma_elevation_S.transpose() / (sigma_el * noise.range);
    dz_de.row(3) = -(v_S_ - u.dot(v_S_) * u).transpose() / noise.range;
    Rows J = dz_de * d_point(p_WL);
    J.row(3) -= u.transpose() * d_velocity();
    J(3, kDopplerScale) = -u.dot(v_S_);
    J(2, kElevation) = 1.0;
    J.col(kTimeOffset) = -(J.middleCols<3>(body::kAttitude) * truth_.gyro_B +  // (E3)
                           J.middleCols<3>(body::kPosition) * truth_.nav.v_WB +
                           J.middleCols<3>(body::kVelocity) * truth_.accel_W);
    const Eigen::Vector4d sigma(noise.sigma_range, sigma_az, sigma_el, noise.sigma_doppler);
    return sigma.cwiseInverse().asDiagonal() * J;
  }

 private:
  using ThreeRows = Eigen::Matrix<double, 3, kCommon + 3>;

  /// de/dx.
  ThreeRows d_point(const Vector3d& p_WL) const {
    const Matrix3d R_SW = (T_WB_.R * T_BS_.R).transpose();
    ThreeRows d = ThreeRows::Zero();
    d.middleCols<3>(body::kAttitude) =
        T_BS_.R.transpose() * skew(T_WB_.R.transpose() * (p_WL - T_WB_.p));
    d.middleCols<3>(body::kPosition) = -R_SW;
    d.middleCols<3>(kRotation) = skew(in_radar(p_WL));
    d.middleCols<3>(kTranslation) = -T_BS_.R.transpose();
    d.middleCols<3>(kCommon) = R_SW;
    return d;
  }
  /// dv_S/dx.
  ThreeRows d_velocity() const {
    ThreeRows d = ThreeRows::Zero();
    d.middleCols<3>(body::kAttitude) = T_BS_.R.transpose() * skew(v_B_);
    d.middleCols<3>(body::kVelocity) = (T_WB_.R * T_BS_.R).transpose();
    d.middleCols<3>(body::kGyroBias) = T_BS_.R.transpose() * skew(T_BS_.p);
    d.middleCols<3>(kRotation) = skew(v_S_);
    d.middleCols<3>(kTranslation) = T_BS_.R.transpose() * skew(truth_.gyro_B);
    return d;
  }

  sim::Trajectory::Point truth_;
  RigidPose T_WB_{truth_.nav.q_WB.toRotationMatrix(), truth_.nav.p_WB};
  RigidPose T_BS_;
  Vector3d v_B_;
  Vector3d v_S_;
};

constexpr double kAllAlike = -200.0;  // of RadarOptions::weak_snr_db [dB]

/// The noise of a detection with true position `point_S`: that of the options at the true
/// direction, larger for weak echoes, with the grid of the angles and the wander of the reflector.
Detection noise_of(const Vector3d& point_S, double snr_db, const sim::RadarModel& model,
                   const RadarOptions& options) {
  const double weakness = std::pow(10.0, -0.1 * (snr_db - model.threshold_db));
  const double growth = std::sqrt(1.0 + model.weak_angle_growth * weakness);
  const double grid = model.angle_grid / std::sqrt(12.0);
  RadarOptions o = options;
  o.weak_snr_db = kAllAlike;  // the growth is that of the simulator
  o.sigma_azimuth = std::hypot(growth * o.sigma_azimuth, grid);
  o.sigma_elevation = std::hypot(growth * o.sigma_elevation, grid);
  Detection d = make_detection({.point_S = point_S, .snr_db = snr_db}, o);
  const double wander_angle = model.wander_sigma / d.range;
  const auto widen = [wander_angle](Vector3d& sigma) {
    sigma *= std::hypot(1.0, wander_angle / sigma.norm());
  };
  d.sigma_range = std::hypot(d.sigma_range, model.wander_sigma);
  widen(d.sigma_azimuth_S);
  widen(d.sigma_elevation_S);
  return d;
}

/// P, and the reflectors in it.
class Recursion {
 public:
  Recursion(const LimitPrior& prior, Time timeout) : timeout_(timeout) {
    const CalibrationOptions& c = prior.calibration;
    P_.topLeftCorner<kBody, kBody>() = prior.covariance;
    P_.diagonal().segment<3>(kRotation).setConstant(c.rotation_sigma * c.rotation_sigma);
    P_.diagonal().segment<3>(kTranslation).setConstant(c.translation_sigma * c.translation_sigma);
    P_(kDopplerScale, kDopplerScale) = c.doppler_scale_sigma * c.doppler_scale_sigma;
    P_(kElevation, kElevation) = c.elevation_bias_sigma * c.elevation_bias_sigma;
    P_(kTimeOffset, kTimeOffset) = c.time_offset_sigma * c.time_offset_sigma;
  }

  auto body() const { return P_.topLeftCorner<kBody, kBody>(); }

  void propagate(const Matrix15d& phi, const Matrix15d& noise) {  // (E6)
    P_.topRows<kBody>() = (phi * P_.topRows<kBody>()).eval();
    P_.leftCols<kBody>() = (P_.leftCols<kBody>() * phi.transpose()).eval();
    P_.topLeftCorner<kBody, kBody>() += noise;
  }

  /// A detection of a reflector.
  struct Echo {
    int reflector = -1;
    Rows J;
  };

  void update(const std::vector<Echo>& echoes, Time now) {
    forget(now);
    std::vector<Update> known;
    std::vector<Update> born;
    for (const Echo& echo : echoes) {
      const auto place = std::find_if(landmarks_.begin(), landmarks_.end(),
                                      [&](const auto& l) { return l.reflector == echo.reflector; });
      if (place == landmarks_.end()) continue;
      place->last_seen = now;
      known.push_back({column(place - landmarks_.begin()), 0, &echo.J});
    }
    correct(known);
    for (const Echo& echo : echoes) {
      const bool is_known =
          std::any_of(known.begin(), known.end(), [&](const Update& k) { return k.J == &echo.J; });
      if (is_known) continue;
      born.push_back({add_landmark(echo, now), kRows - 1, &echo.J});
    }
    correct(born);
    while (landmarks_.size() > kMaxLandmarks) remove(least_missed(now));
  }

 private:
  struct Landmark {
    int reflector = -1;
    Time last_seen{0};
    Time born{0};
  };
  /// Rows `first` to the last of J for the landmark at `column`.
  struct Update {
    Eigen::Index column = 0;
    int first = 0;
    const Rows* J = nullptr;
  };

  static Eigen::Index column(Eigen::Index landmark) { return kCommon + 3 * landmark; }
  Eigen::Index size() const { return column(static_cast<Eigen::Index>(landmarks_.size())); }

  void correct(const std::vector<Update>& updates) {  // (E4)
    Eigen::Index m = 0;
    for (const Update& u : updates) m += kRows - u.first;
    if (m == 0) return;
    Eigen::MatrixXd JP(m, size());
    for_each_rows(updates, [&](Eigen::Index row, const auto& J, Eigen::Index landmark) {
      JP.middleRows(row, J.rows()) =
          J.leftCols(kCommon) * P_.topRows(kCommon) + J.rightCols(3) * P_.middleRows(landmark, 3);
    });
    Eigen::MatrixXd S = Eigen::MatrixXd::Identity(m, m);
    for_each_rows(updates, [&](Eigen::Index row, const auto& J, Eigen::Index landmark) {
      S.middleCols(row, J.rows()) += JP.leftCols(kCommon) * J.leftCols(kCommon).transpose() +
                                     JP.middleCols(landmark, 3) * J.rightCols(3).transpose();
    });
    const Eigen::LLT<Eigen::MatrixXd> llt(S);
    llt.matrixL().solveInPlace(JP);
    P_.selfadjointView<Eigen::Lower>().rankUpdate(JP.transpose(), -1.0);
    P_.triangularView<Eigen::StrictlyUpper>() = P_.transpose();
  }

  /// f(first row in the stack, rows of J, column of the landmark).
  template <class F>
  static void for_each_rows(const std::vector<Update>& updates, const F& f) {
    Eigen::Index row = 0;
    for (const Update& u : updates) {
      const auto J = u.J->bottomRows(kRows - u.first);
      f(row, J, u.column);
      row += J.rows();
    }
  }

  /// (E5); returns its column.
  Eigen::Index add_landmark(const Echo& echo, Time now) {
    const Eigen::Index at = size();
    const Matrix3d J_l = echo.J.topRightCorner<3, 3>();
    const Matrix3d inverse = J_l.inverse();
    const Eigen::Matrix<double, 3, kCommon> J_x = -inverse * echo.J.topLeftCorner<3, kCommon>();
    const Eigen::Matrix<double, 3, Eigen::Dynamic> row = J_x * P_.topRows(kCommon);
    P_.conservativeResize(at + 3, at + 3);
    P_.bottomLeftCorner(3, at) = row;
    P_.topRightCorner(at, 3) = row.transpose();
    P_.bottomRightCorner<3, 3>() =
        row.leftCols<kCommon>() * J_x.transpose() + inverse * inverse.transpose();
    landmarks_.push_back({echo.reflector, now, now});
    return at;
  }

  void forget(Time now) {
    for (std::size_t i = landmarks_.size(); i-- > 0;) {
      if (now - landmarks_[i].last_seen > timeout_) remove(i);
    }
  }
  /// Of those out of view the one unseen for longest. If there is none, the youngest: the
  /// information of a landmark is in its first view point.
  std::size_t least_missed(Time now) const {
    const auto stalest = std::min_element(
        landmarks_.begin(), landmarks_.end(),
        [](const Landmark& a, const Landmark& b) { return a.last_seen < b.last_seen; });
    const auto youngest =
        std::max_element(landmarks_.begin(), landmarks_.end(),
                         [](const Landmark& a, const Landmark& b) { return a.born < b.born; });
    const bool unseen = now - stalest->last_seen > from_seconds(kLandmarkInView);
    return static_cast<std::size_t>((unseen ? stalest : youngest) - landmarks_.begin());
  }
  /// The last one replaces it.
  void remove(std::size_t i) {
    const Eigen::Index at = column(static_cast<Eigen::Index>(i));
    const Eigen::Index last = size() - 3;
    P_.middleRows<3>(at) = P_.middleRows<3>(last).eval();
    P_.middleCols<3>(at) = P_.middleCols<3>(last).eval();
    P_.conservativeResize(last, last);
    landmarks_[i] = landmarks_.back();
    landmarks_.pop_back();
  }

  Time timeout_;
  Eigen::MatrixXd P_ = Eigen::MatrixXd::Zero(kCommon, kCommon);
  std::vector<Landmark> landmarks_;  // in the order of their columns
};

/// The true motion at the stamps of the IMU.
ImuBuffer true_imu(const sim::Flight& flight, const ImuOptions& options) {
  TimingOptions all;
  all.imu_buffer = static_cast<int>(flight.imu.size());
  ImuBuffer buffer(all, options);
  for (const ImuSample& sample : flight.imu) {
    const sim::Trajectory::Point truth = flight.trajectory.at(sample.time);
    buffer.push_back({sample.time, truth.gyro_B, truth.accel_B});
  }
  return buffer;
}

std::vector<Recursion::Echo> static_echoes(const sim::Flight& flight, std::size_t scan,
                                           const sim::Trajectory::Point& truth,
                                           const RadarOptions& options) {
  const sim::RadarModel& model = flight.scenario.radar;
  const DetectionRows rows(truth, model.T_BS);
  std::vector<Recursion::Echo> echoes;
  for (std::size_t i = 0; i < flight.labels[scan].size(); ++i) {
    const sim::Label& label = flight.labels[scan][i];
    if (label.cause != sim::Cause::kStatic) continue;
    const auto id = static_cast<std::size_t>(label.reflector);
    const Vector3d& p_WL = flight.room.reflectors[id].position_W;
    const double snr_db = flight.scans[scan].detections[i].snr_db;
    echoes.push_back(
        {label.reflector, rows(p_WL, noise_of(rows.in_radar(p_WL), snr_db, model, options))});
  }
  return echoes;
}

LimitStep limit_step(const NavState& truth, const Matrix15d& P) {
  const AttitudeVariance attitude =
      attitude_variance(truth.q_WB, P.block<3, 3>(body::kAttitude, body::kAttitude));
  return {.time = truth.time,
          .position = P.diagonal().segment<3>(body::kPosition).cwiseSqrt(),
          .heading = std::sqrt(attitude.heading),
          .velocity = std::sqrt(P.diagonal().segment<3>(body::kVelocity).sum())};
}

}  // namespace

LimitPrior limit_prior(const sim::Flight& flight, const Options& options) {
  LimitPrior prior;
  prior.calibration = options.calibration;
  StaticAligner aligner(options.start, options.imu);
  std::optional<Alignment> alignment;
  for (const ImuSample& sample : flight.imu) {
    (void)aligner.add(sample, &alignment);
    if (!alignment) continue;
    prior.time = alignment->state.time;
    prior.covariance = alignment->covariance;
    return prior;
  }
  throw std::runtime_error("the flight has no standstill to align in");
}

std::vector<LimitStep> information_limit(const sim::Flight& flight, const Options& options,
                                         const LimitPrior& prior) {
  const ImuBuffer imu = true_imu(flight, options.imu);
  Recursion recursion(prior, from_seconds(options.frontend.landmark_timeout));
  sim::Trajectory::Point truth = flight.trajectory.at(prior.time);
  std::vector<LimitStep> steps;
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    const Time time = flight.scans[i].time - from_seconds(flight.scenario.radar.stamp_offset);
    if (time < prior.time) continue;
    Propagation p;
    p.state = truth.nav;
    imu.for_each_step(truth.nav.time, time,
                      [&](const ImuStep& step) { p.step(step, options.imu); });
    recursion.propagate(p.transition(), p.noise());
    truth = flight.trajectory.at(time);
    recursion.update(static_echoes(flight, i, truth, options.radar), time);
    steps.push_back(limit_step(truth.nav, recursion.body()));
    if (steps.size() == 1) continue;
    const LimitStep& before = steps[steps.size() - 2];
    steps.back().distance =
        before.distance + (truth.nav.p_WB - flight.trajectory.at(before.time).nav.p_WB).norm();
  }
  return steps;
}

double limit_of_drift(const std::vector<LimitStep>& steps) {
  if (steps.empty() || steps.back().distance <= 0.0) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return 100.0 * steps.back().rmse() / steps.back().distance;
}

std::vector<eval::PosePair> mean_errors_at_limit(const sim::Flight& flight,
                                                 const std::vector<LimitStep>& steps) {
  const double mean_of_sigma = std::sqrt(2.0 / std::numbers::pi);
  std::vector<eval::PosePair> pairs;
  for (const LimitStep& step : steps) {
    const NavState x = flight.trajectory.at(step.time).nav;
    pairs.push_back(
        {{x.time, x.p_WB, x.q_WB}, {x.time, x.p_WB + mean_of_sigma * step.position, x.q_WB}});
  }
  return pairs;
}

}  // namespace rio::experiment
