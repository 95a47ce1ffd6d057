// SPDX-License-Identifier: BSD-3-Clause
// The estimator call by call: rio.Odometry, its state, report and health.
#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "options.hpp"
#include "rio/rio.hpp"

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

/// N rows of 4 to 10 columns.
void read_matrix(const py::array& points, RadarScan* scan) {
  const Points values = Points::ensure(points);
  if (!values) throw py::error_already_set();
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
  for (const py::handle name : points.dtype().attr("names")) names.push_back(py::str(name));
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
    const Points values = Points::ensure(field);
    if (!values) throw py::error_already_set();
    const auto at = values.unchecked<1>();
    for (std::size_t i = 0; i < scan->detections.size(); ++i) {
      column(scan->detections[i], k) = at(static_cast<py::ssize_t>(i));
    }
  }
}

RadarScan scan_of(std::int64_t time, const py::array& points) {
  RadarScan scan;
  scan.time = Time(time);
  if (points.size() == 0) return scan;
  if (py::isinstance<py::none>(points.dtype().attr("names"))) {
    read_matrix(points, &scan);
  } else {
    read_fields(points, &scan);
  }
  return scan;
}

NavState state_of(std::int64_t time, const Vector3d& position, const Eigen::Vector4d& orientation,
                  const Vector3d& velocity, const Vector3d& gyro_bias, const Vector3d& accel_bias) {
  NavState state;
  state.time = Time(time);
  state.p_WB = position;
  state.q_WB = Quaternion(orientation[0], orientation[1], orientation[2], orientation[3]);
  state.v_WB = velocity;
  state.gyro_bias = gyro_bias;
  state.accel_bias = accel_bias;
  return state;
}

Eigen::Vector4d orientation_of(const NavState& state) {
  const std::array<double, 4> q = wxyz(state.q_WB);
  return {q[0], q[1], q[2], q[3]};
}

std::unique_ptr<Odometry> create(const std::vector<std::string>& texts, const std::string& preset,
                                 const std::string& sensors) {
  std::string why;
  auto odometry = Odometry::create(make_options(texts, preset, sensors), &why);
  if (odometry == nullptr) throw std::runtime_error(why);
  return odometry;
}

void bind_status(py::module_& module) {
  py::enum_<Status>(module, "Status", "Outcome of a call; see Status in rio/report.hpp.")
      .value("OK", Status::kOk)
      .value("WAITING", Status::kWaiting)
      .value("NOT_INITIALIZED", Status::kNotInitialized)
      .value("MOVING", Status::kMoving)
      .value("STALE", Status::kStale)
      .value("DUPLICATE", Status::kDuplicate)
      .value("LATE", Status::kLate)
      .value("QUEUE_FULL", Status::kQueueFull)
      .value("NON_FINITE", Status::kNonFinite)
      .value("NUMERICAL", Status::kNumerical)
      .value("IMPLAUSIBLE", Status::kImplausible)
      .value("AHEAD", Status::kAhead)
      .value("UNDECLARED", Status::kUndeclared);
}

void bind_state(py::module_& module) {
  const auto vector = [](Vector3d NavState::*member) {
    return [member](const NavState& s) -> Vector3d { return s.*member; };
  };
  py::class_<NavState>(module, "State", "Pose, velocity and biases of the body at one instant.")
      .def(py::init(&state_of), py::arg("time"), py::arg("position"), py::arg("orientation"),
           py::arg("velocity"), py::arg("gyro_bias") = Vector3d(Vector3d::Zero()),
           py::arg("accel_bias") = Vector3d(Vector3d::Zero()))
      .def_property_readonly(
          "time", [](const NavState& s) { return s.time.count(); }, "int, nanoseconds")
      .def_property_readonly("position", vector(&NavState::p_WB), "(3,) in the world [m]")
      .def_property_readonly("orientation", &orientation_of,
                             "(4,) quaternion w, x, y, z that takes body to world axes")
      .def_property_readonly("velocity", vector(&NavState::v_WB), "(3,) in world axes [m/s]")
      .def_property_readonly("gyro_bias", vector(&NavState::gyro_bias), "(3,) [rad/s]")
      .def_property_readonly("accel_bias", vector(&NavState::accel_bias), "(3,) [m/s^2]");
}

