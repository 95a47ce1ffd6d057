// SPDX-License-Identifier: BSD-3-Clause
// Back-end 1: the multi-state error-state Kalman filter (Michalczyk et al., ICRA 2023).
//
// Stages 1, 2, 4 to 7 on the mean; everything about P is asked of ekf/covariance.hpp. The rows of
// one scan are linearised at the predicted state, gated against the predicted covariance, and
// applied at once.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include "rio/ekf/covariance.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_distance.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/trail_distance.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/report.hpp"
#include "rio/state/estimate.hpp"
#include "rio/state/layout.hpp"
#include "rio/update/gate.hpp"
#include "rio/update/linearize.hpp"

namespace rio {

class Ekf {
 public:
  explicit Ekf(const Options& options)
      : options_(options),
        layout_(options.update),
        covariance_(layout_),
        gate_(options.update.gate_probability),
        doppler_(options.update.direction_noise, options.update.direction_correction),
        plain_doppler_(options.update.direction_noise, false),
        trail_(options.update.trail_noise, options.update.sigma_trail_distance),
        landmark_(options.update.sigma_landmark_distance),
        // a detection gives at most its Doppler and a trail of distances, or a landmark's four rows
        batch_(static_cast<std::size_t>(options.frontend.max_detections *
                                        (1 + std::max(3, options.update.max_clones)))),
        dx_(Eigen::VectorXd::Zero(layout_.capacity())) {}

  const Estimate& estimate() const { return estimate_; }
  const Covariance& covariance() const { return covariance_; }
  /// Landmarks that can be taken: those not seen in this scan give way.
  std::size_t landmark_room(const Observations& seen) const {
    return static_cast<std::size_t>(layout_.max_landmarks()) - seen.matches.landmarks.size();
  }

  void reset(const NavState& prior, const BodyCovariance& P0) {
    estimate_ = Estimate{};
    estimate_.nav = prior;
    estimate_.T_BS = options_.radar.T_BS;
    covariance_.reset(P0, options_.update);
  }

  /// Stage 1: to exactly `to`. kNumerical, with nothing changed, if the result is not finite.
  Status propagate(Time to, const ImuBuffer& imu, bool* gap) {
    Propagation p;
    p.state = estimate_.nav;
    imu.for_each_step(estimate_.nav.time, to,
                      [&](const ImuStep& step) { p.step(step, options_.imu); });
    if (!p.finite()) return Status::kNumerical;
    *gap = p.gap;
    const double way = (p.state.p_WB - estimate_.nav.p_WB).norm();
    estimate_.nav = p.state;
    estimate_.gyro_B = imu.at(to).gyro_B;
    covariance_.propagate(p.transition, p.noise);
    const double walk = options_.update.landmark_walk;
    covariance_.add_landmark_noise(walk * walk * way);
    if (options_.frontend.matching == Matching::kMahalanobis) predict_landmarks();
    return Status::kOk;
  }

  /// Of the radar's own velocity as predicted, in its axes [m^2/s^2].
  Matrix3d radar_velocity_covariance() {
    const LinearizationPoint x(estimate_);
    DopplerModel::Measurement z;
    z.gyro_B = estimate_.gyro_B;
    batch_.clear();
    batch_.begin_block();
    for (int i = 0; i < 3; ++i) {  // a Doppler along an axis is a component of the velocity
      z.direction_S = Vector3d::Unit(i);
      linearize(plain_doppler_, z, DopplerModel::Blocks{}, x, {}, layout_, &batch_);
    }
    Matrix3d P;
    for (std::size_t i = 0; i < 9; ++i) {
      P(static_cast<Eigen::Index>(i)) =
          covariance_.product(batch_.rows()[i / 3], batch_.rows()[i % 3]);
    }
    return P;
  }

  /// All landmarks leave.
  void drop_landmarks(UpdateReport* report) {
    report->landmarks_removed += static_cast<int>(estimate_.landmarks.size());
    for (int i = static_cast<int>(estimate_.landmarks.size()); i-- > 0;) {
      covariance_.remove_landmark(i);
    }
    estimate_.landmarks.clear();
  }

