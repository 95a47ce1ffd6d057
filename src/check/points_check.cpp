// SPDX-License-Identifier: BSD-3-Clause
#include "check/points_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "check/motion.hpp"
#include "check/numbers.hpp"
#include "check/point_pairs.hpp"
#include "rio/core/so3.hpp"

namespace rio::check {

namespace {

struct Rate {
  double k = 1.0;         ///< (E1)
  const char* unit = "";  ///< of the Doppler; empty for [m/s]
};

/// The configured one first, then no relation, then the other sign and the units with both.
std::vector<Rate> rates() {
  std::vector<Rate> out = {{1.0, ""}, {0.0, ""}, {-1.0, ""}};
  for (const DopplerUnit& unit : kDopplerUnits) {
    for (const double sign : {1.0, -1.0}) out.push_back({sign / unit.scale, unit.name});
  }
  return out;
}

/// Votes of (E1) for every pair of hypotheses.
class RangeVotes {
 public:
  explicit RangeVotes(std::vector<Rate> all)
      : all_(std::move(all)), votes_(all_.size() * all_.size()) {
    for (const Rate& rate : all_) largest_ = std::max(largest_, std::abs(rate.k));
  }

  /// Largest change of range under any hypothesis, for a point with at most this configured one
  /// [m].
  double farthest(double configured) const { return largest_ * std::abs(configured) + kBound; }

  void add(double moved, double configured, std::size_t block) {
    std::uint32_t supported = 0;  // one bit each
    for (std::size_t a = 0; a < all_.size(); ++a) {
      const bool fits = std::abs(moved - all_[a].k * configured) < kBound;
      supported |= static_cast<std::uint32_t>(fits) << a;
    }
    if (supported == 0) return;
    for (std::size_t a = 0; a < all_.size(); ++a) {
      if ((supported >> a & 1U) == 0) continue;
      for (std::size_t b = 0; b < all_.size(); ++b) {
        if ((supported >> b & 1U) != 0) continue;
        if (std::abs((all_[a].k - all_[b].k) * configured) < 2.0 * kBound)
          continue;  // both may be true
        votes_[std::min(a, b) * all_.size() + std::max(a, b)].add(block, a < b, b < a);
      }
    }
  }
  const Support& of(std::size_t a, std::size_t b) const { return votes_[a * all_.size() + b]; }
  /// The one better than every other; the first if there is none.
  std::size_t winner() const {
    for (std::size_t a = 1; a < all_.size(); ++a) {
      bool best = true;
      for (std::size_t b = 0; b < all_.size() && best; ++b) {
        if (a == b) continue;
        const Support& votes = of(std::min(a, b), std::max(a, b));
        best = a < b ? votes.lead() > 0.0 : votes.lead() < 0.0;
      }
      if (best) return a;
    }
    return 0;
  }

 private:
  static constexpr double kBound = 3.0 * kRangeBin;

