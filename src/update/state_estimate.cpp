// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/state_estimate.hpp"

#include <algorithm>
#include <array>

#include "rio/core/so3.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_birth.hpp"
#include "rio/propagate/strapdown.hpp"
#include "rio/update/gathered_covariance.hpp"
#include "rio/update/look_correlation.hpp"

namespace rio {

namespace {

/// The row of a Doppler along an exact direction; residual and noise are not set.
LinearRow doppler_row(const Vector3d& direction_S, const LinearizationPoint& x,
                      const Layout& layout) {
  DopplerModel::Measurement z;
  z.direction_S = direction_S;
  z.gyro_B = x.gyro_B;
  z.steady = x.steady_offset();
  Evaluation<DopplerModel> e;
  DopplerModel(DopplerDirections::kExact)
      .evaluate(z, x.T_WB, x.v_WB, x.gyro_bias, x.T_BS, x.doppler_scale, e.r, &e.J, e.R);
  return state_rows<1>(e.J, DopplerModel::Blocks{}, x, {}, layout)[0];
}

}  // namespace

StateEstimate::StateEstimate(const Options& options, int max_clones)
    : options_(options),
      layout_(options.calibration, max_clones, options.update.max_landmarks,
              options.auxiliary.size(), options.radars()),
      parameters_(parameter_noise(layout_, options.calibration, options.auxiliary)),
      covariance_(layout_),
      dx_(Eigen::VectorXd::Zero(layout_.capacity())) {}

void StateEstimate::reset(const NavState& prior, const BodyCovariance& P0) {
  estimate_ = Estimate{};
  estimate_.nav = prior;
  estimate_.auxiliary = options_.auxiliary.initial();
  for (std::size_t r = 0; r < options_.radars(); ++r) {
    estimate_.set_radar(r, configured_state(options_.mount(r)));
  }
  layout_ = layout_.of_radar(0);
  restart_steady_motion(prior.q_WB.conjugate() * prior.v_WB);
  covariance_.reset(P0, parameters_.prior);
}

Status StateEstimate::propagate(Time to, const ImuBuffer& imu, bool* gap) {
  Propagation p;
  p.state = estimate_.nav;
  SteadyMotionFilter steady = steady_;
  const ImuOptions& o = options_.imu;
  double density = o.accel_noise_density * o.accel_noise_density;
  double gyro_variance = 0.0;
  imu.for_each_step(estimate_.nav.time, to, [&](const ImuStep& step) {
    const Vector3d before = p.state.v_WB;
    p.step(step, options_.imu);
    steady.add(p.state.v_WB - before, to_seconds(step.end - step.begin));
    if (!o.measure_noise) return;
    density = std::max(density, step.measured.accel);
    gyro_variance = std::max(o.gyro_noise_density * o.gyro_noise_density, step.measured.gyro) /
                    step.sample_interval;
  });
  if (!p.finite()) return Status::kNumerical;
  *gap = p.gap;
  const double distance = (p.state.p_WB - estimate_.nav.p_WB).norm();
  const double seconds = to_seconds(to - estimate_.nav.time);
  estimate_.gyro_B = imu.at(to).gyro_B;
  estimate_.accel_density = density;
  estimate_.gyro_variance = options_.ablation.shared_gyro_noise ? gyro_variance : 0.0;
  steady.advance(estimate_.nav, p.state, estimate_.gyro_B - p.state.gyro_bias, seconds, density,
                 gyro_variance, body_velocity_variance());
  steady_ = steady;
  estimate_.steady = steady_.motion();
  if (!options_.ablation.steady_motion) {
    estimate_.steady.v_B = p.state.q_WB.conjugate() * p.state.v_WB;
    estimate_.steady.rate_B = estimate_.gyro_B - p.state.gyro_bias;
  }
  estimate_.nav = p.state;
  estimate_.distance_travelled += distance;
  covariance_.propagate(p.transition(), p.noise());
  for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
    covariance_.add_landmark_noise(static_cast<int>(i),
                                   landmark_walk(estimate_.landmarks[i], estimate_.nav.p_WB,
                                                 options_.update.landmark_walk, distance));
  }
  covariance_.add_parameter_noise(parameters_.walk, seconds);
  if (options_.frontend.matching == Matching::kMahalanobis) predict_landmarks();
  return Status::kOk;
}

