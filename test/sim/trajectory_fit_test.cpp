// SPDX-License-Identifier: BSD-3-Clause
// Recorded paths are samples of flights that are known exactly, so that the fit can be judged.
#include "rio/sim/trajectory_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rio/core/so3.hpp"
#include "rio/eval/alignment.hpp"
#include "rio/sim/random.hpp"
#include "sim/flights.hpp"
#include "support/temp_dir.hpp"

namespace rio::sim {
namespace {

using Poses = std::vector<eval::StampedPose>;
constexpr Time kEpoch{1'403'715'273'262'140'000};

const Trajectory& flown() {
  static const Trajectory trajectory = random_flight(3, {.length = 40.0});
  return trajectory;
}

/// The poses of `trajectory` between two instants, stamped from kEpoch on.
Poses record(double rate_hz, double begin = 0.0, double end = flown().duration(),
             const Trajectory& trajectory = flown()) {
  Poses poses;
  for (int i = 0; begin + i / rate_hz <= end; ++i) {
    const NavState nav = trajectory.at(begin + i / rate_hz).nav;
    poses.push_back({kEpoch + from_seconds(i / rate_hz), nav.p_WB, nav.q_WB});
  }
  return poses;
}

/// `poses` seen from a world R whose axes and origin are elsewhere: p_R = T_RW p_W.
Poses moved(Poses poses, const Pose& T_RW) {
  for (eval::StampedPose& pose : poses) pose = eval::transformed(T_RW, pose);
  return poses;
}

/// `poses` of a body whose axes are turned: q_FB maps them to forward-left-up.
Poses mounted(Poses poses, const Matrix3d& R_FB) {
  for (eval::StampedPose& pose : poses) pose.q = pose.q * Quaternion(R_FB);
  return poses;
}

/// Largest distance [m] and angle [rad] between `fit` and the poses it was made from.
struct FitError {
  double position = 0.0;
  double attitude = 0.0;
};
FitError error(const TrajectoryFit& fit, const Poses& poses) {
  FitError worst;
  for (const eval::StampedPose& pose : poses) {
    const double t = fit.first + to_seconds(pose.time - poses.front().time);
    const NavState nav = fit.trajectory.at(t).nav;
    const Vector3d p_R = fit.T_RW.rotation * nav.p_WB + fit.T_RW.translation;
    const Quaternion q_RB = fit.T_RW.rotation * nav.q_WB * fit.q_FB;
    worst.position = std::max(worst.position, (p_R - pose.p).norm());
    worst.attitude = std::max(worst.attitude, q_RB.angularDistance(pose.q));
  }
  return worst;
}

void expect_same_trajectory(const Trajectory& a, const Trajectory& b) {
  for (double t = 0.0; t < a.duration(); t += 0.37) {
    ASSERT_LT((a.at(t).nav.p_WB - b.at(t).nav.p_WB).norm(), 1e-9) << t;
    ASSERT_LT(a.at(t).nav.q_WB.angularDistance(b.at(t).nav.q_WB), 1e-7) << t;
  }
}

std::string failure(const Poses& poses, const PathOptions& options = {}) {
  return test::error_of([&] { fit_trajectory(poses, options); });
}

TEST(TrajectoryFit, RecoversAKnownFlight) {
  const Trajectory& truth = flown();
  for (const double rate_hz : {20.0, 200.0}) {
    const Poses poses = record(rate_hz);
    const TrajectoryFit fit = fit_trajectory(poses);
    const FitError worst = error(fit, poses);
    EXPECT_LT(worst.position, 1e-3) << rate_hz;  // finer knots than the truth's: nothing is lost
    EXPECT_LT(worst.attitude, 0.2 * kDegree) << rate_hz;  // second derivative of the above
    EXPECT_LT(fit.rms, 2e-4) << rate_hz;
    EXPECT_NEAR(fit.trajectory.length(), truth.length(), 0.01) << rate_hz;
    // recorded from its standstill on: both worlds are the same, and the motion between samples too
    EXPECT_LT(fit.T_RW.translation.norm(), 1e-3);
    for (double t = 4.0; t < truth.duration() - 2.0; t += 0.0371) {
      const Trajectory::Point a = truth.at(t);
      const Trajectory::Point b = fit.trajectory.at(fit.first + t);
      ASSERT_LT((a.nav.v_WB - b.nav.v_WB).norm(), 5e-3) << t;
      ASSERT_LT((a.gyro_B - b.gyro_B).norm(), 0.1) << t;
    }
  }
}

TEST(TrajectoryFit, AveragesOverNoise) {
  const Poses exact = record(100.0);
  Poses noisy = exact;
  Random random(1, 1);
  constexpr double kSigma = 5e-3;  // [m] per axis
  for (eval::StampedPose& pose : noisy) pose.p += kSigma * random.normal3();
  const TrajectoryFit fit = fit_trajectory(noisy);
  // 20 samples a knot: the spline takes up 1/20 of the variance
  EXPECT_NEAR(fit.rms / (std::sqrt(3.0) * kSigma), std::sqrt(0.95), 0.02);
  EXPECT_LT(error(fit, exact).position, 5.0 * kSigma * std::sqrt(3.0 / 20.0));
}

TEST(TrajectoryFit, RotatedMountingGivesTheSameFlight) {
  const Poses poses = record(50.0, 2.0);
  const TrajectoryFit fit = fit_trajectory(poses);
  EXPECT_TRUE(fit.q_FB.isApprox(Quaternion::Identity(), 0.0));
  const Vector3d x = Vector3d::UnitX();
  const Vector3d y = Vector3d::UnitY();
  const Vector3d z = Vector3d::UnitZ();
  struct Case {
    Vector3d forward, left, up;  // in the recorded axes
  };
  // the documented table; the first line is EuRoC's IMU
  for (const Case& mount : {Case{z, -y, x}, Case{z, y, -x}, Case{z, x, y}, Case{z, -x, -y},
                            Case{x, y, z}, Case{x, -y, -z}}) {
    Matrix3d R_FB;
    R_FB << mount.forward.transpose(), mount.left.transpose(), mount.up.transpose();
    ASSERT_NEAR(R_FB.determinant(), 1.0, 1e-15);
    const TrajectoryFit other = fit_trajectory(mounted(poses, R_FB));
    EXPECT_TRUE(other.q_FB.toRotationMatrix().isApprox(R_FB, 1e-12));
    expect_same_trajectory(fit.trajectory, other.trajectory);
  }
}

TEST(TrajectoryFit, StartsAndEndsAtRestWhereverItWasRecorded) {
  const Pose T_RW{quaternion_exp({0.0, 0.0, 2.5}), {7.0, -20.0, 1.5}};
  const double middle = 0.5 * flown().duration();
  // in flight at both ends, at more than walking pace
  const Poses poses = moved(record(50.0, middle - 5.0, middle + 7.0), T_RW);
  ASSERT_GT((poses[25].p - poses[0].p).norm(), 0.25);
  const Time start(1'700'000'000'000'000'000);
  const PathOptions options{.stand_before = 3.0, .stand_after = 1.0};
  const TrajectoryFit fit = fit_trajectory(poses, options, start);
  EXPECT_LT(error(fit, poses).position, 2e-3);
  EXPECT_EQ(fit.trajectory.start(), start);

  const double end = fit.trajectory.duration();
  EXPECT_EQ(fit.trajectory.at(0.0).nav.p_WB, Vector3d::Zero());
  EXPECT_TRUE(fit.trajectory.at(0.0).nav.q_WB.isApprox(Quaternion::Identity(), 0.0));
  for (const double t : {0.0, 1.5, 3.0, end - 1.0, end}) {
    const Trajectory::Point point = fit.trajectory.at(t);
    EXPECT_LT(point.nav.v_WB.norm(), 1e-12) << t;
    EXPECT_LT(point.gyro_B.norm(), 1e-12) << t;
    EXPECT_LT((point.accel_B - Vector3d(0.0, 0.0, 9.81)).norm(), 1e-11) << t;
    EXPECT_FALSE(point.flying) << t;
  }
  // the leads are gentle: no faster than the recording, tilted less than at 3 m/s^2
  const double fastest = extent(fit.trajectory, fit.first, fit.first + 12.0).fastest;
  for (double t = 0.0; t < end; t += 0.01) {
    if (t > fit.first && t < fit.first + 12.0) continue;
    EXPECT_LT(fit.trajectory.at(t).nav.v_WB.norm(), fastest) << t;
    EXPECT_LT(fit.trajectory.at(t).accel_W.norm(), 3.0) << t;
  }
}

TEST(TrajectoryFit, FromRestItStandsAtTheFirstAndAtTheLastPoint) {
  const double end = flown().duration();
  const Pose T_RW{quaternion_exp({0.0, 0.0, -1.0}), {1.0, 2.0, 3.0}};
  const Poses poses = moved(record(50.0, 1.0, end - 0.5), T_RW);
  const TrajectoryFit fit = fit_trajectory(poses);
  EXPECT_LT((fit.T_RW.translation - T_RW.translation).norm(), 1e-3);
  EXPECT_LT(fit.T_RW.rotation.angularDistance(T_RW.rotation), 1e-3);
  const Vector3d last = fit.trajectory.at(fit.trajectory.duration()).nav.p_WB;
  EXPECT_LT((last - flown().at(end).nav.p_WB).norm(), 1e-3);
}

TEST(TrajectoryFit, BridgesAGap) {
  const double begin = 20.0;
  const Poses poses = record(50.0);
  const TrajectoryFit whole = fit_trajectory(poses);
  for (const double gap : {0.6, 1.0, 5.0}) {
    Poses rest = poses;
    std::erase_if(rest, [&](const eval::StampedPose& pose) {
      const double t = to_seconds(pose.time - kEpoch);
      return t >= begin && t <= begin + gap;
    });
    const TrajectoryFit fit = fit_trajectory(rest);
    EXPECT_LT(error(fit, rest).position, 2e-3) << gap;  // the rest does not suffer
    double off = 0.0;
    double acceleration = 0.0;
    for (double t = begin; t < begin + gap; t += 0.01) {
      const Trajectory::Point bridge = fit.trajectory.at(fit.first + t);
      const Trajectory::Point point = whole.trajectory.at(whole.first + t);
      off = std::max(off, (bridge.nav.p_WB - point.nav.p_WB).norm());
      acceleration = std::max(acceleration, bridge.accel_W.norm());
    }
    // a bridge cannot know the turns of the flight (1.4 m/s at most), but joins both ends
    EXPECT_LT(off, gap < 2.0 ? 0.05 : 0.5 * 1.4 * gap) << gap;
    EXPECT_LT(acceleration, 5.0) << gap;
  }
}

TEST(TrajectoryFit, TurnsThroughHalfATurnWithoutAJump) {
  // on the spot, three whole turns at 0.8 rad/s, as yaw in (-pi, pi] and with quaternions of
  // either sign
  Poses poses;
  for (int i = 0; i < 1200; ++i) {
    const double t = i * 0.02;
    Quaternion q = quaternion_exp({0.0, 0.0, 0.8 * t});
    if (i % 2 == 1) q.coeffs() *= -1.0;
    poses.push_back({kEpoch + from_seconds(t), Vector3d(0.3 * t, 0.0, 1.0), q});
  }
  const TrajectoryFit fit = fit_trajectory(poses);
  // the leads speed up by 0.2 m/s^2, 0.02 rad of tilt, which ends within a knot of the samples
  EXPECT_LT(error(fit, poses).attitude, 0.02);
  for (double t = 0.0; t < fit.trajectory.duration(); t += 0.01) {
    ASSERT_LT(fit.trajectory.at(t).gyro_B.norm(), 1.2) << t;
  }
  for (double t = 1.0; t < 23.0; t += 0.01) {
    ASSERT_NEAR(fit.trajectory.at(fit.first + t).gyro_B.z(), 0.8, 1e-3) << t;
  }
}

TEST(TrajectoryFit, RefusesBadRecordings) {
  const Poses good = record(20.0, 5.0, 15.0);
  ASSERT_EQ(failure(good), "");
  EXPECT_PRED2(test::contains, failure({}), "0 poses");
  EXPECT_PRED2(test::contains, failure(record(0.8, 5.0, 15.0)), "9 poses");
  EXPECT_PRED2(test::contains, failure(record(20.0, 5.0, 6.9)), "s long");
  const struct {
    void (*damage)(Poses& poses);
    const char* said;
  } damages[] = {
      {[](Poses& p) { p[7].time = p[6].time; }, "pose 8 is not later"},
      {[](Poses& p) { std::swap(p[7], p[20]); }, "pose 9 is not later"},
      {[](Poses& p) { p[3].p.y() = NAN; }, "pose 4 is not finite"},
      {[](Poses& p) { p[3].p.z() = INFINITY; }, "pose 4 is not finite"},
      {[](Poses& p) { p[3].q.w() = NAN; }, "pose 4 is not finite"},
      {[](Poses& p) { p[3].q.coeffs().setZero(); }, "unit quaternion"},
      {[](Poses& p) { p[90].p.z() += 5.0; }, "falls freely"},
  };
  for (const auto& [damage, said] : damages) {
    Poses poses = good;
    damage(poses);
    EXPECT_PRED2(test::contains, failure(poses), said);
  }
}

TEST(TrajectoryFit, NeedsAnUprightAxis) {
  const Poses poses = record(20.0);
  const auto pitched = [&](double degrees) {
    return mounted(poses, gamma(0, Vector3d(0.0, degrees * kDegree, 0.0)));
  };
  // the flight itself is level on average to a degree
  EXPECT_PRED2(test::contains, failure(pitched(38.0)), "35 deg");
  EXPECT_PRED2(test::contains, failure(pitched(52.0)), "35 deg");
  // a fixed pitch changes nothing
  expect_same_trajectory(fit_trajectory(poses).trajectory,
                         fit_trajectory(pitched(32.0)).trajectory);
}

TEST(TrajectoryFit, SpacingIsTheOptions) {
  const Trajectory truth =
      random_flight(3, {.length = 40.0, .max_speed = 3.0, .knot_spacing = 0.25});
  const Poses poses = record(100.0, 0.0, truth.duration(), truth);
  PathOptions coarse;
  coarse.fit_spacing = 1.0;
  EXPECT_GT(fit_trajectory(poses, coarse).rms, 20.0 * fit_trajectory(poses).rms);
}

}  // namespace
}  // namespace rio::sim