  std::vector<Rate> all_;
  double largest_ = 0.0;  ///< largest factor of the hypotheses
  std::vector<Support> votes_;
};

constexpr double kChange = 0.3;  // of a range rate between two scans

bool same_direction(const Point& a, const Point& b, double a_range, double b_range) {
  constexpr double kCosine = 0.95;  // of their directions
  return a.point_S.dot(b.point_S) > kCosine * a_range * b_range;
}

std::string change_of(const Rate& rate, const Advice& advice) {
  std::string change = rate.k < 0.0 ? advice.negate_doppler() : "";
  const double factor = std::abs(rate.k);
  if (factor == 1.0) return change;
  if (!change.empty()) change += ", and ";
  return change + advice.scale("doppler", factor);
}

std::string meaning_of(const Rate& rate) {
  std::string sign = rate.k < 0.0 ? "the Doppler has the wrong sign" : "";
  if (*rate.unit == '\0') return sign;
  const std::string unit = fmt::format("the Doppler is {}", rate.unit);
  return sign.empty() ? unit : sign + " and " + unit;
}

/// (E2) of the rates taken as deg/s against the rates as given, with every mounting.
class TurnVotes {
 public:
  explicit TurnVotes(const Quaternion& configured) {
    for (const Axes& axes : candidates(configured)) {
      const auto is_same = [&](const Matrix3d& R) { return (R - axes.R).norm() < 1e-6; };
      if (std::ranges::none_of(mountings_, is_same)) mountings_.push_back(axes.R);
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
    for (const Point& a : from.detections) {
      const double a_range = a.point_S.norm();
      for (const Point& b : to.detections) {
        const double b_range = b.point_S.norm();
        const bool as_far = std::abs(b_range - a_range) < 6.0 * kRangeBin;
        if (!as_far || !(std::min(a_range, b_range) > 0.1)) continue;
        const Vector3d u = a.point_S / a_range;
        const Vector3d v = b.point_S / b_range;
        if ((u - v).squaredNorm() < farthest) add(u, v, small, block);
      }
    }
  }
  /// For the mounting with which the rates as given do best.
  const Support& best() const { return *std::ranges::min_element(votes_, {}, &Support::lead); }

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

std::optional<Finding> check_repeated(const Scans& scans) {
  constexpr double kMany = 0.4;  // at rest one in eight is, on its grids
  std::size_t points = 0;
  std::size_t same = 0;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    const Point* last = nullptr;
    for (const Point& d : scans[i].detections) {  // a list may be filled with copies of one point
      const bool copy = last != nullptr && d.point_S == last->point_S;
      last = &d;
      if (copy) continue;
      ++points;
      const auto equals = [&d](const Point& p) {
        return p.point_S == d.point_S && p.range_rate == d.range_rate && p.snr_db == d.snr_db;
      };
      same += std::ranges::any_of(scans[i - 1].detections, equals) ? 1U : 0U;
    }
  }
  const double share = static_cast<double>(same) / static_cast<double>(points);
  if (!(share > kMany)) return std::nullopt;
  return Finding{Verdict::kDoubtful, "repeated points",
                 fmt::format("{:.0f} % of the points are also in the scan before", 100.0 * share),
                 "record each scan once and alone: a driver or node sends it again, or several "
                 "together"};
}

RangeCheck check_ranges(const Scans& scans, const Options& options, const Advice& advice) {
  const std::vector<Rate> all = rates();
  RangeVotes votes(all);
  const double least = options.radar.min_range;
  each_pair_of_scans(
      scans, [&](const ScanView& from, const ScanView& to, double dt, std::size_t block) {
        for (const Point& a : from.detections) {
          const double a_range = a.point_S.norm();
          if (a.range_rate == 0.0 || !(a_range > least)) continue;
          const double farthest = votes.farthest((1.0 + kChange) * a.range_rate * dt);
          for (const Point& b : to.detections) {
            const double b_range = b.point_S.norm();
            const double moved = b_range - a_range;
            const bool near = std::abs(moved) <= farthest;
            const bool alike =
                std::abs(b.range_rate - a.range_rate) <= kChange * std::abs(a.range_rate);
            if (!near || !alike || !same_direction(a, b, a_range, b_range)) continue;
            votes.add(moved, 0.5 * (a.range_rate + b.range_rate) * dt, block);
          }
        }
      });
  const Support& signs = votes.of(0, 2);
  Finding out{Verdict::kOk, "Doppler by the ranges",
              fmt::format("between scans the range changes as the Doppler says in {:.0f} pairs of "
                          "points, as with the other sign in {:.0f}",
                          signs.of_first(), signs.of_second())};
  const std::size_t best = votes.winner();
  const Rate& rate = all[best];
  if (signs.reversed().leans()) {
    out.verdict = Verdict::kDoubtful;
    out.change = advice.negate_doppler() + ", if a longer recording says the same";
    return {out, DopplerSign::kLeansOpposite};
  }
  if (best == 0 || rate.k == 0.0) {
    const bool as_configured = signs.is_sure() || signs.leans();
    return {out, as_configured ? DopplerSign::kAsConfigured : DopplerSign::kUnknown};
  }
  const Support& against = votes.of(0, best);
  if (!against.reversed().is_sure()) return {out};
  out.verdict = Verdict::kWrong;
  out.text = fmt::format(
      "between scans the range changes as the Doppler says in {:.0f} pairs of "
      "points, in {:.0f} by {:.4g} times that, by {:.1f} sigmas: {}",
      against.of_first(), against.of_second(), rate.k, -against.sure(), meaning_of(rate));
  out.change = change_of(rate, advice);
  return {out, rate.k < 0.0 ? DopplerSign::kOpposite : DopplerSign::kAsConfigured};
}

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
