// SPDX-License-Identifier: BSD-3-Clause
// Faults of recordings, put into healthy ones, and what `rio check` is to say of each.
#pragma once

#include <functional>
#include <vector>

#include "check/finding.hpp"
#include "rio/io/dataset.hpp"
#include "rio/types.hpp"

namespace rio::check {

/// A fault, and what is said of it.
struct Fault {
  const char* name;
  const char* meaning;
  std::function<void(io::Dataset*)> make;
  const char* subject;
  const char* text;       ///< in the sentence
  const char* change;     ///< in what is to be changed
  const char* also = "";  ///< another subject that may say it
};

/// All of them; what is said is that of a bag.
const std::vector<Fault>& faults();

/// @param phi rotation vector in the axes of the body, or of the radar [rad]
void turn_mounting(io::Dataset* dataset, const Vector3d& phi, bool in_body);

/// What is said of the fault, if it is not ok and says the right; else nothing.
const Finding* naming(const Findings& findings, const Fault& fault);

}  // namespace rio::check