  /// The velocity has been off by about `error` [m/s] for `duration` [s]: P admits it, and the
  /// landmarks seen meanwhile are dropped. The trails have to go, too.
  void reopen_velocity(double error, double duration, UpdateReport* report) {
    drop_landmarks(report);
    covariance_.reopen_velocity(error * error, duration);
  }

  /// Stages 4 to 6. kNumerical, with state and covariance as predicted, if the update fails.
  Status update(const Observations& seen, UpdateReport* report) {
    const LinearizationPoint x(estimate_);
    batch_.clear();
    measures_landmark_.fill(false);
    if (options_.update.use_landmarks) add_landmarks(seen, x, report);
    if (options_.update.use_doppler) add_doppler(seen, x, report);
    if (options_.update.use_trails) add_trails(seen, x, report);
    if (!covariance_.update(batch_, &dx_)) return Status::kNumerical;
    before_ = estimate_;
    correct();
    if (options_.update.consistent_covariance) covariance_.reexpress(before_, estimate_);
    return Status::kOk;
  }

  /// Stage 7: landmarks unseen for too long leave, promoted detections enter; of too many the one
  /// unseen for longest gives way.
  void maintain_landmarks(const Observations& seen, const Promotions& promotions,
                          UpdateReport* report) {
    const Time now = estimate_.nav.time;
    for (const Match& m : seen.matches.landmarks) {
      if (was_used_[m.target]) estimate_.landmarks[m.target].last_seen = now;
    }
    const Time timeout = from_seconds(options_.frontend.landmark_timeout);
    for (std::size_t i = estimate_.landmarks.size(); i-- > 0;) {
      if (now - estimate_.landmarks[i].last_seen > timeout) remove_landmark(i, report);
    }
    const RigidPose T_WB = estimate_.T_WB();
    const RigidPose T_BS(estimate_.T_BS);
    for (const Detection& d : promotions.births) {
      if (static_cast<int>(estimate_.landmarks.size()) == layout_.max_landmarks()) {
        remove_landmark(stalest_landmark(), report);
      }
      const InverseObservation inverse(T_WB, T_BS, d.point_S);
      covariance_.add_landmark(static_cast<int>(estimate_.landmarks.size()), inverse.d_l_d_body,
                               inverse.d_l_d_extrinsics,
                               inverse.d_l_d_m * point_covariance(d) * inverse.d_l_d_m.transpose());
      estimate_.landmarks.push_back({inverse.p_WL, now, Matrix3d::Zero()});
      ++report->landmarks_added;
    }
  }

  /// Stage 2: the corrected pose becomes the clone of this scan, in place of the oldest one.
  void clone(ScanId scan) {
    const auto slots = static_cast<std::size_t>(layout_.max_clones());
    if (slots == 0) return;
    const std::size_t slot = static_cast<std::size_t>(scan % slots);
    if (slot >= estimate_.clones.size()) estimate_.clones.resize(slot + 1);
    estimate_.clones[slot] = {scan, estimate_.T_WB()};
    covariance_.clone_body_pose(static_cast<int>(slot));
  }

 private:
  /// Fills what matching needs to know of the landmarks.
  void predict_landmarks() {
    const RigidPose T_WB = estimate_.T_WB();
    const RigidPose T_BS(estimate_.T_BS);
    for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
      LandmarkState& landmark = estimate_.landmarks[i];
      const ObservedPoint point(T_WB, T_BS, landmark.p_W);
      landmark.covariance_S = covariance_.landmark_in_radar(static_cast<int>(i), point.d_e_d_body,
                                                            point.d_e_d_extrinsics, point.d_e_d_l);
    }
  }

  std::size_t stalest_landmark() const {
    std::size_t stalest = 0;
    for (std::size_t i = 1; i < estimate_.landmarks.size(); ++i) {
      if (estimate_.landmarks[i].last_seen < estimate_.landmarks[stalest].last_seen) stalest = i;
    }
    return stalest;
  }

