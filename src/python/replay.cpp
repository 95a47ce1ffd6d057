// SPDX-License-Identifier: BSD-3-Clause
// rio.replay: a recording through the estimator, everything as arrays.
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "options.hpp"
#include "recorder.hpp"
#include "replay.hpp"

namespace rio::python {

namespace {

template <std::size_t kSize>
py::array_t<double> table(std::vector<std::array<double, kSize>>&& rows) {
  const auto count = static_cast<py::ssize_t>(rows.size());
  return as_array<double>(std::move(rows), {count, static_cast<py::ssize_t>(kSize)});
}

py::list events_of(const std::vector<Event>& events) {
  py::list out;
  for (const Event& e : events) out.append(py::make_tuple(e.time, e.what, e.value));
  return out;
}

py::dict result_of(tools::Replayed&& replayed, Recorder&& recorder) {
  py::dict out;
  const auto count = static_cast<py::ssize_t>(recorder.times.size());
  out["times"] = as_array<std::int64_t>(std::move(recorder.times), {count});
  out["positions"] = table(std::move(recorder.positions));
  out["orientations"] = table(std::move(recorder.orientations));
  out["velocities"] = table(std::move(recorder.velocities));
  out["gyro_biases"] = table(std::move(recorder.gyro_biases));
  out["accel_biases"] = table(std::move(recorder.accel_biases));
  out["covariances"] = as_array<double>(
      std::move(recorder.covariances), {count, py::ssize_t{body::kSize}, py::ssize_t{body::kSize}});
  out["scans"] = as_rows(std::move(recorder.scans));
  out["innovations"] = as_rows(std::move(recorder.innovations));
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
  tools::Replayed replayed;
  {
    const py::gil_scoped_release release;
    tools::ViewOutputs nothing({});
    replayed = tools::run_replay(arguments, &nothing, [&](const Odometry& o) { recorder.add(o); });
  }
  return result_of(std::move(replayed), std::move(recorder));
}

}  // namespace

void bind_replay(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(ScanRow, time, radar, detections, detections_kept, static_detections,
                       ego_velocity, ego_velocity_valid, trails, clones, landmarks,
                       landmarks_matched, landmarks_added, landmarks_removed, at_rest, health,
                       quality);
  PYBIND11_NUMPY_DTYPE(LandmarkRow, time, position, covariance, last_seen);
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
        arguments.no_check = !check;
        return replayed_arrays(arguments);
      },
      py::arg("path"), py::arg("texts"), py::arg("preset"), py::arg("init"), py::arg("map"),
      py::arg("sensors"), py::arg("dataset"), py::arg("barometer"), py::arg("check"));
}

}  // namespace rio::python