py::dict severities(const Health& health, double at_least) {
  py::dict out;
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    if (health.severity[i] < at_least) continue;
    out[to_string(static_cast<HealthReason>(i))] = health.severity[i];
  }
  return out;
}

void bind_health(py::module_& module) {
  py::class_<Health>(module, "Health", "How far the estimate can be trusted; rio/health.hpp.")
      .def_property_readonly(
          "state", [](const Health& h) { return to_string(h.state); },
          "'initialising', 'ok', 'degraded', 'dead reckoning' or 'lost': the worst of the three")
      .def_property_readonly("position", [](const Health& h) { return to_string(h.position); })
      .def_property_readonly("velocity", [](const Health& h) { return to_string(h.velocity); })
      .def_property_readonly("heading", [](const Health& h) { return to_string(h.heading); })
      .def_readonly("quality", &Health::quality, "0 to 100; 50 where degraded begins")
      .def_readonly("reset_counter", &Health::reset_counter, "jumps of the estimate, modulo 256")
      .def_property_readonly(
          "reasons", [](const Health& h) { return severities(h, 1.0); },
          "what makes it less than ok: {name: severity of 1 or more}")
      .def_property_readonly(
          "severity", [](const Health& h) { return severities(h, 0.0); },
          "every reason: {name: signal over limit}");
}

py::dict models_of(const UpdateReport& report) {
  py::dict out;
  for (std::size_t i = 0; i < kModelCount; ++i) {
    const ModelReport& m = report.models[i];
    py::dict sums;
    sums["rows_used"] = m.rows_used;
    sums["rows_gated"] = m.rows_gated;
    sums["rows_out_of_domain"] = m.rows_out_of_domain;
    sums["nis"] = m.nis;
    out[to_string(static_cast<Model>(i))] = sums;
  }
  return out;
}

void bind_report(py::module_& module) {
  const auto radar = [](const UpdateReport& r) { return r.radar; };
  py::class_<UpdateReport>(module, "Report", "The last update; see UpdateReport in rio/report.hpp.")
      .def_property_readonly(
          "time", [](const UpdateReport& r) { return r.time.count(); }, "int, nanoseconds")
      .def_property_readonly("radar", radar)
      .def_readonly("status", &UpdateReport::status)
      .def_readonly("detections", &UpdateReport::detections, "in the scan")
      .def_readonly("detections_kept", &UpdateReport::detections_kept, "after the filter")
      .def_readonly("static_detections", &UpdateReport::static_detections)
      .def_readonly("ego_velocity", &UpdateReport::ego_velocity_S, "(3,) radar axes [m/s]")
      .def_readonly("ego_velocity_valid", &UpdateReport::ego_velocity_valid)
      .def_readonly("trails", &UpdateReport::trails)
      .def_readonly("landmarks", &UpdateReport::landmarks, "in the state")
      .def_readonly("landmarks_matched", &UpdateReport::landmarks_matched)
      .def_readonly("at_rest", &UpdateReport::at_rest)
      .def_readonly("health", &UpdateReport::health)
      .def_property_readonly("models", &models_of, "{model: {'rows_used': ..., 'nis': ...}}")
      .def_property_readonly(
          "innovations",
          [](const UpdateReport& r) {
            std::vector<InnovationRow> rows;
            add_innovations(r, &rows);
            return as_rows(std::move(rows));
          },
          "structured array, one record per measurement; fields as of Result.innovations");
}

