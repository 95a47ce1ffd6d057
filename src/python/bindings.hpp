// SPDX-License-Identifier: BSD-3-Clause
// The parts of the Python module `rio._rio`, and what they share.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "estimator_options.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/rio.hpp"
#include "rio/types.hpp"

namespace rio::python {

namespace py = pybind11;

void bind_options(py::module_& module);
void bind_odometry(py::module_& module);
void bind_report(py::module_& module);
void bind_values(py::module_& module);
void bind_replay(py::module_& module);
void bind_commands(py::module_& module);
/// Measurements of other sensors, as methods of rio.Odometry.
void bind_aids(py::class_<Odometry>* odometry);

/// A vector or matrix of numpy; what is masked is NaN.
template <class Matrix>
struct Given {
  Matrix value;
  operator const Matrix&() const { return value; }
};
/// A masked array as a plain one, NaN where it is masked.
inline py::object unmasked(const py::handle& array) {
  return array.attr("astype")("f8").attr("filled")(std::nan(""));
}

/// Waits while another thread is in the estimator's on_scan.
/// @throws std::runtime_error within the on_scan itself
void await_on_scan(const Odometry& odometry);

/// Throws ValueError if there is no state of that name.
void declare_auxiliary(const std::vector<std::string>& names, Options* options);

/// @param texts option files, a later one overrides an earlier one
/// @param preset overrides theirs; may be empty
tools::EstimatorArguments estimator_of(const std::vector<std::string>& texts,
                                       const std::string& preset);

/// Preset, then the sensor files of a folder (if one is named), then the texts. What is missing or
/// not known in the files is a warning. Throws std::runtime_error, "options:LINE: ..." if a line is
/// at fault.
Options make_options(const std::vector<std::string>& texts, const std::string& preset,
                     const std::string& sensors);

/// Hands the values to numpy, without a copy.
/// @param shape of the array, its product with the size of Scalar is that of the vector
template <class Scalar, class Value>
py::array_t<Scalar> as_array(std::vector<Value>&& values, std::vector<py::ssize_t> shape) {
  auto owner = std::make_unique<std::vector<Value>>(std::move(values));
  auto* data = reinterpret_cast<Scalar*>(owner->data());
  const py::capsule free(owner.get(), [](void* p) { delete static_cast<std::vector<Value>*>(p); });
  owner.release();  // now the capsule's
  return py::array_t<Scalar>(std::move(shape), data, free);
}

/// The same for numbers, or rows of a structured array.
template <class Row>
py::array_t<Row> as_rows(std::vector<Row>&& rows) {
  const auto count = static_cast<py::ssize_t>(rows.size());
  return as_array<Row>(std::move(rows), {count});
}

/// The same for rows of as many numbers.
template <std::size_t kSize>
py::array_t<double> as_table(std::vector<std::array<double, kSize>>&& rows) {
  const auto count = static_cast<py::ssize_t>(rows.size());
  return as_array<double>(std::move(rows), {count, static_cast<py::ssize_t>(kSize)});
}

inline std::array<double, 3> xyz(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
/// A quaternion as numpy and the files have it.
inline std::array<double, 4> wxyz(const Quaternion& q) {
  return {q.w(), q.x(), q.y(), q.z()};
}

/// A row of `innovations`.
struct InnovationRow {
  std::int64_t time;  ///< of the scan [ns]
  std::uint8_t radar;
  std::uint8_t model;   ///< index of rio.MODELS
  std::uint8_t result;  ///< 0 used, 1 gated, 2 out of the domain of the model
  std::uint16_t detection;
  std::uint16_t dof;
  double innovation;
  double sigma;
  double nis;
  double gate;
};

/// A row of `points`.
struct PointRow {
  std::int64_t time;  ///< of the scan [ns]
  std::uint8_t radar;
  std::uint8_t label;  ///< index of rio.POINT_LABELS
  double point[3];     ///< corrected for the radar errors, radar axes [m]
  double position[3];  ///< world axes [m]
  double doppler;      ///< corrected and, if static, unfolded [m/s]
  double snr;          ///< [dB]
  double residual;     ///< Doppler minus that of a static point there [m/s]
  double sigma;        ///< of the residual [m/s]
};

/// A row of `landmarks`.
struct LandmarkRow {
  std::int64_t time;        ///< of the scan [ns]
  double position[3];       ///< world axes [m]
  double covariance[3][3];  ///< of it [m^2]
  std::int64_t last_seen;   ///< [ns]
};

void add_innovations(const UpdateReport& report, std::vector<InnovationRow>* rows);
void add_points(const Odometry& odometry, std::vector<PointRow>* rows);
void add_landmarks(const Odometry& odometry, std::vector<LandmarkRow>* rows);

/// Of a call that adds to the estimator, from outside of its on_scan.
/// @throws std::runtime_error from within; what an on_scan() threw
template <class Call>
Status added(Odometry& odometry, const Call& call) {
  await_on_scan(odometry);
  const Status status = call(odometry);
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();
  return status;
}

}  // namespace rio::python

namespace pybind11::detail {

template <class Matrix>
struct type_caster<rio::python::Given<Matrix>> {
  PYBIND11_TYPE_CASTER(rio::python::Given<Matrix>, make_caster<Matrix>::name);
  bool load(handle given, bool convert) {
    make_caster<Matrix> plain;
    const object held =
        hasattr(given, "filled") ? rio::python::unmasked(given) : reinterpret_borrow<object>(given);
    if (!plain.load(held, convert)) return false;
    value.value = cast_op<Matrix&>(plain);
    return true;
  }
};

}  // namespace pybind11::detail
