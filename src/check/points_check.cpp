// SPDX-License-Identifier: BSD-3-Clause
#include "check/points_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "check/point_pairs.hpp"
#include "check/units.hpp"

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

}  // namespace

RangeCheck check_ranges(const Scans& scans, const Options& options, const Advice& advice) {
  const std::vector<Rate> all = rates();
  RangeVotes votes(all);
  const double least = options.radar.min_range;
  std::vector<double> ranges;
  std::vector<double> range_rates;
  std::vector<std::size_t> candidates;
  each_pair_of_scans(
      scans, [&](const ScanView& from, const ScanView& to, double dt, std::size_t block) {
        ranges_of(to, &ranges);
        range_rates.clear();
        for (const Point& b : to.detections) range_rates.push_back(b.range_rate);
        for (const Point& a : from.detections) {
          const double range = a.point_S.norm();
          if (a.range_rate == 0.0 || !(range > least)) continue;
          const double farthest = votes.farthest((1.0 + kChange) * a.range_rate * dt);
          const double change = kChange * std::abs(a.range_rate);
          const auto reachable = [farthest, range, rate = a.range_rate, change, r = ranges.data(),
                                  v = range_rates.data()](std::size_t k) {
            const bool near = std::abs(r[k] - range) <= farthest;
            const bool alike = std::abs(v[k] - rate) <= change;
            return near && alike;
          };
          select(ranges.size(), reachable, &candidates);
          for (const std::size_t k : candidates) {
            const Point& b = to.detections[k];
            if (!same_direction(a, b, range, ranges[k])) continue;
            votes.add(ranges[k] - range, 0.5 * (a.range_rate + b.range_rate) * dt, block);
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
    return {out};
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

}  // namespace rio::check
