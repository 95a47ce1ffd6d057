// SPDX-License-Identifier: BSD-3-Clause
// Agreement of the velocities from a radar with the motion from an IMU, for any axes, sign and
// scale of the radar. No state estimate is needed: per window velocity and gravity are free, and
// the equations are linear in them.
//
// C: rotation of the body since the first sample, s: integrated specific force in the axes at that
// time, both from the IMU alone. Their drift is small within a window of seconds. y_S: velocity of
// the radar in its own axes, from the Dopplers of one scan; R: from radar axes to body axes.
//
// (E1) a C R y_S = v_0 + s + g t + C (w x p), a = 1 over the scale of the Doppler
// (E2) q = s + C (w x p) and G, with C R y_S = G vec(R), minus their lines over t in the window:
//      the part that v_0 and g cannot explain
// (E3) J(a, R) = sum w |a G r - q|^2 = a^2 r^T A r - 2 a b^T r + c,  r = vec(R)
// (E4) explained: 1 - min_a J / c = (b^T r)^2 / (c r^T A r), with a > 0
// (E5) the scale of the Doppler is between b^T r / c (if the noise is the radar's) and
//      r^T A r / b^T r (if it is the IMU's)
// (E6) the better of two hypotheses, with unexplained shares u < u', has a significance of
//      sqrt(3 n (u' - u) / u) sigmas: as if each axis of n windows were one measurement. A window
//      has dozens, but the errors of the models repeat within it.
// (E7) an error p of the lever arm is linear, too: G gets the columns -C [w]x, and p is eliminated
//      from A, b and c with a prior on it
// (E8) r^T A r - (b^T r)^2 / c: what the motion of the IMU leaves of the radar. Delays are compared
//      by it: the noise of the radar adds the same for each, while (E4) prefers the delays for
//      which r^T A r is large.
// All hypotheses share A, b and c, so that evaluating one is cheap. Compare
// checks/velocity_check.hpp and propagate/moving_start.hpp.
#pragma once

#include <cstddef>
#include <vector>

#include "check/imu_path.hpp"
#include "check/scans.hpp"
#include "rio/options.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// Velocity of the radar in its own axes, from one scan.
struct RadarSpeed {
  Time time{0};
  Vector3d v_S = Vector3d::Zero();  ///< [m/s]
  double weight = 1.0;              ///< 1 for a good scan
  double inlier_share = 0.0;
};

inline constexpr double kModels = 0.1;  ///< errors of a good scan beyond the noise model [m/s]

/// One for each scan whose Dopplers agree on a velocity close to that of its neighbours. The fields
/// of view are not applied, since the axes may be wrong.
std::vector<RadarSpeed> radar_speeds(const Scans& scans, Options options);

/// The scans without the points that agree with the velocity of theirs.
/// @param max_doppler 0: it does not fold [m/s]
Scans without_points_of(const std::vector<RadarSpeed>& speeds, const Scans& scans,
                        double max_doppler);

/// The scans if the elevation of their points was counted from the zenith, of a radar that looks
/// along x.
Scans from_zenith(const Scans& scans);

/// (E3) of the windows with one shift of the stamps; the sum over them.
struct Agreement {
  Eigen::Matrix<double, 9, 9> A = Eigen::Matrix<double, 9, 9>::Zero();
  Eigen::Matrix<double, 9, 1> b = Eigen::Matrix<double, 9, 1>::Zero();
  double c = 0.0;
  double moved = 0.0;   ///< c with the lever arm as configured
  double weight = 0.0;  ///< sum of w
  std::size_t windows = 0;

  /// (E4); R may be improper: mirrored axes, or a flipped Doppler.
  double explained(const Matrix3d& R) const;
  /// r^T A r: how much the radar moves.
  double square(const Matrix3d& R) const;
  /// (E8)
  double residual(const Matrix3d& R) const { return square(R) * (1.0 - explained(R)); }
  /// Variation of the radar velocity that v_0 and g do not explain, in any axes: rms [m/s].
  double movement() const;
  /// The same of the velocity that the IMU measures [m/s].
  double movement_of_imu() const;
};

/// A rotation, and how well the motion shows it.
struct FittedRotation {
  Matrix3d R = Matrix3d::Identity();
  double sigma = 0.0;  ///< about the axis that is shown least [rad]
};

/// The minimum of (E3) near R, R <- R Exp(phi), by Gauss and Newton's method. Its covariance is
/// J / (3 n) times the inverse of the normal equations: one measurement for each axis of n windows,
/// as in (E6).
FittedRotation fitted_rotation(const Agreement& all, const Matrix3d& R);

/// (E5)
struct DopplerScale {
  double low;
  double high;

  DopplerScale(const Agreement& all, const Matrix3d& R)
      : low(all.b.dot(R.reshaped()) / all.c), high(all.square(R) / all.b.dot(R.reshaped())) {}
  /// @param error factor by which a right one may be off
  bool may_be_right(double error) const { return low < error && high > 1.0 / error; }
};

/// Change of the velocity of the IMU in two seconds that no tilt explains, whatever the radar says:
/// rms [m/s].
double movement_of(const std::vector<ImuSample>& samples, double gyro_unit, double accel_unit);

/// Less than this is noise, vibration and the biases of an IMU, in two seconds [m/s].
inline constexpr double kFlown = 0.2;

/// Noise of the velocities, from the deviation of three consecutive ones from a line: rms [m/s].
double noise(const std::vector<RadarSpeed>& speeds);

/// The longest time shift tested [s].
inline constexpr double kMostShift = 0.3;

/// For every shift. All shifts use the same scans, limited by kMostShift.
/// @param length of a window [s]
/// @param radar its place and the delay of its stamps
/// @param shifts added to its stamps besides that delay [s]
std::vector<Agreement> agreements(const std::vector<RadarSpeed>& speeds, const ImuPath& path,
                                  double length, const RadarOptions& radar,
                                  const std::vector<double>& shifts = {0.0});

/// (E6) from explained shares, in sigmas; 0 if it is not better.
double significance(double worse, double better, std::size_t windows);

}  // namespace rio::check
