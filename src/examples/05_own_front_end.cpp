// SPDX-License-Identifier: BSD-3-Clause
// Example 5: an ego-velocity estimator of your own. The velocity of a scan and its static set come
// from iteratively reweighted least squares with a Cauchy kernel, from the prediction on, instead
// of RANSAC; matching and trails stay those of the library. Flies with both.
#include <cmath>
#include <cstdio>

#include <rio/ekf/ekf.hpp>
#include <rio/pipeline.hpp>

#include "research_flight.hpp"

namespace {

class LeastSquaresFrontend {
 public:
  explicit LeastSquaresFrontend(const rio::Options& options)
      : options_(options.frontend), frontend_(options) {}

  const rio::TrailSet& trails() const { return frontend_.trails(); }
  void reset() { frontend_.reset(); }
  void observe(const rio::DetectionList& scan, const rio::Estimate& predicted,
               rio::Observations* out, const rio::Matrix3d& velocity_covariance_S) {
    estimate(scan, {rio::radar_velocity(predicted), velocity_covariance_S}, &out->ego_velocity);
    frontend_.match(scan, predicted, out);
  }
  void advance(const rio::Observations& seen, rio::ScanId id, std::size_t room,
               rio::Promotions* promotions) {
    frontend_.advance(seen, id, room, promotions);
  }

 private:
  void estimate(const rio::DetectionList& scan, const rio::RadarVelocity& predicted,
                rio::EgoVelocity* out) const {
    constexpr int kIterations = 10;
    rio::Vector3d v = predicted.v_S;
    rio::Matrix3d information;
    for (int k = 0; k < kIterations; ++k) {
      information = (predicted.covariance + 1e-6 * rio::Matrix3d::Identity()).inverse();
      rio::Vector3d gradient = information * (predicted.v_S - v);
      for (const rio::Detection& d : scan.items) {
        const double variance = residual_variance(d, v);
        const double r = d.range_rate + d.direction_S.dot(v);
        const double weight = 1.0 / (variance + r * r);  // Cauchy, one sigma
        information += weight * d.direction_S * d.direction_S.transpose();
        gradient -= weight * r * d.direction_S;
      }
      v += information.inverse() * gradient;
    }
    out->clear();
    for (std::size_t i = 0; i < scan.items.size(); ++i) {
      const rio::Detection& d = scan.items[i];
      const double r = d.range_rate + d.direction_S.dot(v);
      out->inlier[i] = std::abs(r) < static_bound(options_, residual_variance(d, v));
      out->outlier[i] = !out->inlier[i];
      out->range_rate[i] = d.range_rate;  // this radar does not fold
      out->inliers += out->inlier[i] ? 1 : 0;
    }
    out->v_S = v;
    out->valid = out->inliers >= 3;
    if (out->valid) out->covariance = information.inverse();
  }

  rio::FrontendOptions options_;
  rio::Frontend frontend_;
};

}  // namespace

int main() {
  const ResearchFlight research;
  rio::Pipeline<rio::Ekf> ransac(research.options);
  rio::Pipeline<rio::Ekf, LeastSquaresFrontend> own(research.options);
  const double with_ransac = fly(research, &ransac);
  const double with_own = fly(research, &own);
  std::printf("at the end of 30 m: %.4f m off with RANSAC, %.4f m with least squares\n",
              with_ransac, with_own);
  const double apart = (ransac.estimate().nav.p_WB - own.estimate().nav.p_WB).norm();
  std::printf("the two are %.1e m apart\n", apart);
  return with_own < 0.3 && apart > 0.0 ? 0 : 1;
}
