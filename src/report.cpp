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
    case Model::kCount:
      break;
  }
  return "unknown model";
}

}  // namespace rio