double StateEstimate::body_velocity_variance() const {
  const Matrix3d R_BW = estimate_.T_WB().R.transpose();
  const Matrix3d A = skew(R_BW * estimate_.nav.v_WB);  // v_B = Exp(-dphi) R_BW (v + dv)
  const auto P = covariance_.matrix();
  const Matrix3d cross = A * P.block<3, 3>(body::kAttitude, body::kVelocity) * R_BW.transpose();
  return (A * P.block<3, 3>(body::kAttitude, body::kAttitude) * A.transpose()).trace() +
         P.block<3, 3>(body::kVelocity, body::kVelocity).trace() + 2.0 * cross.trace();
}

void StateEstimate::set_mounting(std::size_t r, const Mounting& mounting) {
  RadarState radar = estimate_.of_radar(r);
  radar.T_BS = mounting.T_BS;
  estimate_.set_radar(r, radar);
  const int at = layout_.of_radar(r).extrinsics();
  covariance_.replace({at, at + 3}, mounting.covariance.topLeftCorner<6, 6>());
}

void StateEstimate::set_mounting_and_motion(std::size_t r, const Mounting& mounting) {
  set_mounting(r, mounting);
  NavState& nav = estimate_.nav;
  nav.p_WB += mounting.position_error_W;
  nav.v_WB += mounting.velocity_error_W;
  const int at = layout_.of_radar(r).extrinsics();
  covariance_.replace({at, at + 3, body::kPosition, body::kVelocity}, mounting.covariance);
  restart_steady_motion(nav.q_WB.conjugate() * nav.v_WB);
}

void StateEstimate::set_auxiliary(int first, const Eigen::Ref<const Eigen::VectorXd>& value,
                                  const Eigen::Ref<const Eigen::MatrixXd>& by_body,
                                  const Eigen::Ref<const Eigen::MatrixXd>& noise) {
  estimate_.auxiliary.segment(first, value.size()) = value;
  covariance_.assign_parameters(layout_.auxiliary() + first, by_body, noise);
}

Eigen::Matrix4d StateEstimate::velocity_calibration() const {
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();
  const auto all = covariance_.matrix();
  if (layout_.has_extrinsics()) {
    P.topLeftCorner<3, 3>() = all.block<3, 3>(layout_.extrinsics(), layout_.extrinsics());
  }
  if (layout_.has_doppler_scale()) {
    P(3, 3) = all(layout_.doppler_scale(), layout_.doppler_scale());
  }
  return P;
}

Matrix3d StateEstimate::radar_velocity_covariance(const LinearizationPoint& x) const {
  std::array<LinearRow, 3> rows;
  for (int i = 0; i < 3; ++i) {  // a Doppler along an axis is a component of the velocity
    rows[static_cast<std::size_t>(i)] = doppler_row(Vector3d::Unit(i), x, layout_);
  }
  GatheredCovariance gathered;
  gathered.begin(covariance_);
  const Matrix3d lever = x.T_BS.R.transpose() * skew(x.T_BS.p);
  return gathered.product(rows) + x.estimate.gyro_variance * lever * lever.transpose();
}

Matrix3d StateEstimate::radar_velocity_covariance() const {
  return radar_velocity_covariance(LinearizationPoint(estimate_));
}

void StateEstimate::clone(ScanId scan) {
  if (options_.update.max_clones == 0) return;
  const std::size_t slot = slot_for(scan);
  Clone& clone = estimate_.clones[slot];
  clone.scan = scan;
  clone.T_WB = estimate_.T_WB();
  clone.kept_for[estimate_.radar] = true;
  if (layout_.max_clones() == 0) return;
  const Eigen::Matrix<double, 6, 6> same = Eigen::Matrix<double, 6, 6>::Identity();
  covariance_.assign_clone(
      static_cast<int>(slot),
      state_rows<6>(same, BlockList<BodyPose>{}, LinearizationPoint(estimate_), {}, layout_));
}

