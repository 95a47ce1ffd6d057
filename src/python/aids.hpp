// SPDX-License-Identifier: BSD-3-Clause
// Measurements of other sensors, as methods of rio.Odometry.
#pragma once

#include <string>
#include <vector>

#include "bindings.hpp"
#include "rio/options.hpp"
#include "rio/rio.hpp"

namespace rio::python {

/// Throws ValueError if there is no state of that name.
void declare_auxiliary(const std::vector<std::string>& names, Options* options);

void bind_aids(py::class_<Odometry>* odometry);

}  // namespace rio::python
