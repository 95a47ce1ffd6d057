// SPDX-License-Identifier: BSD-3-Clause
// What rio.Odometry returns: status, state, health and report.
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "bindings.hpp"

namespace rio::python {

namespace {

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

void bind_status(py::module_& module) {
  py::enum_<Status>(module, "Status", "Outcome of a call.")
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
          "every reason: {name: signal over limit}")
      .def("__repr__", [](const py::object& h) {
        return py::str("<rio.Health: {}, quality {}, reasons {}>")
            .format(h.attr("state"), h.attr("quality"), h.attr("reasons"));
      });
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

void bind_update(py::module_& module) {
  const auto radar = [](const UpdateReport& r) { return r.radar; };
  py::class_<UpdateReport>(module, "Report", "The last update; see UpdateReport in rio/report.hpp.")
      .def_property_readonly(
          "time", [](const UpdateReport& r) { return r.time.count(); },
          "stamp of the scan, int, nanoseconds")
      .def_property_readonly("radar", radar, "index of the radar of the scan")
      .def_readonly("status", &UpdateReport::status)
      .def_readonly("detections", &UpdateReport::detections, "in the scan")
      .def_readonly("detections_kept", &UpdateReport::detections_kept, "after the filter")
      .def_readonly("static_detections", &UpdateReport::static_detections,
                    "inliers of the ego-velocity consensus")
      .def_readonly("ego_velocity", &UpdateReport::ego_velocity_S, "(3,) radar axes [m/s]")
      .def_readonly("ego_velocity_valid", &UpdateReport::ego_velocity_valid)
      .def_readonly("trails", &UpdateReport::trails, "alive after the update")
      .def_readonly("landmarks", &UpdateReport::landmarks, "in the state")
      .def_readonly("landmarks_matched", &UpdateReport::landmarks_matched)
      .def_readonly("at_rest", &UpdateReport::at_rest, "standstill for a while, by IMU and radar")
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

}  // namespace

void add_innovations(const UpdateReport& report, std::vector<InnovationRow>* rows) {
  for (const InnovationRecord& r : report.records) {
    rows->push_back({report.time.count(), static_cast<std::uint8_t>(report.radar),
                     static_cast<std::uint8_t>(r.model), static_cast<std::uint8_t>(r.result),
                     r.detection, r.dof, r.innovation, r.sigma, r.nis, r.gate});
  }
}

void bind_report(py::module_& module) {
  bind_status(module);
  bind_state(module);
  bind_health(module);
  bind_update(module);
  py::list models;
  for (std::size_t i = 0; i < kModelCount; ++i) models.append(to_string(static_cast<Model>(i)));
  module.attr("MODELS") = py::tuple(models);
}

}  // namespace rio::python