py::dict counters_of(const Odometry& odometry) {
  const Counters& c = odometry.counters();
  py::dict out;
  out["imu_samples"] = c.imu_samples;
  out["imu_stale"] = c.imu_stale;
  out["imu_ahead"] = c.imu_ahead;
  out["imu_non_finite"] = c.imu_non_finite;
  out["imu_out_of_range"] = c.imu_out_of_range;
  out["imu_frozen"] = c.imu_frozen;
  out["imu_gaps"] = c.imu_gaps;
  out["clock_restarts"] = c.clock_restarts;
  out["radar_clock_steps"] = c.radar_clock_steps;
  out["scans"] = c.scans;
  out["scans_late"] = c.scans_late;
  out["scans_ahead"] = c.scans_ahead;
  out["scans_duplicate"] = c.scans_duplicate;
  out["scans_overflow"] = c.scans_overflow;
  out["scans_non_finite"] = c.scans_non_finite;
  out["detections_non_finite"] = c.detections_non_finite;
  out["scans_uninitialized"] = c.scans_uninitialized;
  out["updates_failed"] = c.updates_failed;
  out["velocity_resets"] = c.velocity_resets;
  out["attitude_resets"] = c.attitude_resets;
  out["restarts"] = c.restarts;
  out["position_reopened"] = c.position_reopened;
  return out;
}

}  // namespace

void add_innovations(const UpdateReport& report, std::vector<InnovationRow>* rows) {
  for (const InnovationRecord& r : report.records) {
    rows->push_back({report.time.count(), static_cast<std::uint8_t>(report.radar),
                     static_cast<std::uint8_t>(r.model), static_cast<std::uint8_t>(r.result),
                     r.detection, r.dof, r.innovation, r.sigma, r.nis, r.gate});
  }
}

void bind_odometry(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(InnovationRow, time, radar, model, result, detection, dof, innovation, sigma,
                       nis, gate);
  bind_status(module);
  bind_state(module);
  bind_health(module);
  bind_report(module);
  py::list models;
  for (std::size_t i = 0; i < kModelCount; ++i) models.append(to_string(static_cast<Model>(i)));
  module.attr("MODELS") = py::tuple(models);

  // every result is a copy: the estimator changes what it refers to with the next call
  py::class_<Odometry>(module, "Odometry")
      .def(py::init(&create), py::arg("texts"), py::arg("preset") = "", py::arg("sensors") = "")
      .def(
          "add_imu",
          [](Odometry& o, std::int64_t time, const Vector3d& gyro, const Vector3d& accel) {
            return o.add_imu({Time(time), gyro, accel});
          },
          py::arg("time"), py::arg("gyro"), py::arg("accel"),
          "Takes one IMU sample.\n\n"
          "time: int, nanoseconds; gyro: (3,) body axes [rad/s]; accel: (3,) specific force, body\n"
          "axes [m/s^2], +g upwards at rest")
      .def(
          "add_scan",
          [](Odometry& o, std::int64_t time, const py::array& points, std::size_t radar) {
            return o.add_scan(scan_of(time, points), radar);
          },
          py::arg("time"), py::arg("points"), py::arg("radar") = 0,
          "Takes one radar scan.\n\n"
          "time: int, nanoseconds, the middle of the chirps\n"
          "points: N x 4 to N x 10: x, y, z [m], radar axes; doppler [m/s], positive = receding;\n"
          "snr, noise [dB]; sigmas of range [m], azimuth, elevation [rad], doppler [m/s], 0 =\n"
          "that of the options. Or a structured array with fields x, y, z, doppler, snr, noise,\n"
          "sigma_range, sigma_azimuth, sigma_elevation, sigma_doppler, the first four required.")
      .def(
          "reset",
          [](Odometry& o, const NavState& state, const Eigen::Ref<const Eigen::MatrixXd>& P) {
            if (P.rows() != body::kSize || P.cols() != body::kSize) {
              throw py::value_error("covariance: 15 x 15 values are expected");
            }
            return o.reset(state, BodyCovariance(P));
          },
          py::arg("state"), py::arg("covariance"),
          "Starts from a known state.\n\ncovariance: (15, 15), order of covariance()")
      .def("initialized", &Odometry::initialized, "Whether there is an estimate.")
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
      .def(
          "report", [](const Odometry& o) { return UpdateReport(o.report()); }, "The last update.")
      .def(
          "health", [](const Odometry& o) { return Health(o.health()); },
          "How far the estimate can be trusted.")
      .def("counters", &counters_of, "What was taken and what was refused, as a dict.");
}

}  // namespace rio::python
