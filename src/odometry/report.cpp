// SPDX-License-Identifier: BSD-3-Clause
#include "rio/report.hpp"

namespace rio {

const char* to_string(Status status) {
  switch (status) {
    case Status::kOk:
      return "kOk";
    case Status::kWaiting:
      return "kWaiting";
    case Status::kNotInitialized:
      return "kNotInitialized";
    case Status::kMoving:
      return "kMoving";
    case Status::kStale:
      return "kStale";
    case Status::kDuplicate:
      return "kDuplicate";
    case Status::kLate:
      return "kLate";
    case Status::kQueueFull:
      return "kQueueFull";
    case Status::kNonFinite:
      return "kNonFinite";
    case Status::kNumerical:
      return "kNumerical";
    case Status::kImplausible:
      return "kImplausible";
    case Status::kAhead:
      return "kAhead";
    case Status::kUndeclared:
      return "kUndeclared";
  }
  return "unknown status";
}

const char* to_string(Model model) {
  switch (model) {
    case Model::kDoppler:
      return "doppler";
    case Model::kTrailDistance:
      return "trail_distance";
    case Model::kLandmarkDistance:
      return "landmark_distance";
    case Model::kLandmarkPoint:
      return "landmark_point";
    case Model::kLandmarkPosition:
      return "landmark_position";
    case Model::kRest:
      return "rest";
    case Model::kAiding:
      return "aiding";
    case Model::kEgoVelocity:
      return "ego_velocity";
    case Model::kCount:
      break;
  }
  return "unknown model";
}

const char* to_string(HealthState state) {
  switch (state) {
    case HealthState::kInitializing:
      return "initialising";
    case HealthState::kOk:
      return "ok";
    case HealthState::kDegraded:
      return "degraded";
    case HealthState::kDeadReckoning:
      return "dead reckoning";
    case HealthState::kLost:
      return "lost";
  }
  return "unknown state";
}

const char* to_string(HealthReason reason) {
  switch (reason) {
    case HealthReason::kRadarSilent:
      return "radar silent";
    case HealthReason::kFewDetections:
      return "few measurements";
    case HealthReason::kOutliers:
      return "outliers";
    case HealthReason::kGated:
      return "measurements gated";
    case HealthReason::kInnovations:
      return "large innovations";
    case HealthReason::kVelocityContradicted:
      return "velocity contradicted";
    case HealthReason::kTiltContradicted:
      return "tilt contradicted";
    case HealthReason::kReopened:
      return "step of the estimate";
    case HealthReason::kImuGaps:
      return "gaps of the IMU";
    case HealthReason::kUncertainPosition:
      return "position uncertain";
    case HealthReason::kUncertainVelocity:
      return "velocity uncertain";
    case HealthReason::kUncertainHeading:
      return "heading uncertain";
    case HealthReason::kUncertainTilt:
      return "tilt uncertain";
    case HealthReason::kTooFast:
      return "too fast";
    case HealthReason::kCalibration:
      return "calibration doubtful";
    case HealthReason::kNumerical:
      return "update failed";
    case HealthReason::kAiding:
      return "other sensors contradict";
    case HealthReason::kCount:
      break;
  }
  return "unknown reason";
}

}  // namespace rio