std::size_t StateEstimate::slot_for(ScanId scan) {
  auto& clones = estimate_.clones;
  const std::size_t radar = estimate_.radar;
  Clone* oldest = nullptr;
  std::size_t own = 0;
  for (Clone& clone : clones) {
    if (!clone.kept_for[radar] || clone.scan == scan) continue;
    ++own;
    if (oldest == nullptr || clone.scan < oldest->scan) oldest = &clone;
  }
  if (own == clones_per_radar(options_)) oldest->kept_for[radar] = false;
  std::size_t slot = clones.size();
  for (std::size_t i = clones.size(); i-- > 0;) {
    if (clones[i].scan == scan) return i;
    const auto& kept_for = clones[i].kept_for;
    if (std::find(kept_for.begin(), kept_for.end(), true) == kept_for.end()) slot = i;
  }
  if (slot == clones.size()) clones.push_back({});
  return slot;
}

void StateEstimate::add_landmark(const Detection& d) {
  const LandmarkBirth birth(estimate_.T_WB(), RigidPose(estimate_.T_BS), estimate_.elevation_error,
                            d);
  covariance_.add_landmark(
      static_cast<int>(estimate_.landmarks.size()),
      state_rows<3>(birth.d_l, LandmarkBirth::Blocks{}, LinearizationPoint(estimate_), {}, layout_),
      birth.noise);
  estimate_.landmarks.push_back({birth.p_WL, estimate_.nav.time, Matrix3d::Zero(),
                                 estimate_.distance_travelled, estimate_.distance_travelled});
}

void StateEstimate::remove_landmark(std::size_t i) {
  covariance_.remove_landmark(static_cast<int>(i));
  estimate_.landmarks[i] = estimate_.landmarks.back();
  estimate_.landmarks.pop_back();
}

void StateEstimate::correct(const Eigen::VectorXd& dx) {
  add_error(dx.head<body::kSize>(), &estimate_.nav);
  for (std::size_t r = 0; r < layout_.radars(); ++r) correct_calibration(r, dx);
  estimate_.auxiliary.head(layout_.auxiliary_size()) +=
      dx.segment(layout_.auxiliary(), layout_.auxiliary_size());
  for (std::size_t i = 0; layout_.max_clones() > 0 && i < estimate_.clones.size(); ++i) {
    RigidPose& pose = estimate_.clones[i].T_WB;
    pose = PoseBlock::retract(pose, dx.segment<6>(layout_.clone(static_cast<int>(i))));
  }
  for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
    estimate_.landmarks[i].p_W += dx.segment<3>(layout_.landmark(static_cast<int>(i)));
  }
}

void StateEstimate::correct_calibration(std::size_t r, const Eigen::VectorXd& dx) {
  const Layout layout = layout_.of_radar(r);
  CalibrationVector step = CalibrationVector::Zero();
  for (int i = 0; i < step.size(); ++i) {
    const int column = calibration_column(layout, i);
    if (column >= 0) step[i] = dx[column];
  }
  const RadarState configured = configured_state(options_.mount(r));
  const CalibrationVector limits = kCalibrationLimit * calibration_sigmas(options_.calibration);
  const CalibrationVector total =
      corrections_between(configured, corrected(estimate_.of_radar(r), step));
  RadarState next = corrected(configured, total.cwiseMin(limits).cwiseMax(-limits));
  next.elevation_error = estimate_.of_radar(r).elevation_error;
  if (layout.has_elevation_error()) next.elevation_error += dx[layout.elevation_error()];
  estimate_.set_radar(r, next);
}

void StateEstimate::consider() {
  if (!layout_.has_elevation_error()) return;
  for (std::size_t r = 0; r < layout_.radars(); ++r) {
    const int at = layout_.of_radar(r).elevation_error();
    covariance_.matrix()(at, at) = parameters_.prior[at - body::kSize];
    RadarState state = estimate_.of_radar(r);
    state.elevation_error = 0.0;
    estimate_.set_radar(r, state);
  }
}

}  // namespace rio
