// SPDX-License-Identifier: BSD-3-Clause
// Stage 3: a second opinion on the velocity, from the Dopplers of a second and the increments of
// the IMU between them. It needs no believed velocity and works with a few points a scan. It is
// asked for one thing: has the estimate become wrong while its covariance denies it, so that the
// gates refuse, for ever, the very measurements that could correct it?
//
// v: velocity of the body now, g: gravity, both in the axes of the body now. For a detection that
// is T old: u_B its direction, w the rate and p the lever arm then; C the turn of the body since, s
// the specific force summed up since, both to the axes of now.
//
// (E1) velocity then, in the axes of now: v - s - g T
// (E2) -d = a . (v - s - g T) + u_B . (w x p), a = C u_B: linear in v, modulo 2 v_max
// (E3) a row supports v if its residual is below 3 sigma + e T: sigma of Doppler and direction,
//      e what the accelerometer, and g by the sigma of the tilt, can be off
// (E4) L(v) = sum max(0, ln(2 v_r / (sqrt(2 pi) sigma)) - r^2 / (2 sigma^2)), over the rows that
//      support v: log-likelihood over that of a Doppler anywhere in +-v_r. With (E3) alone a fast
//      velocity, of which an uncertain direction explains anything, would win.
//
// (E5) share of the rows that support v which do so by chance: movers, ghosts and noise leave
// beside
//      the bound b of (E3) about as many a m/s as inside it. With n of them up to h beyond it and m
//      rows inside, n b / (h m)
//
// Against the velocity believed compete standstill and the solutions of triples of rows, in all
// neighbouring folds. A velocity is an opinion if for some time on
//   - it supports most rows, over some time, and no other one far away is nearly as likely;
//   - it is kClearly times as likely as the one believed, and beyond its three sigmas;
// where "some time" is short at the start, long if the state estimate was supported before: the
// velocity does not change unnoticed by the IMU, but somebody who passes close by may fill the
// view.
#pragma once

#include <optional>
#include <vector>

#include "rio/frontend/doppler_fold.hpp"
#include "rio/models/detection.hpp"
#include "rio/options.hpp"
#include "rio/propagate/imu_buffer.hpp"
#include "rio/state/estimate.hpp"

namespace rio {

/// Velocity of the body in its own axes.
struct VelocityOpinion {
  Vector3d v_B = Vector3d::Zero();         ///< [m/s]
  Matrix3d covariance = Matrix3d::Zero();  ///< [m^2/s^2]
};

/// No allocation after construction.
class VelocityPool {
 public:
  explicit VelocityPool(const Options& options);

  /// Starts over; the velocity counts as right at `time`, but not as proven.
  void reset(Time time);

  /// When the velocity believed was last supported.
  Time agreed() const { return agreed_; }
  /// (E5) of the velocity believed, its sigma in the bound; 0 while there are few rows.
  double chance() const { return chance_; }
  /// Since when it has been contradicted; the newest scan if it is not.
  Time contradicted_since() const { return since_; }

  /// Takes a scan; the result is the velocity that contradicts the one believed, if one does.
  /// @param x predicted to the scan
  /// @param sigma of the velocity believed, all axes [m/s]
  /// @param sigma_tilt of roll and pitch [rad]
  /// @param last scan before; the buffer holds the samples since
  /// @param gap the IMU paused since
  std::optional<VelocityOpinion> observe(const DetectionList& scan, const Estimate& x, double sigma,
                                         double sigma_tilt, Time last, const ImuBuffer& imu,
                                         bool gap);

 private:
  /// A Doppler, carried to now.
  struct Row {
    Time time{0};
    Vector3d a = Vector3d::Zero();  ///< (E2)
    double y = 0.0;                 ///< -d - u_B . (w x p) [m/s]
    Vector3d s = Vector3d::Zero();  ///< [m/s]
    double age = 0.0;               ///< T [s]
    double a_v = 0.0;               ///< what a . v is: y + a . (s + g T) [m/s]
    double sigma_doppler = 0.0;     ///< [m/s]
    double sigma_direction = 0.0;   ///< [rad]
    DopplerFold fold;               ///< of the radar that measured it
  };