  /// The last one takes its place.
  void remove_landmark(std::size_t i, UpdateReport* report) {
    covariance_.remove_landmark(static_cast<int>(i));
    estimate_.landmarks[i] = estimate_.landmarks.back();
    estimate_.landmarks.pop_back();
    ++report->landmarks_removed;
  }

  void add_doppler(const Observations& seen, const LinearizationPoint& x, UpdateReport* report) {
    for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
      if (!seen.is_static(i) || measures_landmark_[i]) continue;
      auto z = DopplerModel::measurement(seen.detection(i), estimate_.gyro_B);
      if (options_.update.direction_correction) z.predicted_var = predicted_variance(z, x);
      batch_.begin_block();
      const bool valid = linearize(doppler_, z, DopplerModel::Blocks{}, x, {}, layout_, &batch_);
      decide(DopplerModel::kModel, i, valid, report);
    }
  }

  /// Variance of the predicted Doppler, with the direction as measured.
  double predicted_variance(const DopplerModel::Measurement& z, const LinearizationPoint& x) {
    batch_.begin_block();
    linearize(plain_doppler_, z, DopplerModel::Blocks{}, x, {}, layout_, &batch_);
    const double variance = covariance_.product(batch_.rows().back(), batch_.rows().back());
    batch_.drop_block();
    return variance;
  }

  void add_trails(const Observations& seen, const LinearizationPoint& x, UpdateReport* report) {
    const bool joint = options_.update.trail_noise == TrailNoise::kCorrelated;
    for (const Match& m : seen.matches.trails) {
      bool open = false;
      for (const TrailElement& past : (*seen.trails)[m.target].elements) {
        const int clone = estimate_.find_clone(past.scan);
        if (clone < 0) continue;
        const auto z = TrailDistanceModel::measurement(seen.detection(m.detection), past.detection);
        if (!open) batch_.begin_block();
        open = joint;
        const bool valid =
            linearize(trail_, z, TrailDistanceModel::Blocks{}, x, {clone, 0}, layout_, &batch_);
        if (joint) batch_.share_variance(trail_.shared_variance(z));
        if (!joint) decide(TrailDistanceModel::kModel, m.detection, valid, report);
      }
      if (joint && open) {
        const bool valid = batch_.last_block().count > 0;
        decide(TrailDistanceModel::kModel, m.detection, valid, report);
      }
    }
  }

  void add_landmarks(const Observations& seen, const LinearizationPoint& x, UpdateReport* report) {
    was_used_.fill(false);
    const bool point = options_.update.landmark_measurement == LandmarkMeasurement::kPoint;
    for (const Match& m : seen.matches.landmarks) {
      const Detection& d = seen.detection(m.detection);
      const BlockIndex index{0, static_cast<int>(m.target)};
      batch_.begin_block();
      const bool valid =
          point ? add_point(d, index, x)
                : linearize(landmark_, LandmarkDistanceModel::measurement(d),
                            LandmarkDistanceModel::Blocks{}, x, index, layout_, &batch_);
      const Model model = point ? LandmarkPointModel::kModel : LandmarkDistanceModel::kModel;
      const bool used = decide(model, m.detection, valid, report);
      was_used_[m.target] = used || !point;  // as published, a match keeps a landmark alive
      measures_landmark_[m.detection] = used && point;
    }
  }

  /// Position and, unless switched off, Doppler of one detection: one block, one verdict.
  bool add_point(const Detection& d, BlockIndex index, const LinearizationPoint& x) {
    return linearize(point_, LandmarkPointModel::measurement(d), LandmarkPointModel::Blocks{}, x,
                     index, layout_, &batch_) &&
           (!options_.update.use_doppler ||
            linearize(landmark_doppler_, LandmarkDopplerModel::measurement(d, estimate_.gyro_B),
                      LandmarkDopplerModel::Blocks{}, x, index, layout_, &batch_));
  }

  /// Stage 5: gates the last block, records it, and drops it unless it may be used, which is the
  /// result.
  bool decide(Model model, std::size_t detection, bool valid, UpdateReport* report) {
    ModelReport& sums = report->models[static_cast<std::size_t>(model)];
    InnovationRecord record;
    record.model = model;
    record.detection = static_cast<std::uint16_t>(detection);
    if (!valid) {
      record.verdict = Verdict::kOutOfDomain;
      ++sums.rows_out_of_domain;
      batch_.drop_block();
    } else {
      const RowBlock& block = batch_.last_block();
      const int rows = static_cast<int>(block.count);
      covariance_.innovation_covariance(batch_, block, &S_);
      record.dof = static_cast<std::uint16_t>(rows);
      record.innovation = batch_.rows()[block.first].residual;
      record.sigma = std::sqrt(S_(0, 0));
      record.nis = normalised_innovation_squared(block);
      record.gate = gate_.threshold(block.count);
      if (record.nis <= record.gate) {
        sums.rows_used += rows;
        sums.nis += record.nis;
      } else {
        record.verdict = Verdict::kGated;
        sums.rows_gated += rows;
        batch_.drop_block();
      }
    }
    if (!report->records.push_back(record)) ++report->records_dropped;
    return record.verdict == Verdict::kUsed;
  }

  /// Infinite if the innovation covariance is not positive definite.
  double normalised_innovation_squared(const RowBlock& block) {
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Gate::kMaxDof, 1> r(S_.rows());
    for (std::size_t i = 0; i < block.count; ++i) {
      r[static_cast<Eigen::Index>(i)] = batch_.rows()[block.first + i].residual;
    }
    const Eigen::LLT<Eigen::Ref<Covariance::BlockMatrix>> llt(S_);
    if (llt.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
    llt.matrixL().solveInPlace(r);
    return r.squaredNorm();
  }

  /// Injects dx_ into the mean.
  void correct() {
    const auto correct_pose = [this](int column, RigidPose* pose) {
      *pose = PoseBlock::retract(*pose, dx_.segment<6>(column));
    };
    NavState& nav = estimate_.nav;
    nav.q_WB = (nav.q_WB * quaternion_exp(dx_.segment<3>(body::kAttitude))).normalized();
    nav.p_WB += dx_.segment<3>(body::kPosition);
    nav.v_WB += dx_.segment<3>(body::kVelocity);
    nav.gyro_bias += dx_.segment<3>(body::kGyroBias);
    nav.accel_bias += dx_.segment<3>(body::kAccelBias);
    if (layout_.has_extrinsics()) {
      Pose& T_BS = estimate_.T_BS;
      const int column = layout_.extrinsics();
      T_BS.rotation = (T_BS.rotation * quaternion_exp(dx_.segment<3>(column))).normalized();
      T_BS.translation += dx_.segment<3>(column + 3);
    }
    for (std::size_t i = 0; i < estimate_.clones.size(); ++i) {
      correct_pose(layout_.clone(static_cast<int>(i)), &estimate_.clones[i].T_WB);
    }
    for (std::size_t i = 0; i < estimate_.landmarks.size(); ++i) {
      estimate_.landmarks[i].p_W += dx_.segment<3>(layout_.landmark(static_cast<int>(i)));
    }
  }

  Options options_;
  Layout layout_;
  Estimate estimate_;
  Estimate before_;
  Covariance covariance_;
  Gate gate_;
  DopplerModel doppler_;
  DopplerModel plain_doppler_;
  TrailDistanceModel trail_;
  LandmarkDistanceModel landmark_;
  LandmarkPointModel point_;
  LandmarkDopplerModel landmark_doppler_;
  RowBatch batch_;
  Covariance::BlockMatrix S_;
  Eigen::VectorXd dx_;
  std::array<bool, kMaxDetections> measures_landmark_{};  ///< its Doppler is already in
  std::array<bool, kMaxLandmarks> was_used_{};            ///< by landmark, in this scan
};

}  // namespace rio
