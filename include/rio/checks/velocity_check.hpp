// SPDX-License-Identifier: BSD-3-Clause
// Check of the velocity: an independent estimate of it, from the Dopplers of one second and the IMU
// increments between them. It needs no predicted velocity and works with a few points per
// scan. Its purpose is to detect that the state estimate's velocity is wrong beyond its covariance,
// so that the gates permanently reject the measurements that could correct it.
//
// v: velocity of the body now, g: gravity, both in the current body axes. For a detection of age T:
// u_B its direction, w the angular rate and p the lever arm at its time; C the rotation of the body
// and s the integrated specific force since, both in the current body axes.
//
// (E1) velocity at the detection's time, in the current body axes: v - s - g T
// (E2) -d = a . (v - s - g T) + u_B . (w x p), a = C u_B: linear in v, modulo 2 v_max
// (E3) a row supports v if its residual is below 3 sigma + e T: sigma of Doppler and direction,
//      e the possible error of the accelerometer, and of g by the sigma of the tilt
// (E4) L(v) = sum max(0, ln(2 v_r / (sqrt(2 pi) sigma)) - r^2 / (2 sigma^2)), over the rows that
//      support v: log-likelihood relative to a Doppler uniform in +-v_r. With (E3) alone a fast
//      velocity, whose large direction error explains anything, would win.
// (E5) share of the rows supporting v that do so by chance: movers, ghosts and noise have about the
//      same density [rows per m/s] beside the bound b of (E3) as inside it. With n rows up to h,
//      the pace of people, beyond the bound and m rows inside: n b / (h m)
//
// The hypotheses beside the state estimate's velocity are standstill and the solutions of triples
// of rows, in all neighbouring folds, moved to the most likely velocity nearby: triples of one
// velocity scatter with the speed. One contradicts the state estimate if, for long enough,
//   - most rows support it, over a sufficient span, and no other distant one is nearly as likely;
//   - its L is kLikelihoodRatio times that of the state estimate's velocity, and it is beyond the
//     three sigmas of that.
// "Long enough" is short at the start and long if the state estimate was supported before: the IMU
// would have measured a change of the velocity, but a person passing close by may fill the view. It
// is short again while the body lies still (frontend/rest_detector.hpp): the IMU agrees then.
#pragma once

#include <optional>
#include <vector>

#include "rio/checks/record.hpp"
#include "rio/frontend/doppler_fold.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// Independent estimate of the velocity of the body, in body axes.
struct IndependentVelocity {
  Vector3d v_B = Vector3d::Zero();         ///< [m/s]
  Matrix3d covariance = Matrix3d::Zero();  ///< [m^2/s^2]
};

/// No allocation after construction.
class VelocityCheck {
 public:
  explicit VelocityCheck(const Options& options);

  /// Starts over; the state estimate's velocity counts as supported at `time`, but not as proven.
  void reset(Time time) {
    rows_.clear();
    record_.agree(time);
    proven_ = chance_ = contradiction_ = 0.0;
  }

  const CheckRecord& record() const { return record_; }
  /// It has been supported for kProven since the last reset.
  bool proven() const { return proven_ > kProven; }
  /// (E5) of the state estimate's velocity, its sigma in the bound; 0 while there are few rows.
  double chance() const { return chance_; }
  /// Difference of the velocities while it is contradicted; 0 if it is not [m/s].
  double contradiction() const { return contradiction_; }

  /// Transforms the Dopplers to the body axes of x (E1) and drops the old ones. Call whenever the
  /// state is propagated, with or without a scan.
  /// @param last time from which it was propagated; the buffer holds the samples since
  /// @param gap the IMU paused since
  void carry(const Estimate& x, Time last, const ImuBuffer& imu, bool gap);

  /// Takes a scan; returns the velocity that contradicts the state estimate's, if one does.
  /// @param x predicted to the scan
  /// @param sigma of the velocity of x, all axes [m/s]
  /// @param sigma_tilt of roll and pitch [rad]
  /// @param at_rest the body lies still by the rest detector
  std::optional<IndependentVelocity> observe(const DetectionList& scan, const Estimate& x,
                                             double sigma, double sigma_tilt, bool at_rest);

