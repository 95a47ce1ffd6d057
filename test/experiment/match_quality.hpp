// SPDX-License-Identifier: BSD-3-Clause
// Quality of data association: the matches of a simulated flight against the true origin of every
// detection. A match is right if it joins two direct echoes of one static reflector; ghosts, false
// alarms, people and moving highlights have no right match.
//
// (E1) precision = right matches / matches
// (E2) recall    = right matches / direct echoes of reflectors represented by a landmark or a trail
//
// A landmark represents the reflector of the detection from which it was initialised, a trail that
// of its newest detection. Right matches count once: a detection has at most one match.
#pragma once

#include <cstddef>
#include <vector>

#include "rio/eval/pairing.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/sim/flight.hpp"
#include "rio/state/estimate.hpp"

namespace rio::experiment {

/// Counts over a flight.
struct MatchQuality {
  struct Matches {
    int made = 0;
    int right = 0;
    double precision() const;  ///< (E1), NaN without matches
  };
  /// Innovations of the matches with landmarks that were used.
  struct Innovations {
    double nis = 0.0;
    int dof = 0;
    double mean() const;  ///< NIS over its degrees of freedom, NaN if there are none
  };
  Matches landmarks;
  Matches trails;
  int possible = 0;  ///< direct echoes of a reflector represented by a landmark or a trail
  Innovations right;
  Innovations wrong;

  Matches all() const { return {landmarks.made + trails.made, landmarks.right + trails.right}; }
  double recall() const;  ///< (E2), NaN if nothing was possible
};

/// Tracks which reflector every trail and landmark represents, and counts. One call per step:
/// begin, judge, tally, keep.
class MatchJudge {
 public:
  /// A new scan. @param labels of its filtered detections, same order
  void begin(const std::vector<sim::Label>& labels) { labels_ = labels; }
  /// Counts the scan's matches. @param landmarks of the predicted estimate
  void judge(const Observations& seen, std::size_t landmarks);
  /// Counts the innovations of the matches just judged.
  void tally(const UpdateReport& report);
  /// Reflectors of the landmarks after some were removed and others added.
  /// @param before positions of the landmarks before that, in the form `after` has for those that
  /// stayed
  /// @param births in any order
  void keep(const std::vector<Vector3d>& before, const Promotions& births, const Estimate& after);

  const MatchQuality& quality() const { return quality_; }

 private:
  /// The detections of a scan with their labels.
  struct Labelled {
    std::vector<Vector3d> points_S;
    std::vector<sim::Label> labels;

    /// Label of the detection at exactly this point; of a false alarm if there is none.
    sim::Label at(const Vector3d& point_S) const;
  };

  std::vector<sim::Label> labels_;
  Labelled now_;
  Labelled last_;  ///< of the previous scan: the ends of the trails
  std::vector<sim::Label> landmarks_;
  std::vector<bool> right_;  ///< per detection: its match with a landmark
  MatchQuality quality_;
};

/// The labels of the detections that passed the filter. @param raw the filter's input
std::vector<sim::Label> labels_of(const DetectionList& filtered, const RadarScan& raw,
                                  const std::vector<sim::Label>& raw_labels);

/// A flight with judged matches.
struct JudgedFlight {
  std::vector<eval::PosePair> pairs;  ///< one per processed scan
  MatchQuality matches;
};

/// Flies through the research API as Odometry does with these options: the same estimates, for a
/// radar without latency and an estimator with static alignment.
JudgedFlight fly_and_judge(const sim::Flight& flight, const Options& options);

}  // namespace rio::experiment
