// SPDX-License-Identifier: BSD-3-Clause
#include "rio/update/point_report.hpp"

#include <cmath>

namespace rio {

namespace {

PointLabel label_of(const Observations& seen, std::size_t i) {
  if (seen.ego_velocity.outlier[i]) return PointLabel::kOutlier;
  if (!seen.ego_velocity.inlier[i]) return PointLabel::kUnused;
  return seen.moves[i] ? PointLabel::kMover : PointLabel::kStatic;
}

}  // namespace

void report_points(const DetectionList& received, const OwnEchoList& own, const Observations& seen,
                   const Estimate& x, bool trails, std::vector<PointReport>* out) {
  const RigidPose T_WB = x.T_WB();
  const RigidPose T_BS(x.T_BS);
  const Vector3d v_S = radar_velocity(x);
  const auto report = [&](const Detection& d, PointLabel label) {
    return PointReport{label,
                       d.point_S,
                       to_world(T_WB, T_BS, d.point_S),
                       d.range_rate,
                       d.snr_db,
                       d.range_rate + d.direction_S.dot(v_S),
                       std::sqrt(residual_variance(d, v_S))};
  };
  out->clear();
  for (std::size_t i = 0; i < seen.scan->items.size(); ++i) {
    out->push_back(report(seen.detection(i), label_of(seen, i)));
  }
  const auto match = [out](const Matches& matches) {
    for (const Match& m : matches) {
      PointReport& point = (*out)[m.detection];
      if (point.label == PointLabel::kStatic) point.label = PointLabel::kMatched;
    }
  };
  match(seen.matches.landmarks);
  if (trails) match(seen.matches.trails);
  for (const std::size_t i : own) {
    const auto at = out->begin() + static_cast<std::ptrdiff_t>(i);
    out->insert(at, report(received.items[i], PointLabel::kOwnEcho));
  }
}

}  // namespace rio
