// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors: the included models of rio/models/aids.hpp.
#include "bindings.hpp"  // first: pybind11 silences a warning of Eigen where it includes it

#include <cmath>
#include <string>

#include "rio/aiding.hpp"
#include "rio/models/aids.hpp"

namespace rio::python {

namespace {

using GivenVector = Given<Vector3d>;
using GivenMatrix = Given<Eigen::MatrixXd>;

double positive(const char* name, double value) {
  if (value > 0.0 && std::isfinite(value)) return value;
  throw py::value_error(std::string(name) + ": a positive number is expected");
}

double finite(const char* name, double value) {
  if (std::isfinite(value)) return value;
  throw py::value_error(std::string(name) + ": a finite number is expected");
}

const Vector3d& finite(const char* name, const Vector3d& value) {
  if (value.allFinite()) return value;
  throw py::value_error(std::string(name) + ": three finite numbers are expected");
}

Matrix3d definite(const Eigen::MatrixXd& covariance) {
  if (covariance.rows() == 3 && covariance.cols() == 3 && is_definite(Matrix3d(covariance))) {
    return covariance;
  }
  throw py::value_error("covariance: a symmetric, positive definite 3 x 3 matrix is expected");
}

template <class Model>
Status add(Odometry& odometry, std::int64_t time, const typename Model::Measurement& z) {
  return added(odometry, [&](Odometry& to) {
    return to.add_measurement({Time(time), Model{}, z});
  });
}

Status add_position(Odometry& o, std::int64_t time, const GivenVector& position,
                    const GivenMatrix& covariance, const GivenVector& lever) {
  return add<PositionModel>(
      o, time, {finite("position", position), definite(covariance), finite("lever", lever)});
}

Status add_heading(Odometry& o, std::int64_t time, double heading, double sigma) {
  return add<HeadingModel>(o, time, {finite("heading", heading), positive("sigma", sigma)});
}

Status add_body_velocity(Odometry& o, std::int64_t time, const GivenVector& velocity,
                         const GivenMatrix& covariance, const GivenVector& lever,
                         const GivenVector& gyro) {
  return add<BodyVelocityModel>(o, time,
                                {finite("velocity", velocity), definite(covariance),
                                 finite("lever", lever), finite("gyro", gyro)});
}

Status add_world_velocity(Odometry& o, std::int64_t time, const GivenVector& velocity,
                          const GivenMatrix& covariance) {
  return add<WorldVelocityModel>(o, time, {finite("velocity", velocity), definite(covariance)});
}

Status add_height(Odometry& o, std::int64_t time, double height, double sigma) {
  return add<HeightModel>(o, time, {finite("height", height), positive("sigma", sigma)});
}

Status add_ground_range(Odometry& o, std::int64_t time, double range, double sigma,
                        const GivenVector& direction, const GivenVector& lever) {
  if (std::abs(finite("direction", direction).norm() - 1.0) > 1e-6) {
    throw py::value_error("direction: a unit vector is expected");
  }
  return add<GroundRangeModel>(
      o, time,
      {positive("range", range), positive("sigma", sigma), direction, finite("lever", lever)});
}

py::object auxiliary_of(const Odometry& odometry, const std::string& name) {
  double value = 0.0;
  double variance = 0.0;
  if (!odometry.auxiliary(name.c_str(), &value, &variance)) return py::none();
  return py::make_tuple(value, std::sqrt(variance));
}

}  // namespace

void declare_auxiliary(const std::vector<std::string>& names, Options* options) {
  for (const std::string& name : names) {
    const bool is_height = name == HeightOffset::kName;
    if (!is_height && name != GroundHeight::kName) {
      throw py::value_error(name + ": no such state, but " + HeightOffset::kName + " and " +
                            GroundHeight::kName);
    }
    if (!(is_height ? options->auxiliary.declare<HeightOffset>()
                    : options->auxiliary.declare<GroundHeight>())) {
      throw py::value_error(name + ": given twice");
    }
  }
}

void bind_aids(py::class_<Odometry>* odometry) {
  const Vector3d zero = Vector3d::Zero();
  odometry
      ->def("add_position", &add_position, py::arg("time").noconvert(), py::arg("position"),
            py::arg("covariance"), py::arg("lever") = zero,
            "Takes the position of a point of the body, of GNSS or motion capture.\n\n"
            "time: int, nanoseconds; position: (3,) world axes of the estimate [m]; covariance:\n"
            "(3, 3) [m^2]; lever: (3,) from the IMU to the point, body axes [m]")
      .def("add_heading", &add_heading, py::arg("time").noconvert(), py::arg("heading"),
           py::arg("sigma"),
           "Takes the heading of the body's x axis about the world's z axis [rad].")
      .def("add_body_velocity", &add_body_velocity, py::arg("time").noconvert(),
           py::arg("velocity"), py::arg("covariance"), py::arg("lever") = zero,
           py::arg("gyro") = zero,
           "Takes the velocity of a point of the body, body axes, of optical flow or wheels.\n\n"
           "velocity: (3,) [m/s]; covariance: (3, 3) [m^2/s^2]; lever: (3,) from the IMU to the\n"
           "point [m]; gyro: (3,) as measured at its time, needed with a lever [rad/s]")
      .def("add_world_velocity", &add_world_velocity, py::arg("time").noconvert(),
           py::arg("velocity"), py::arg("covariance"),
           "Takes the velocity of the IMU, world axes: (3,) [m/s], (3, 3) [m^2/s^2].")
      .def("add_height", &add_height, py::arg("time").noconvert(), py::arg("height"),
           py::arg("sigma"),
           "Takes a barometric height over the start [m]; estimates \"height_offset\" beside it,\n"
           "which Odometry(auxiliary=...) has to name.")
      .def("add_ground_range", &add_ground_range, py::arg("time").noconvert(), py::arg("range"),
           py::arg("sigma"), py::arg("direction") = Vector3d(0.0, 0.0, -1.0),
           py::arg("lever") = zero,
           "Takes a range to level ground [m]; estimates \"ground_height\" beside it, which\n"
           "Odometry(auxiliary=...) has to name.\n\n"
           "direction: (3,) unit vector of the beam, body axes; lever: (3,) from the IMU to the\n"
           "sensor [m]")
      .def("auxiliary", &auxiliary_of, py::arg("name"),
           "(value, sigma) of a state of Odometry(auxiliary=...) at the last scan, else None.");
}

}  // namespace rio::python
