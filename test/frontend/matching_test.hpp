// SPDX-License-Identifier: BSD-3-Clause
// A radar at the origin of the world; landmarks and detections where a test of the matching puts
// them.
#pragma once

#include <gtest/gtest.h>

#include <array>

#include "rio/frontend/association.hpp"

namespace rio::test {

class MatchingTest : public testing::Test {
 protected:
  MatchingTest() {
    radar_.sigma_range = kSigmaRange;
    radar_.sigma_azimuth = kSigmaAzimuth;
    radar_.sigma_elevation = kSigmaElevation;
    radar_.weak_snr_db = -200.0;  // all echoes are alike
    usable_.fill(true);
  }
  void see(const Vector3d& point_S) {
    scan_.items.push_back(make_detection({.point_S = point_S}, radar_));
  }
  void know(const Vector3d& point_W, double sigma = 0.01) {
    LandmarkState landmark;
    landmark.p_W = point_W;
    landmark.covariance_S = sigma * sigma * Matrix3d::Identity();
    estimate_.landmarks.push_back(landmark);
  }
  void clear() {
    scan_.items.clear();
    estimate_.landmarks.clear();
  }
  /// A trail of one detection, made from the origin.
  void follow(const Vector3d& point_S) {
    estimate_.clones.push_back({7, RigidPose()});
    trails_.create({7, make_detection({.point_S = point_S}, radar_)});
  }
  std::size_t matched() { return match().landmarks.size(); }
  AssociationResult match() {
    Association association(options_, kMaxLandmarks, kSameEcho);
    AssociationResult result;
    association.match(scan_, usable_, estimate_, estimate_.landmarks.size(), trails_, &result);
    return result;
  }

  static constexpr double kSigmaRange = 0.03;
  static constexpr double kSigmaAzimuth = 0.03;
  static constexpr double kSigmaElevation = 0.06;
  static constexpr double kSameEcho = 0.01;  // [m]
  RadarOptions radar_;
  FrontendOptions options_;
  DetectionList scan_;
  std::array<bool, kMaxDetections> usable_{};
  Estimate estimate_;
  TrailSet trails_{8, 3};
};

}  // namespace rio::test
