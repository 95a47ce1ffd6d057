// SPDX-License-Identifier: BSD-3-Clause
// The compiled part of the Python package `rio`; what users call is in rio/__init__.py.
#include <exception>
#include <stdexcept>

#include "bindings.hpp"

PYBIND11_MODULE(_rio, module) {
  namespace py = pybind11;
  module.attr("__version__") = RIO_VERSION;
  static const py::exception<std::runtime_error> error(module, "Error", PyExc_RuntimeError);
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const py::builtin_exception&) {  // ValueError and the like: pybind11's own
      throw;
    } catch (const std::runtime_error& e) {
      PyErr_SetString(error.ptr(), e.what());
    }
  });
  rio::python::bind_options(module);
  rio::python::bind_odometry(module);
  rio::python::bind_replay(module);
  rio::python::bind_commands(module);
}
