// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/calibration_run.hpp"

#include <Eigen/Eigenvalues>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>

#include "rio/rio.hpp"
#include "rio/state/layout.hpp"

namespace rio::calibrate {

namespace {

/// The last sample that is not newer than `time`.
std::size_t sample_before(const std::vector<ImuSample>& imu, Time time) {
  std::size_t i = 0;
  while (i + 1 < imu.size() && imu[i + 1].time <= time) ++i;
  return i;
}

std::unique_ptr<Odometry> create(Options options, const std::optional<Start>& start) {
  options.start.static_alignment = !start;
  std::string why;
  std::unique_ptr<Odometry> odometry = Odometry::create(options, &why);
  if (odometry == nullptr) throw std::runtime_error(why);
  if (start && odometry->reset(start->state, start->covariance) != Status::kOk) {
    throw std::runtime_error("the start was refused");
  }
  return odometry;
}

}  // namespace

CalibrationRun run_calibration(const Recording& recording, const Options& options,
                               const std::optional<Start>& start, Time end) {
  const std::unique_ptr<Odometry> odometry = create(options, start);
  CalibrationRun run;
  odometry->on_scan([&run, &odometry] {
    run.states.push_back({odometry->at_scan(), odometry->covariance()});
    run.calibration = odometry->report().calibration;
  });
  std::size_t scan = 0;
  if (start) {
    while (scan < recording.scans.size() && recording.scans[scan].time < start->state.time) ++scan;
  }
  for (std::size_t i = start ? sample_before(recording.imu, start->state.time) : 0;
       i < recording.imu.size() && recording.imu[i].time <= end; ++i) {
    (void)odometry->add_imu(recording.imu[i]);  // its outcome is counted
    for (; scan < recording.scans.size() && recording.scans[scan].time <= recording.imu[i].time;
         ++scan) {
      (void)odometry->add_scan(recording.scans[scan]);
    }
  }
  if (run.states.empty()) {
    throw std::runtime_error(
        odometry->initialized()
            ? "no radar scan after the start"
            : "no start: the estimator found no standstill; `rio check` looks for the cause");
  }
  run.began_in_motion = odometry->counters().moving_starts > 0;
  run.velocity_resets = static_cast<int>(odometry->counters().velocity_resets);
  return run;
}

const Start& half_way(const std::vector<Start>& states) {
  const auto step = [&states](std::size_t i) {
    return states[i].state.v_WB.norm() *
           to_seconds(states[i].state.time - states[i - 1].state.time);
  };
  double whole = 0.0;
  for (std::size_t i = 1; i < states.size(); ++i) whole += step(i);
  double come = 0.0;
  std::size_t i = 1;
  while (i < states.size() && come < 0.5 * whole) come += step(i++);
  return states[i - 1];
}

Vector3d unshown_turn(const std::vector<Start>& states, const Quaternion& q_SB) {
  constexpr double kDirections = 0.005;  // e: rms of straight flights in the default room [rad]
  constexpr double kLeast = 1e-4;        // of S: below the noise of the velocities
  Matrix3d vv = Matrix3d::Zero();
  for (std::size_t i = 1; i < states.size(); ++i) {
    const Matrix3d R_SW = (q_SB * states[i].state.q_WB.conjugate()).toRotationMatrix();
    const Vector3d v_S = R_SW * states[i].state.v_WB;
    const Matrix3d noise_W = states[i].covariance.block<3, 3>(body::kVelocity, body::kVelocity);
    vv += to_seconds(states[i].state.time - states[i - 1].state.time) *
          (v_S * v_S.transpose() - R_SW * noise_W * R_SW.transpose());
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(vv);
  const Vector3d squares = axes.eigenvalues().cwiseMax(0.0);
  if (!(squares.sum() > 0.0)) return Vector3d::Zero();  // no motion: the estimator claims nothing
  const Vector3d S = 1.5 * (Vector3d::Ones() - squares / squares.sum()).cwiseMax(kLeast);
  const Vector3d excess =
      kDirections * kDirections * (S.cwiseInverse().array() - 1.0).cwiseMax(0.0);
  return axes.eigenvectors().cwiseAbs2() * excess;
}

}  // namespace rio::calibrate
