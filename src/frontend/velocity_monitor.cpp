// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/velocity_monitor.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace rio {

VelocityMonitor::VelocityMonitor(const Options& options)
    : options_(options.frontend),
      fold_(options.frontend.unwrap_doppler ? options.radar.max_doppler : 0.0),
      far_(chi2_quantile(kAgreement, 3.0)) {}

void VelocityMonitor::reset(Time time) {
  row_ = 0;
  agreed_ = time;
}

bool VelocityMonitor::contradicts(const Observations& seen, const RadarVelocity& predicted) {
  if (!options_.velocity_recovery) return false;
  const bool against =
      is_majority(seen) && !explains(predicted, seen) && differs(seen.ego_velocity, predicted);
  if (!against) reset(seen.scan->time);
  return against && ++row_ >= kScans;
}

bool VelocityMonitor::is_majority(const Observations& seen) const {
  const EgoVelocity& scan = seen.ego_velocity;
  return scan.valid && scan.covariance && scan.inliers >= 2 * options_.ransac_min_inliers &&
         2 * scan.inliers > static_cast<int>(seen.scan->items.size());
}

bool VelocityMonitor::explains(const RadarVelocity& predicted, const Observations& seen) const {
  constexpr double kSigmas = 3.0;
  int explained = 0;
  for (const Detection& d : seen.scan->items) {
    const Vector3d& u = d.direction_S;
    const double bound = static_bound(options_, residual_variance(d, seen.ego_velocity.v_S));
    const double spread = kSigmas * std::sqrt(u.dot(predicted.covariance * u));
    const double residual = fold_.wrap(d.range_rate + u.dot(predicted.v_S));
    explained += std::abs(residual) < std::hypot(bound, spread) ? 1 : 0;  // (E1)
  }
  return 2 * explained >= seen.ego_velocity.inliers;
}

bool VelocityMonitor::differs(const EgoVelocity& scan,
                              const RadarVelocity& predicted) const {  // (E2)
  const Vector3d difference = scan.v_S - predicted.v_S;
  const Eigen::LLT<Matrix3d> llt(*scan.covariance + predicted.covariance);
  return llt.info() == Eigen::Success && difference.dot(llt.solve(difference)) > far_;
}

}  // namespace rio
