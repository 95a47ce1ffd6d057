// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "check/motion.hpp"
#include "check/point_pairs.hpp"
#include "check/points_check.hpp"
#include "check/units.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

/// (E2) of the rates taken as deg/s against the rates as given, with every mounting.
class TurnVotes {
 public:
  explicit TurnVotes(const Quaternion& configured) {
    for (const Axes& axes : candidates(configured)) {
      const bool known = std::any_of(mountings_.begin(), mountings_.end(),
                                     [&](const Matrix3d& R) { return (R - axes.R).norm() < 1e-6; });
      if (!known) mountings_.push_back(axes.R);
    }
    votes_.resize(mountings_.size());
    turns_.resize(mountings_.size());
  }

  /// @param as_given, in_degrees rotation of the body from one scan to the other, in its axes
  void add(const ScanView& from, const ScanView& to, const Quaternion& as_given,
           const Quaternion& in_degrees, std::size_t block) {
    const Vector3d phi = quaternion_log(as_given);
    if (phi.norm() < 2.0 * kBound) return;  // both would be true
    for (std::size_t m = 0; m < turns_.size(); ++m) {
      turns_[m] = quaternion_exp(-(mountings_[m].transpose() * phi)).toRotationMatrix();
    }
    const Matrix3d& R = mountings_.front();
    const Matrix3d small = R.transpose() * in_degrees.toRotationMatrix().transpose() * R;
    const double turned = std::max(phi.norm(), quaternion_log(in_degrees).norm());
    const double farthest = (turned + kBound) * (turned + kBound);
    ranges_of(to, &ranges_);
    for (const Point& a : from.detections) {
      const double range = a.point_S.norm();
      const auto as_far = [range, r = ranges_.data()](std::size_t k) {
        return std::abs(r[k] - range) < 6.0 * kRangeBin;
      };
      select(ranges_.size(), as_far, &candidates_);
      for (const std::size_t k : candidates_) {
        if (!(std::min(range, ranges_[k]) > 0.1)) continue;
        const Vector3d u = a.point_S / range;
        const Vector3d v = to.detections[k].point_S / ranges_[k];
        if ((u - v).squaredNorm() < farthest) add(u, v, small, block);
      }
    }
  }
  /// For the mounting with which the rates as given do best.
  const Support& best() const {
    return *std::min_element(votes_.begin(), votes_.end(), [](const Support& a, const Support& b) {
      return a.lead() < b.lead();
    });
  }

 private:
  static constexpr double kAngle = 0.05;  ///< sigma_u, of four antennas [rad]
  static constexpr double kBound = 3.0 * kAngle;

  /// @param u,v directions of the points
  void add(const Vector3d& u, const Vector3d& v, const Matrix3d& small, std::size_t block) {
    constexpr double kSquare = kBound * kBound;
    const bool in_degrees = (small * u - v).squaredNorm() < kSquare;
    for (std::size_t m = 0; m < turns_.size(); ++m) {
      const bool as_given = (turns_[m] * u - v).squaredNorm() < kSquare;
      if (as_given || in_degrees) votes_[m].add(block, in_degrees, as_given);
    }
  }

  std::vector<Matrix3d> mountings_;
  std::vector<Support> votes_;
  std::vector<Matrix3d> turns_;  ///< rotations of the scene between two scans
  std::vector<double> ranges_;   ///< of the points of the later scan
  std::vector<std::size_t> candidates_;
};

/// (E2) of the rates taken as deg/s against this many times those as given.
Support turn_votes(const std::vector<ImuSample>& samples, const Scans& scans,
                   const Options& options, double factor) {
  const ImuPath as_given(samples, factor, 1.0);
  const ImuPath in_degrees(samples, kDegree, 1.0);
  TurnVotes votes(options.radar.T_BS.rotation);
  each_pair_of_scans(scans,
                     [&](const ScanView& from, const ScanView& to, double, std::size_t block) {
                       const auto turn = [&](const ImuPath& path) -> std::optional<Quaternion> {
                         const auto first = path.at(from.time);
                         const auto last = path.at(to.time);
                         if (!first || !last) return std::nullopt;
                         return first->turn.conjugate() * last->turn;
                       };
                       const auto whole = turn(as_given);
                       if (whole) votes.add(from, to, *whole, *turn(in_degrees), block);
                     });
  return votes.best();
}

}  // namespace

std::optional<Finding> check_rates(const std::vector<ImuSample>& samples, const Scans& scans,
                                   const Options& options, const Advice& advice) {
  const Support best = turn_votes(samples, scans, options, 1.0);
  if (!best.is_sure()) return std::nullopt;
  for (const double range : {0.5, 0.25}) {  // a wrong range of the gyro is no other unit
    if (!turn_votes(samples, scans, options, range).is_sure()) return std::nullopt;
  }
  return Finding{Verdict::kWrong, "gyro unit by the points",
                 fmt::format("between scans the points turn as the gyro says in {:.0f} pairs of "
                             "points, with the rates taken as deg/s in {:.0f}, by {:.1f} sigmas: "
                             "they are in deg/s",
                             best.of_second(), best.of_first(), best.sure()),
                 advice.gyro_in("deg/s", kDegree)};
}

}  // namespace rio::check
