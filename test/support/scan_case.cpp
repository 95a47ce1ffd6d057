// SPDX-License-Identifier: BSD-3-Clause
#include "support/scan_case.hpp"

namespace rio::test {

ScanCase::ScanCase() {
  options_.calibration = {0.0, 0.0, 0.0, 0.0, 0.0};
  options_.radar.noise_distance = 0.0;
  options_.update.doppler_directions = DopplerDirections::kExact;
  options_.update.match_trust = 1.0;
  see({4.0, 1.0, 0.5});
  see({3.0, -2.0, 1.0});
  see({5.0, 3.0, -1.0});
}

void ScanCase::see(const Vector3d& point_S) {
  RadarDetection raw;
  raw.point_S = point_S;
  raw.range_rate = -kSpeed * point_S.normalized().x();
  scan_.items.push_back(make_detection(raw, options_.radar));
}

StateEstimate ScanCase::state_estimate(std::size_t landmarks) const {
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

const RowBatch& ScanCase::build(ScanRows& rows, const StateEstimate& state_estimate) {
  seen_.scan = &scan_;
  seen_.trails = &trails_;
  for (std::size_t i = 0; i < scan_.items.size(); ++i) seen_.ego_velocity.inlier[i] = true;
  report_ = UpdateReport{};
  rows.build(seen_, state_estimate, &report_);
  return rows.batch();
}

}  // namespace rio::test
