// SPDX-License-Identifier: BSD-3-Clause
// rio.replay: a recording through the estimator, everything as arrays.
#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "replay.hpp"

namespace rio::python {

namespace {

/// A row of Result.scans.
struct ScanRow {
  std::int64_t time;  ///< [ns]
  std::uint8_t radar;
  std::int32_t detections;
  std::int32_t detections_kept;
  std::int32_t static_detections;
  double ego_velocity[3];  ///< radar axes [m/s]
  bool ego_velocity_valid;
  std::int32_t trails;
  std::int32_t clones;
  std::int32_t landmarks;
  std::int32_t landmarks_matched;
  std::int32_t landmarks_added;
  std::int32_t landmarks_removed;
  bool at_rest;
  std::uint8_t health;                                      ///< index of rio.HEALTH_STATES
  std::int32_t quality;                                     ///< 0 to 100
  std::array<double, kCalibrationCount> calibration;        ///< order of rio.CALIBRATION, SI
  std::array<double, kCalibrationCount> calibration_sigma;  ///< 0 = not estimated
};

struct Event {
  std::int64_t time;  ///< of the scan [ns]
  std::string what;
  double value;  ///< of a re-opened position its sigma [m]; else zero
};

/// Collects what a replay estimates, scan by scan, in vectors that numpy takes over.
class Recorder {
 public:
  /// After each processed scan. Of scans at the same instant, as of several radars, the last one is
  /// the estimate of that instant, as in the files that `rio replay` writes.
  void add(const Odometry& odometry) {
    add_state(odometry.at_scan(), odometry.covariance());
    add_scan(odometry.report());
    add_innovations(odometry.report(), &innovations);
    add_points(odometry, &points);
    add_landmarks(odometry, &landmark_states);
    add_events(odometry.report(), odometry.counters());
  }

  std::vector<std::int64_t> times;
  std::vector<std::array<double, 3>> positions;
  std::vector<std::array<double, 4>> orientations;
  std::vector<std::array<double, 3>> velocities;
  std::vector<std::array<double, 3>> gyro_biases;
  std::vector<std::array<double, 3>> accel_biases;
  std::vector<std::array<double, body::kSize * body::kSize>> covariances;
  std::vector<ScanRow> scans;
  std::vector<InnovationRow> innovations;
  std::vector<PointRow> points;
  std::vector<LandmarkRow> landmark_states;
  std::vector<Event> events;

 private:
  void add_state(const NavState& state, const BodyCovariance& covariance) {
    const std::int64_t time = state.time.count();
    if (times.empty() || times.back() != time) {
      times.push_back(time);
      positions.emplace_back();
      orientations.emplace_back();
      velocities.emplace_back();
      gyro_biases.emplace_back();
      accel_biases.emplace_back();
      covariances.emplace_back();
    }
    positions.back() = xyz(state.p_WB);
    orientations.back() = wxyz(state.q_WB);
    velocities.back() = xyz(state.v_WB);
    gyro_biases.back() = xyz(state.gyro_bias);
    accel_biases.back() = xyz(state.accel_bias);
    Eigen::Map<Eigen::Matrix<double, body::kSize, body::kSize, Eigen::RowMajor>>(
        covariances.back().data()) = covariance;
  }

  void add_scan(const UpdateReport& r) {
    const Vector3d& v = r.ego_velocity_S;
    scans.push_back({r.time.count(),
                     static_cast<std::uint8_t>(r.radar),
                     r.detections,
                     r.detections_kept,
                     r.static_detections,
                     {v.x(), v.y(), v.z()},
                     r.ego_velocity_valid,
                     r.trails,
                     r.clones,
                     r.landmarks,
                     r.landmarks_matched,
                     r.landmarks_added,
                     r.landmarks_removed,
                     r.at_rest,
                     static_cast<std::uint8_t>(r.health.state),
                     r.health.quality,
                     {},
                     {}});
    for (std::size_t i = 0; i < kCalibrationCount; ++i) {
      scans.back().calibration[i] = r.calibration[i].value;
      scans.back().calibration_sigma[i] = r.calibration[i].sigma;
    }
  }

