// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/calibration_run.hpp"

#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>

#include "rio/rio.hpp"

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

}  // namespace rio::calibrate
