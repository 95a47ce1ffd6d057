// SPDX-License-Identifier: BSD-3-Clause
// What rio.Odometry returns: status, state, the values of health and report, points, landmarks.
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "view/calibration_names.hpp"

namespace rio::python {

namespace {

NavState state_of(std::int64_t time, const Given<Vector3d>& position,
                  const Given<Eigen::Vector4d>& orientation, const Given<Vector3d>& velocity,
                  const Given<Vector3d>& gyro_bias, const Given<Vector3d>& accel_bias) {
  NavState state;
  state.time = Time(time);
  state.p_WB = position;
  const Eigen::Vector4d& q = orientation;
  state.q_WB = Quaternion(q[0], q[1], q[2], q[3]);
  state.v_WB = velocity;
  state.gyro_bias = gyro_bias;
  state.accel_bias = accel_bias;
  return state;
}

Eigen::Vector4d orientation_of(const NavState& state) {
  const std::array<double, 4> q = wxyz(state.q_WB);
  return {q[0], q[1], q[2], q[3]};
}

void bind_status(py::module_& module) {
  py::enum_<Status>(module, "Status",
                    "Outcome of a call. Each is true, as members of enums are: compare with OK.")
      .value("OK", Status::kOk)
      .value("WAITING", Status::kWaiting, "queued: newer than the IMU, or of another sensor")
      .value("NOT_INITIALIZED", Status::kNotInitialized, "no estimate yet")
      .value("MOVING", Status::kMoving, "no start yet: the sensor does not stand still")
      .value("STALE", Status::kStale, "IMU sample not newer than the last one")
      .value("DUPLICATE", Status::kDuplicate, "scan that was already taken")
      .value("LATE", Status::kLate, "older than the estimate")
      .value("QUEUE_FULL", Status::kQueueFull, "too much waits")
      .value("NON_FINITE", Status::kNonFinite, "NaN or infinity in the data")
      .value("NUMERICAL", Status::kNumerical,
             "the update failed; no valid covariance or quaternion")
      .value("IMPLAUSIBLE", Status::kImplausible, "IMU sample frozen or out of range")
      .value("AHEAD", Status::kAhead, "stamp too far ahead of the newest IMU sample")
      .value("UNDECLARED", Status::kUndeclared, "no such radar or auxiliary state in the options");
}

void bind_state(py::module_& module) {
  const auto vector = [](Vector3d NavState::*member) {
    return [member](const NavState& s) -> Vector3d { return s.*member; };
  };
  py::class_<NavState>(module, "State", "Pose, velocity and biases of the body at one instant.")
      .def(py::init(&state_of), py::arg("time").noconvert(), py::arg("position"),
           py::arg("orientation"), py::arg("velocity"),
           py::arg("gyro_bias") = Vector3d(Vector3d::Zero()),
           py::arg("accel_bias") = Vector3d(Vector3d::Zero()))
      .def_property_readonly(
          "time", [](const NavState& s) { return s.time.count(); }, "int, nanoseconds")
      .def_property_readonly("position", vector(&NavState::p_WB), "(3,) in the world [m]")
      .def_property_readonly("orientation", &orientation_of,
                             "(4,) quaternion w, x, y, z that takes body to world axes")
      .def_property_readonly("velocity", vector(&NavState::v_WB), "(3,) in world axes [m/s]")
      .def_property_readonly("gyro_bias", vector(&NavState::gyro_bias), "(3,) [rad/s]")
      .def_property_readonly("accel_bias", vector(&NavState::accel_bias), "(3,) [m/s^2]")
      .def("__reduce__",  // copies and pickles
           [](const py::object& s) {
             return py::make_tuple(
                 py::type::of(s),
                 py::make_tuple(s.attr("time"), s.attr("position"), s.attr("orientation"),
                                s.attr("velocity"), s.attr("gyro_bias"), s.attr("accel_bias")));
           })
      .def("__repr__", [](const py::object& s) {
        return py::str("<rio.State: time {}, position {}, velocity {}>")
            .format(s.attr("time"), s.attr("position"), s.attr("velocity"));
      });
}

py::dict dict_of(const Health& h) {
  using namespace py::literals;
  py::dict severity;
  for (std::size_t i = 0; i < kHealthReasonCount; ++i) {
    severity[to_string(static_cast<HealthReason>(i))] = h.severity[i];
  }
  return py::dict("state"_a = to_string(h.state), "position"_a = to_string(h.position),
                  "velocity"_a = to_string(h.velocity), "heading"_a = to_string(h.heading),
                  "quality"_a = h.quality, "reset_counter"_a = h.reset_counter,
                  "severity"_a = severity);
}

py::dict models_of(const UpdateReport& report) {
  using namespace py::literals;
  py::dict out;
  for (std::size_t i = 0; i < kModelCount; ++i) {
    const ModelReport& m = report.models[i];
    out[to_string(static_cast<Model>(i))] =
        py::dict("rows_used"_a = m.rows_used, "rows_gated"_a = m.rows_gated,
                 "rows_out_of_domain"_a = m.rows_out_of_domain, "nis"_a = m.nis);
  }
  return out;
}

py::dict calibration_of(const UpdateReport& report) {
  py::dict out;
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    const CalibrationReport& c = report.calibration[i];
    if (c.observability == Observability::kNotEstimated) continue;
    out[view::kCalibrationNames[i].name] = py::make_tuple(c.value, c.sigma);
  }
  return out;
}

py::dict dict_of(const UpdateReport& r) {
  using namespace py::literals;
  std::vector<InnovationRow> rows;
  add_innovations(r, &rows);
  return py::dict("time"_a = r.time.count(), "radar"_a = r.radar, "status"_a = r.status,
                  "detections"_a = r.detections, "detections_kept"_a = r.detections_kept,
                  "static_detections"_a = r.static_detections, "ego_velocity"_a = r.ego_velocity_S,
                  "ego_velocity_valid"_a = r.ego_velocity_valid, "trails"_a = r.trails,
                  "landmarks"_a = r.landmarks, "landmarks_matched"_a = r.landmarks_matched,
                  "at_rest"_a = r.at_rest, "health"_a = dict_of(r.health),
                  "models"_a = models_of(r), "calibration"_a = calibration_of(r),
                  "innovations"_a = as_rows(std::move(rows)));
}

template <std::size_t kCount, class Name>
py::tuple names(const Name& name) {
  py::list out;
  for (std::size_t i = 0; i < kCount; ++i) out.append(name(i));
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

void add_points(const Odometry& odometry, std::vector<PointRow>* rows) {
  const UpdateReport& report = odometry.report();
  for (const PointReport& p : odometry.points()) {
    const Vector3d& s = p.point_S;
    const Vector3d& w = p.point_W;
    rows->push_back({report.time.count(),
                     static_cast<std::uint8_t>(report.radar),
                     static_cast<std::uint8_t>(p.label),
                     {s.x(), s.y(), s.z()},
                     {w.x(), w.y(), w.z()},
                     p.range_rate,
                     p.snr_db,
                     p.residual,
                     p.residual_sigma});
  }
}

void add_landmarks(const Odometry& odometry, std::vector<LandmarkRow>* rows) {
  for (const LandmarkReport& l : odometry.landmarks()) {
    LandmarkRow row{odometry.report().time.count(), {}, {}, l.last_seen.count()};
    for (int i = 0; i < 3; ++i) {
      row.position[i] = l.position_W[i];
      for (int j = 0; j < 3; ++j) row.covariance[i][j] = l.covariance_W(i, j);
    }
    rows->push_back(row);
  }
}

void bind_report(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(InnovationRow, time, radar, model, result, detection, dof, innovation, sigma,
                       nis, gate);
  PYBIND11_NUMPY_DTYPE(PointRow, time, radar, label, point, position, doppler, snr, residual,
                       sigma);
  PYBIND11_NUMPY_DTYPE(LandmarkRow, time, position, covariance, last_seen);
  bind_status(module);
  bind_state(module);
  module.attr("MODELS") =
      names<kModelCount>([](std::size_t i) { return to_string(static_cast<Model>(i)); });
  module.attr("POINT_LABELS") =
      names<kPointLabelCount>([](std::size_t i) { return to_string(static_cast<PointLabel>(i)); });
  module.attr("CALIBRATION") =
      names<kCalibrationCount>([](std::size_t i) { return view::kCalibrationNames[i].name; });
}

// what rio.Health and rio.Report hold, and the pose of a radar
void bind_values(py::module_& module) {
  module.def(
      "health_of", [](const Odometry& o) { return dict_of(o.health()); }, py::arg("odometry"));
  module.def(
      "report_of", [](const Odometry& o) { return dict_of(o.report()); }, py::arg("odometry"));
  module.def(
      "extrinsics_of",
      [](const Odometry& o, std::size_t radar) {
        if (radar >= o.radars()) throw py::index_error("extrinsics: no such radar");
        const Pose& pose = o.extrinsics(radar);
        const std::array<double, 4> q = wxyz(pose.rotation);
        return py::make_tuple(pose.translation, Eigen::Vector4d(q[0], q[1], q[2], q[3]));
      },
      py::arg("odometry"), py::arg("radar"));
}

}  // namespace rio::python
