// SPDX-License-Identifier: BSD-3-Clause
// The estimator call by call: rio.Odometry.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bindings.hpp"

namespace rio::python {

namespace {

using Points = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The columns of points, in the order of those of a data.csv.
constexpr std::array kColumns = {"x",
                                 "y",
                                 "z",
                                 "doppler",
                                 "snr",
                                 "noise",
                                 "sigma_range",
                                 "sigma_azimuth",
                                 "sigma_elevation",
                                 "sigma_doppler"};
constexpr std::size_t kRequired = 4;

double& column(RadarDetection& d, std::size_t i) {
  double* const columns[] = {&d.point_S.x(),     &d.point_S.y(),  &d.point_S.z(), &d.range_rate,
                             &d.snr_db,          &d.noise_db,     &d.sigma_range, &d.sigma_azimuth,
                             &d.sigma_elevation, &d.sigma_doppler};
  return *columns[i];
}

/// Lists and other sequences are values by row; a pandas.DataFrame is records, by its names. Points
/// with a masked value are left out: it is not finite.
py::array array_of(const py::object& points) {
  if (py::hasattr(points, "filled")) {
    const py::object names = points.attr("dtype").attr("names");
    if (names.is_none()) return unmasked(points);
    py::list floats;  // whole numbers have no NaN
    for (const py::handle& name : names) floats.append(py::make_tuple(name, "f8"));
    return points.attr("astype")(floats).attr("filled")(std::nan(""));
  }
  if (py::hasattr(points, "to_records")) {
    return points.attr("to_records")(py::arg("index") = false);
  }
  return py::array(points);
}

/// N rows of 4 to 10 columns.
void read_matrix(const py::array& points, RadarScan* scan) {
  const Points values(points);
  const auto columns = values.ndim() == 2 ? static_cast<std::size_t>(values.shape(1)) : 0;
  if (columns < kRequired || columns > kColumns.size()) {
    throw py::value_error(
        "points: N x 4 to N x 10 values are expected: x, y, z [m], doppler [m/s], "
        "snr, noise [dB], sigmas of range, azimuth, elevation, doppler");
  }
  scan->detections.resize(static_cast<std::size_t>(values.shape(0)));
  const auto at = values.unchecked<2>();
  for (std::size_t i = 0; i < scan->detections.size(); ++i) {
    for (std::size_t k = 0; k < columns; ++k) {
      column(scan->detections[i], k) = at(static_cast<py::ssize_t>(i), static_cast<py::ssize_t>(k));
    }
  }
}

/// A structured array with fields of those names; the first four are required.
void read_fields(const py::array& points, RadarScan* scan) {
  if (points.ndim() != 1) throw py::value_error("points: one row of records is expected");
  std::vector<std::string> names;
  const py::object columns = points.dtype().attr("names");
  for (const py::handle name : columns) names.push_back(py::str(name));
  for (const std::string& name : names) {
    if (std::find(kColumns.begin(), kColumns.end(), name) == kColumns.end()) {
      throw py::value_error("points: unknown field \"" + name + "\"");
    }
  }
  scan->detections.resize(static_cast<std::size_t>(points.shape(0)));
  for (std::size_t k = 0; k < kColumns.size(); ++k) {
    if (std::find(names.begin(), names.end(), kColumns[k]) == names.end()) {
      if (k < kRequired) {
        throw py::value_error("points: no field \"" + std::string(kColumns[k]) + "\"");
      }
      continue;
    }
    const py::object field = points[kColumns[k]];
    const Points values(field);
    const auto at = values.unchecked<1>();
    for (std::size_t i = 0; i < scan->detections.size(); ++i) {
      column(scan->detections[i], k) = at(static_cast<py::ssize_t>(i));
    }
  }
}

RadarScan scan_of(std::int64_t time, const py::object& given) {
  const py::array points = array_of(given);
  RadarScan scan;
  scan.time = Time(time);
  if (!py::isinstance<py::none>(points.dtype().attr("names"))) {
    read_fields(points, &scan);
  } else if (points.size() > 0) {
    read_matrix(points, &scan);
  }
  return scan;
}

std::unique_ptr<Odometry> create(const std::vector<std::string>& texts, const std::string& preset,
                                 const std::string& sensors,
                                 const std::vector<std::string>& auxiliary) {
  Options options = make_options(texts, preset, sensors);
  declare_auxiliary(auxiliary, &options);
  std::string why;
  auto odometry = Odometry::create(options, &why);
  if (odometry == nullptr) throw std::runtime_error(why);
  return odometry;
}

py::dict counters_of(const Odometry& odometry) {
  using namespace py::literals;
  const Counters& c = odometry.counters();
  return py::dict("imu_samples"_a = c.imu_samples, "imu_stale"_a = c.imu_stale,
                  "imu_ahead"_a = c.imu_ahead, "imu_non_finite"_a = c.imu_non_finite,
                  "imu_out_of_range"_a = c.imu_out_of_range, "imu_frozen"_a = c.imu_frozen,
                  "imu_gaps"_a = c.imu_gaps, "clock_restarts"_a = c.clock_restarts,
                  "radar_clock_steps"_a = c.radar_clock_steps, "scans"_a = c.scans,
                  "scans_late"_a = c.scans_late, "scans_ahead"_a = c.scans_ahead,
                  "scans_duplicate"_a = c.scans_duplicate, "scans_overflow"_a = c.scans_overflow,
                  "scans_non_finite"_a = c.scans_non_finite,
                  "detections_non_finite"_a = c.detections_non_finite,
                  "scans_uninitialized"_a = c.scans_uninitialized, "aiding"_a = c.aiding,
                  "aiding_late"_a = c.aiding_late, "aiding_ahead"_a = c.aiding_ahead,
                  "aiding_overflow"_a = c.aiding_overflow, "updates_failed"_a = c.updates_failed,
                  "moving_starts"_a = c.moving_starts, "velocity_resets"_a = c.velocity_resets,
                  "attitude_resets"_a = c.attitude_resets, "restarts"_a = c.restarts,
                  "position_reopened"_a = c.position_reopened);
}

/// Those that are calling their on_scan, and the thread that does.
std::map<const Odometry*, std::thread::id>& telling() {
  static std::map<const Odometry*, std::thread::id> all;  // guarded by the GIL
  return all;
}

/// The call is kept by the Python object, where the garbage collector sees a cycle.
constexpr const char* kOnScan = "_on_scan";

/// What the call raises waits in Python until added() throws it; meanwhile no further call.
void tell(py::handle self) noexcept {
  if (PyErr_Occurred() != nullptr) return;
  const auto* const odometry = self.cast<const Odometry*>();
  telling()[odometry] = std::this_thread::get_id();
  try {
    (void)self.attr(kOnScan)(self);
  } catch (py::error_already_set& raised) {
    raised.restore();
  }
  telling().erase(odometry);
}

void set_on_scan(const py::object& self, const py::object& call) {
  auto& odometry = self.cast<Odometry&>();
  await_on_scan(odometry);
  if (!call.is_none() && PyCallable_Check(call.ptr()) == 0) {
    throw py::type_error("on_scan: a function of the estimator, or None, is expected");
  }
  self.attr(kOnScan) = call;
  std::function<void()> told;
  if (!call.is_none()) told = [it = self.ptr()] { tell(it); };
  odometry.on_scan(std::move(told));
}

template <class Row, void (*kAdd)(const Odometry&, std::vector<Row>*)>
py::array rows_of(const Odometry& odometry) {
  std::vector<Row> rows;
  kAdd(odometry, &rows);
  return as_rows(std::move(rows));
}

/// What there is to look at.
void bind_views(py::class_<Odometry>* odometry) {
  odometry->def("initialized", &Odometry::initialized, "Whether there is an estimate.")
      .def(
          "now", [](const Odometry& o) { return NavState(o.now()); },
          "Estimate at the newest IMU sample.")
      .def(
          "at_scan", [](const Odometry& o) { return NavState(o.at_scan()); },
          "Estimate at the newest processed scan.")
      .def(
          "covariance", [](const Odometry& o) { return Eigen::MatrixXd(o.covariance()); },
          "Covariance of at_scan(): (15, 15), errors of attitude (body axes), position, velocity,\n"
          "gyro bias, accelerometer bias, SI units.")
      .def(
          "covariance_now", [](const Odometry& o) { return Eigen::MatrixXd(o.covariance_now()); },
          "Covariance of now(), same order.")
      .def("points", &rows_of<PointRow, add_points>,
           "The points of the last scan, fields as of Result.points; none if it was not used.")
      .def("landmarks", &rows_of<LandmarkRow, add_landmarks>,
           "The landmarks in the state, fields as of Result.landmark_states.")
      .def("counters", &counters_of, "What was taken and what was refused, as a dict.");
}

}  // namespace

void await_on_scan(const Odometry& odometry) {
  for (;;) {
    const auto told = telling().find(&odometry);
    if (told == telling().end()) return;
    if (told->second == std::this_thread::get_id()) {
      throw std::runtime_error("on_scan: what it calls must not change the estimator");
    }
    {
      const py::gil_scoped_release others;
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

void bind_odometry(py::module_& module) {
  bind_report(module);
  // every result is a copy: the estimator changes what it refers to with the next call
  py::class_<Odometry> odometry(module, "Odometry");
  odometry
      .def(py::init(&create), py::arg("texts"), py::arg("preset") = "", py::arg("sensors") = "",
           py::arg("auxiliary") = std::vector<std::string>())
      .def(
          "add_imu",
          [](Odometry& o, std::int64_t time, const Given<Vector3d>& gyro,
             const Given<Vector3d>& accel) {
            return added(o, [&](Odometry& to) { return to.add_imu({Time(time), gyro, accel}); });
          },
          py::arg("time").noconvert(), py::arg("gyro"), py::arg("accel"),
          "Takes one IMU sample.\n\n"
          "time: int, nanoseconds; gyro: (3,) body axes [rad/s]; accel: (3,) specific force, body\n"
          "axes [m/s^2], +g upwards at rest")
      .def(
          "add_scan",
          [](Odometry& o, std::int64_t time, const py::object& points, std::size_t radar) {
            const RadarScan scan = scan_of(time, points);
            return added(o, [&](Odometry& to) { return to.add_scan(scan, radar); });
          },
          py::arg("time").noconvert(), py::arg("points"), py::arg("radar") = 0,
          "Takes one radar scan.\n\n"
          "time: int, nanoseconds, the middle of the chirps\n"
          "points: N x 4 to N x 10: x, y, z [m], radar axes; doppler [m/s], positive = receding;\n"
          "snr, noise [dB]; sigmas of range [m], azimuth, elevation [rad], doppler [m/s], 0 =\n"
          "that of the options. Or a structured array or DataFrame with fields x, y, z, doppler,\n"
          "snr, noise, sigma_range, sigma_azimuth, sigma_elevation, sigma_doppler, the first four\n"
          "required. Points with a masked value are left out.")
      .def(
          "reset",
          [](Odometry& o, const std::optional<NavState>& state,
             const std::optional<Given<Eigen::MatrixXd>>& P) {
            if (state.has_value() != P.has_value()) {
              throw py::type_error("reset: a state and its covariance are expected, or neither");
            }
            if (P && (P->value.rows() != body::kSize || P->value.cols() != body::kSize)) {
              throw py::value_error("covariance: 15 x 15 values are expected");
            }
            return added(o, [&](Odometry& to) {
              if (state) return to.reset(*state, BodyCovariance(P->value));
              to.reset();
              return Status::kOk;
            });
          },
          py::arg("state") = py::none(), py::arg("covariance") = py::none(),
          "Starts from a known state; without one discards everything and waits for a\n"
          "standstill, as a new estimator does.\n\ncovariance: (15, 15), order of covariance()")
      .def("on_scan", &set_on_scan, py::arg("call"),
           "From now on call(odometry) is called for every scan that was processed, within the\n"
           "add_imu() or add_scan() that did it, which raises what it raises, once its data are\n"
           "taken. It may look, but not add anything to this estimator; other threads that do\n"
           "wait for it. None ends it.");
  bind_views(&odometry);
  bind_aids(&odometry);
  bind_values(module);
}

}  // namespace rio::python