 private:
  /// One Doppler, transformed to the current body axes.
  struct Row {
    Time time{0};
    Vector3d a = Vector3d::Zero();  ///< (E2)
    double y = 0.0;                 ///< -d - u_B . (w x p) [m/s]
    Vector3d s = Vector3d::Zero();  ///< [m/s]
    double age = 0.0;               ///< T [s]
    double a_v = 0.0;               ///< measured a . v: y + a . (s + g T) [m/s]
    double sigma_doppler = 0.0;     ///< [m/s]
    double sigma_direction = 0.0;   ///< [rad]
    DopplerFold fold;               ///< of the radar that measured it
  };

  static constexpr std::size_t kMaxRows = 96;
  using RowArray = Eigen::Array<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;

  /// The rows as arrays, for likelihood(), which is called hundreds of times per search.
  struct Columns {
    Eigen::Array<double, Eigen::Dynamic, 3, 0, kMaxRows, 3> a;
    RowArray a_v, variance_doppler, variance_direction;
    RowArray allowance;                ///< e T / 3 of (E3) [m/s]
    RowArray period, folds_per_metre;  ///< 2 v_max and its inverse, both 0 without folding
    RowArray range;                    ///< 2 v_r / sqrt(2 pi) of (E4) [m/s]
  };

  /// Adds the rows of a scan.
  void take(const DetectionList& scan, const Estimate& x);
  /// Fills a_v and columns_.
  void complete(const Estimate& x);

  double sigma(const Row& row, double speed) const;
  double residual(const Row& row, const Vector3d& v) const {
    return row.fold.wrap(row.a_v - row.a.dot(v));
  }
  int count_support(const Vector3d& v) const;  // (E3)
  /// (E4); 0 if it cannot reach `needed`.
  double likelihood(const Vector3d& v, double needed = 0.0) const;
  double chance_share(const Vector3d& v, double sigma) const;  // (E5)

  /// The most likely velocity; false if a distant one is nearly as likely.
  bool search(const Vector3d& predicted, Time seed, Vector3d* best) const;

  /// The most likely velocity near v: with the speed those of triples scatter, at 10 m/s by metres
  /// per second.
  Vector3d local_maximum(Vector3d v) const;

  /// Least squares over the rows that support v; none if a direction is poorly determined.
  std::optional<IndependentVelocity> refine(const Vector3d& v) const;

  /// The state estimate is supported.
  std::nullopt_t agree(Time now);
  /// Neither supported nor contradicted.
  std::nullopt_t abstain(Time now) {
    contradiction_ = 0.0;
    return record_.abstain(now);
  }

  static constexpr Time kWindow = std::chrono::milliseconds(1000);  // the IMU alone is accurate
  static constexpr Time kSpan = std::chrono::milliseconds(250);     // the rows must cover
  static constexpr int kMinRows = 12;                               // four times the unknowns
  static constexpr int kScanRows = 12;                              // of a dense scan, about
  static constexpr Time kPatience = std::chrono::milliseconds(250);
  static constexpr Time kLongPatience = std::chrono::milliseconds(4000);  // a person passes by
  static constexpr double kProven = 1.0;               // time of support that proves a velocity [s]
  static constexpr double kAgreement = 0.85;           // supporting share of the rows
  static constexpr double kMajority = 0.6;             // same, with outliers
  static constexpr double kMinLikelihoodPerRow = 1.2;  // L per row that is not reached by chance
  static constexpr double kLikelihoodRatio = 1.5;      // ratio of L
  static constexpr double kRivalRatio = 0.75;          // same
  static constexpr double kDrift = 0.2;         // least e of (E3): a degree, or a MEMS bias [m/s^2]
  static constexpr double kRange = 10.0;        // v_r where Dopplers do not fold [m/s]
  static constexpr double kWeak = 1.0;          // sigma in the worst direction [m/s]
  static constexpr double kLeastSigma = 0.01;   // [m/s]
  static constexpr double kLeastVolume = 0.02;  // of three directions
  static constexpr int kClimb = 3;              // steps to the most likely velocity nearby
  static constexpr int kDraws = 30;             // at kMajority all fail once in 1500 scans

  Options options_;
  StaticVector<DopplerFold, kMaxRadars> folds_;  ///< by radar
  DopplerFold tightest_;
  double drift_ = kDrift;  ///< e of (E3) [m/s^2]
  std::vector<Row> rows_;  ///< oldest first
  Columns columns_;        ///< of rows_, after complete()
  CheckRecord record_;
  double proven_ = 0.0;  ///< time of support [s]
  double chance_ = 0.0;
  double contradiction_ = 0.0;
};

}  // namespace rio