  static constexpr std::size_t kMaxRows = 96;
  using RowArray = Eigen::Array<double, Eigen::Dynamic, 1, 0, kMaxRows, 1>;

  /// The rows side by side, for the one function that is called hundreds of times a search.
  struct Columns {
    Eigen::Array<double, Eigen::Dynamic, 3, 0, kMaxRows, 3> a;
    RowArray a_v, variance_doppler, variance_direction;
    RowArray allowance;                ///< e T / 3 of (E3) [m/s]
    RowArray period, folds_per_metre;  ///< 2 v_max and its inverse, both 0 without folding
    RowArray range;                    ///< 2 v_r / sqrt(2 pi) of (E4) [m/s]
  };

  /// The rows to the time of x (E1).
  void carry(Time last, const Estimate& x, const ImuBuffer& imu);
  void take(const DetectionList& scan, const Estimate& x);
  void complete(const Estimate& x);

  double sigma(const Row& row, double speed) const;
  double residual(const Row& row, const Vector3d& v) const {
    return row.fold.wrap(row.a_v - row.a.dot(v));
  }
  int support(const Vector3d& v) const;  // (E3)
  /// (E4); 0 where it cannot reach `needed`.
  double likelihood(const Vector3d& v, double needed = 0.0) const;
  double chance_share(const Vector3d& v, double sigma) const;  // (E5)

  /// The most likely velocity; none if one far away is nearly as likely.
  bool search(const Vector3d& believed, Time seed, Vector3d* best) const;

  /// Least squares over the rows that support v; none if it is weak in a direction.
  std::optional<VelocityOpinion> refine(const Vector3d& v) const;

  /// The state estimate is supported.
  std::nullopt_t agree(Time now);
  /// Neither supported nor contradicted.
  std::nullopt_t abstain(Time now);

  static constexpr Time kWindow = std::chrono::milliseconds(1000);  // the IMU alone stays good
  static constexpr Time kSpan = std::chrono::milliseconds(250);     // that rows must cover
  static constexpr int kMinRows = 12;                               // four times the unknowns
  static constexpr int kScanRows = 12;                              // of a dense scan, about
  static constexpr Time kPatience = std::chrono::milliseconds(250);
  static constexpr Time kLongPatience = std::chrono::milliseconds(4000);  // a person passes by
  static constexpr double kProven = 1.0;        // seconds of support that prove a velocity
  static constexpr double kAgreement = 0.85;    // share of the rows
  static constexpr double kMajority = 0.6;      // same, among outliers
  static constexpr double kTelling = 1.2;       // L of a row that is not won by chance
  static constexpr double kClearly = 1.5;       // ratio of L
  static constexpr double kNearly = 0.75;       // same
  static constexpr double kDrift = 0.2;         // least e of (E3): a degree, or a MEMS bias [m/s^2]
  static constexpr double kBeside = 1.0;        // h of (E5): pace of people [m/s]
  static constexpr double kRange = 10.0;        // v_r where Dopplers do not fold [m/s]
  static constexpr double kFastest = 30.0;      // no small robot is faster [m/s]
  static constexpr double kWeak = 1.0;          // sigma in the worst direction [m/s]
  static constexpr double kRepetition = 4.0;    // rows of one reflector repeat their error
  static constexpr double kLeastSigma = 0.01;   // [m/s]
  static constexpr double kLeastVolume = 0.02;  // of three directions
  static constexpr int kDraws = 30;             // at kMajority no clean triple once in 1500 scans

  Options options_;
  StaticVector<DopplerFold, kMaxRadars> folds_;  ///< by radar
  DopplerFold tightest_;
  double drift_ = kDrift;  ///< e of (E3) [m/s^2]
  std::vector<Row> rows_;  ///< oldest first
  Columns columns_;        ///< of rows_, after complete()
  Time agreed_{0};
  Time since_{0};        ///< it is contradicted
  double proven_ = 0.0;  ///< time of support [s]
  double chance_ = 0.0;
};

}  // namespace rio
