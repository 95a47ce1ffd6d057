// SPDX-License-Identifier: BSD-3-Clause
// A scan made by hand, with what the front-end has seen in it and the state estimate it is held
// against.
#pragma once

#include <gtest/gtest.h>

#include <optional>

#include "rio/update/scan_rows.hpp"

namespace rio::test {

inline constexpr double kSpeed = 2.0;         // along x [m/s]
inline constexpr double kVelocityVar = 0.04;  // of the state estimate, an axis [m^2/s^2]
inline constexpr Time kStart = Time(1'000'000'000);

/// A radar at the body, without a turn, that flies along x; landmarks where the first detections
/// are. Nothing is estimated of the calibration.
class ScanCase : public testing::Test {
 protected:
  ScanCase() {
    options_.calibration = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    options_.radar.noise_distance = 0.0;
    options_.update.doppler_directions = DopplerDirections::kExact;
    options_.update.match_trust = 1.0;
    see({4.0, 1.0, 0.5});
    see({3.0, -2.0, 1.0});
    see({5.0, 3.0, -1.0});
  }

  /// A static point.
  void see(const Vector3d& point_S) {
    const double rate = -kSpeed * point_S.normalized().x();
    scan_.items.push_back(make_detection({point_S, rate}, options_.radar));
  }
  Detection& detection(std::size_t i) { return scan_.items[i]; }
  void match_landmark(std::size_t target, std::size_t detection) {
    seen_.matches.landmarks.push_back({target, detection});
  }

  /// The state estimate with a landmark at each of the first detections.
  StateEstimate state_estimate(std::size_t landmarks = 0) const {
    StateEstimate b(options_, options_.update.max_clones);
    NavState nav;
    nav.time = kStart;
    nav.v_WB = Vector3d(kSpeed, 0.0, 0.0);
    BodyCovariance P = 1e-8 * BodyCovariance::Identity();
    P.block<3, 3>(body::kVelocity, body::kVelocity) = kVelocityVar * Matrix3d::Identity();
    b.reset(nav, P);
    for (std::size_t i = 0; i < landmarks; ++i) b.add_landmark(scan_.items[i]);
    return b;
  }
  const RowBatch& build(ScanRows& rows, const StateEstimate& state_estimate) {
    seen_.scan = &scan_;
    seen_.trails = &trails_;
    for (std::size_t i = 0; i < scan_.items.size(); ++i) seen_.ego_velocity.inlier[i] = true;
    report_ = UpdateReport{};
    rows.build(seen_, state_estimate, &report_);
    return rows.batch();
  }
  /// With rows that know of no scan before, as the options are now.
  const RowBatch& build(const StateEstimate& state_estimate) {
    return build(rows_.emplace(options_), state_estimate);
  }
  template <class M>
  const auto& measured() const {
    return rows_->measurements().of<M>();
  }
  const ModelReport& sums(Model model) const {
    return report_.models[static_cast<std::size_t>(model)];
  }

  Options options_;
  DetectionList scan_;
  TrailSet trails_{8, 4};
  Observations seen_;
  UpdateReport report_;
  std::optional<ScanRows> rows_;  ///< of the last build() without others
};

/// Noise inflation of a Doppler.
inline double inflation(const ScanRows& rows, std::size_t doppler) {
  return 1.0 / rows.measurements().of<DopplerModel>()[doppler].weight;
}

}  // namespace rio::test
