// SPDX-License-Identifier: BSD-3-Clause
// The names of the enumerations, each in the order of its values.
#include "rio/report.hpp"

#include <array>

namespace rio {

namespace {

template <class Enum, std::size_t kSize>
const char* name(const std::array<const char*, kSize>& names, Enum value, const char* otherwise) {
  const auto i = static_cast<std::size_t>(value);
  return i < kSize ? names[i] : otherwise;
}

}  // namespace

const char* to_string(Status status) {
  constexpr std::array kNames = {"kOk",        "kWaiting",   "kNotInitialized", "kMoving",
                                 "kStale",     "kDuplicate", "kLate",           "kQueueFull",
                                 "kNonFinite", "kNumerical", "kImplausible",    "kAhead",
                                 "kUndeclared"};
  static_assert(kNames.size() == static_cast<std::size_t>(Status::kUndeclared) + 1);
  return name(kNames, status, "unknown status");
}

const char* to_string(Model model) {
  constexpr std::array kNames = {"doppler",        "trail_distance",    "landmark_distance",
                                 "landmark_point", "landmark_position", "rest",
                                 "aiding",         "ego_velocity"};
  static_assert(kNames.size() == kModelCount);
  return name(kNames, model, "unknown model");
}

const char* to_string(HealthState state) {
  constexpr std::array kNames = {"initialising", "ok", "degraded", "dead reckoning", "lost"};
  static_assert(kNames.size() == static_cast<std::size_t>(HealthState::kLost) + 1);
  return name(kNames, state, "unknown state");
}

const char* to_string(HealthReason reason) {
  constexpr std::array kNames = {"radar silent",
                                 "few measurements",
                                 "outliers",
                                 "measurements gated",
                                 "large innovations",
                                 "velocity contradicted",
                                 "tilt contradicted",
                                 "step of the estimate",
                                 "gaps of the IMU",
                                 "position uncertain",
                                 "velocity uncertain",
                                 "heading uncertain",
                                 "tilt uncertain",
                                 "too fast",
                                 "calibration doubtful",
                                 "update failed",
                                 "other sensors contradict",
                                 "one radar silent"};
  static_assert(kNames.size() == kHealthReasonCount);
  return name(kNames, reason, "unknown reason");
}

}  // namespace rio
