// SPDX-License-Identifier: BSD-3-Clause
// Options as texts of option files, and what they come to.
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.hpp"
#include "recording.hpp"
#include "rio/io/options_yaml.hpp"
#include "rio/option_fields.hpp"

namespace rio::python {

namespace {

py::object value_of(const Vector3d& v) {
  return py::make_tuple(v.x(), v.y(), v.z());
}
py::object value_of(const Quaternion& q) {
  return py::make_tuple(q.w(), q.x(), q.y(), q.z());
}
template <class Value>
py::object value_of(Value value) {
  if constexpr (std::is_enum_v<Value>) {
    return py::cast(names_of(value)[static_cast<std::size_t>(value)]);
  } else {
    return py::cast(value);
  }
}

py::dict values_of(const Options& options) {
  py::dict values;
  values["preset"] = io::preset_of(options);
  visit_fields(options, [&values](const FieldInfo& info, const auto& value) {
    values[info.key] = value_of(value);
  });
  return values;
}

py::dict meanings() {
  py::dict out;
  out["preset"] = py::make_tuple("", "Name of the preset.");
  const Options options;
  visit_fields(options, [&out](const FieldInfo& info, const auto&) {
    out[info.key] = py::make_tuple(info.unit, info.doc);
  });
  return out;
}

/// As a replay of that recording flies.
std::string options_of(const std::string& path, const std::vector<std::string>& texts,
                       const std::string& preset) {
  const tools::OpenRecording recording = tools::open_any(path, {});
  std::vector<std::string> notes;
  return io::options_as_yaml(
      io::flown_options(estimator_of(texts, preset), recording.sensors, {}, &notes));
}

}  // namespace

tools::EstimatorArguments estimator_of(const std::vector<std::string>& texts,
                                       const std::string& preset) {
  tools::EstimatorArguments arguments;
  arguments.texts = texts;
  arguments.preset = preset;
  return arguments;
}

Options make_options(const std::vector<std::string>& texts, const std::string& preset,
                     const std::string& sensors) {
  io::Dataset dataset;
  if (!sensors.empty()) dataset = io::read_sensor_info(sensors);
  for (const std::string& note : dataset.notes) {
    constexpr int kCaller = 2;  // of rio.Odometry
    if (PyErr_WarnEx(PyExc_UserWarning, note.c_str(), kCaller) != 0) throw py::error_already_set();
  }
  std::vector<std::string> notes;
  return io::flown_options(estimator_of(texts, preset), dataset, {}, &notes);
}

void bind_options(py::module_& module) {
  module.def(
      "option_values",
      [](const std::vector<std::string>& texts, const std::string& preset) {
        return values_of(make_options(texts, preset, {}));
      },
      py::arg("texts"), py::arg("preset") = "");
  module.def(
      "option_file",
      [](const std::vector<std::string>& texts, const std::string& preset) {
        return io::options_as_yaml(make_options(texts, preset, {}));
      },
      py::arg("texts"), py::arg("preset") = "");
  module.def("options_of", &options_of, py::arg("path"), py::arg("texts"), py::arg("preset") = "",
             py::call_guard<py::gil_scoped_release>());
  module.def("option_meanings", &meanings);
}

}  // namespace rio::python