  void add_events(const UpdateReport& r, const Counters& counters) {
    const auto add = [&](const std::string& what, double value = 0.0) {
      events.push_back({r.time.count(), what, value});
    };
    if (scans.size() == 1) add("first scan");
    if (r.imu_gap) add("gap of the IMU");
    if (r.mounting_unknown) add("mounting unknown");
    if (r.velocity_reset) add("velocity replaced");
    if (r.attitude_reset) add("attitude or biases replaced");
    if (r.position_reopened > 0.0) add("position re-opened", r.position_reopened);
    if (counters.clock_restarts != clock_restarts_) add("clock of the sensors restarted");
    if (counters.restarts != restarts_) add("tilt lost and found again");
    if (r.at_rest != at_rest_) add(r.at_rest ? "rest begins" : "rest ends");
    if (r.health.state != health_) add(std::string("health: ") + to_string(r.health.state));
    clock_restarts_ = counters.clock_restarts;
    restarts_ = counters.restarts;
    at_rest_ = r.at_rest;
    health_ = r.health.state;
  }

  HealthState health_ = HealthState::kInitializing;  ///< the last one
  bool at_rest_ = false;
  std::uint64_t clock_restarts_ = 0;
  std::uint64_t restarts_ = 0;
};

/// Lets Python handle its signals, so that Ctrl-C ends a long replay.
class Signals {
 public:
  void poll() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point next_;
};

py::list events_of(const std::vector<Event>& events) {
  py::list out;
  for (const Event& e : events) out.append(py::make_tuple(e.time, e.what, e.value));
  return out;
}

py::dict result_of(tools::Replayed&& replayed, Recorder&& recorder) {
  py::dict out;
  const auto count = static_cast<py::ssize_t>(recorder.times.size());
  out["times"] = as_rows(std::move(recorder.times));
  out["positions"] = as_table(std::move(recorder.positions));
  out["orientations"] = as_table(std::move(recorder.orientations));
  out["velocities"] = as_table(std::move(recorder.velocities));
  out["gyro_biases"] = as_table(std::move(recorder.gyro_biases));
  out["accel_biases"] = as_table(std::move(recorder.accel_biases));
  out["covariances"] = as_array<double>(
      std::move(recorder.covariances), {count, py::ssize_t{body::kSize}, py::ssize_t{body::kSize}});
  out["scans"] = as_rows(std::move(recorder.scans));
  out["innovations"] = as_rows(std::move(recorder.innovations));
  out["points"] = as_rows(std::move(recorder.points));
  out["landmark_states"] = as_rows(std::move(recorder.landmark_states));
  out["events"] = events_of(recorder.events);
  out["summary"] = replayed.summary.json();
  out["verdict"] = replayed.summary.health.verdict();
  out["lost"] = replayed.summary.health.lost();
  out["notes"] = replayed.notes;
  out["damage"] = replayed.damage;
  return out;
}

py::dict replayed_arrays(const tools::ReplayArguments& arguments) {
  Recorder recorder;
  Signals signals;
  tools::Replayed replayed;
  {
    const py::gil_scoped_release release;
    tools::ViewOutputs nothing({});
    replayed = tools::run_replay(arguments, &nothing, [&](const Odometry& o) {
      recorder.add(o);
      signals.poll();
    });
  }
  return result_of(std::move(replayed), std::move(recorder));
}

}  // namespace

void bind_replay(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(ScanRow, time, radar, detections, detections_kept, static_detections,
                       ego_velocity, ego_velocity_valid, trails, clones, landmarks,
                       landmarks_matched, landmarks_added, landmarks_removed, at_rest, health,
                       quality, calibration, calibration_sigma);
  module.def(
      "replay",
      [](const std::string& path, const std::vector<std::string>& texts, const std::string& preset,
         const std::string& init, const std::string& map, const std::string& sensors,
         const std::string& dataset, bool barometer, bool check) {
        tools::ReplayArguments arguments;
        arguments.dataset = path;
        arguments.estimator = estimator_of(texts, preset);
        arguments.init = init;
        arguments.how.map = map;
        arguments.how.sensors = sensors;
        arguments.how.dataset = dataset;
        arguments.barometer = barometer;
        arguments.findings = check;
        arguments.silent = true;
        return replayed_arrays(arguments);
      },
      py::arg("path"), py::arg("texts"), py::arg("preset"), py::arg("init"), py::arg("map"),
      py::arg("sensors"), py::arg("dataset"), py::arg("barometer"), py::arg("check"));
}

}  // namespace rio::python
