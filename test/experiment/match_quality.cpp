// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/match_quality.hpp"

#include <algorithm>
#include <limits>

#include "experiment/pipeline_drive.hpp"
#include "rio/ekf/ekf.hpp"
#include "rio/smoother/smoother.hpp"

namespace rio::experiment {

namespace {

/// Two direct echoes of one static reflector.
bool belong_together(const sim::Label& a, const sim::Label& b) {
  return a.cause == sim::Cause::kStatic && b.cause == sim::Cause::kStatic &&
         a.reflector == b.reflector;
}

double share(double part, int whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : part / whole;
}

/// A back-end that passes its inputs to the judge.
template <class BackEnd>
class Judged : public BackEnd {
 public:
  using BackEnd::BackEnd;

  MatchJudge judge;

  Status update(const Observations& seen, const ScanRows& rows) {
    judge.judge(seen, this->estimate().landmarks.size());
    return BackEnd::update(seen, rows);
  }
  void maintain_landmarks(const Observations& seen, const ScanRows& rows,
                          const Promotions& promotions, UpdateReport* report) {
    judge.tally(*report);
    std::vector<Vector3d> before;
    for (const LandmarkState& landmark : this->estimate().landmarks) {
      before.push_back(landmark.p_W);
    }
    BackEnd::maintain_landmarks(seen, rows, promotions, report);
    judge.keep(before, promotions, this->estimate());
  }
};

template <class BackEnd>
JudgedFlight judged_replay(const sim::Flight& flight, const Options& options) {
  JudgedFlight result;
  PipelineDrive<Judged<BackEnd>> drive(options);
  drive.run(
      flight.imu, flight.scans, [&](std::size_t i, Time now) { return flight.arrivals[i] < now; },
      [&](std::size_t i, const DetectionList& filtered) {
        drive.backend().judge.begin(labels_of(filtered, flight.scans[i], flight.labels[i]));
      },
      [&](std::size_t, Status status) {
        if (status != Status::kOk) return;
        const NavState& x = drive.pipeline().estimate().nav;
        const NavState truth = flight.truth_at(x.time);
        result.pairs.push_back({{truth.time, truth.p_WB, truth.q_WB}, {x.time, x.p_WB, x.q_WB}});
      });
  result.matches = drive.backend().judge.quality();
  return result;
}

}  // namespace

double MatchQuality::Matches::precision() const {
  return share(right, made);
}
double MatchQuality::recall() const {
  return share(all().right, possible);
}
double MatchQuality::Innovations::mean() const {
  return share(nis, dof);
}

sim::Label MatchJudge::Labelled::at(const Vector3d& point_S) const {
  const auto place = std::find(points_S.begin(), points_S.end(), point_S);
  return place == points_S.end() ? sim::Label{}
                                 : labels[static_cast<std::size_t>(place - points_S.begin())];
}

void MatchJudge::judge(const Observations& seen, std::size_t landmarks) {
  last_ = std::move(now_);
  now_ = {};
  now_.labels = labels_;
  for (const Detection& d : seen.scan->items) now_.points_S.push_back(d.point_S);
  if (landmarks == 0) landmarks_.clear();  // all may be dropped at once, without keep()

  const auto count = [&](const Match& m, const sim::Label& known, MatchQuality::Matches* matches) {
    const bool right = belong_together(known, labels_[m.detection]);
    ++matches->made;
    matches->right += right ? 1 : 0;
    return right;
  };
  std::vector<sim::Label> known = landmarks_;
  for (std::size_t i = 0; i < seen.trails->size(); ++i) {
    known.push_back(last_.at((*seen.trails)[i].newest().detection.point_S));
  }
  right_.assign(labels_.size(), false);
  for (const Match& m : seen.matches.landmarks) {
    right_[m.detection] = count(m, known[m.target], &quality_.landmarks);
  }
  for (const Match& m : seen.matches.trails) {
    count(m, known[landmarks_.size() + m.target], &quality_.trails);
  }
  for (const sim::Label& label : labels_) {
    const bool possible = std::any_of(
        known.begin(), known.end(), [&](const sim::Label& k) { return belong_together(k, label); });
    quality_.possible += possible ? 1 : 0;
  }
}

void MatchJudge::tally(const UpdateReport& report) {
  for (const InnovationRecord& r : report.records) {
    const bool landmark = r.model == Model::kLandmarkDistance || r.model == Model::kLandmarkPoint ||
                          r.model == Model::kLandmarkPosition;
    if (!landmark || r.result != GateResult::kUsed) continue;
    MatchQuality::Innovations& sum = right_[r.detection] ? quality_.right : quality_.wrong;
    sum.nis += r.nis;
    sum.dof += r.dof;
  }
}

void MatchJudge::keep(const std::vector<Vector3d>& before, const Promotions& births,
                      const Estimate& after) {
  const RigidPose T_WB = after.T_WB();
  const RigidPose T_BS(after.T_BS);
  std::vector<sim::Label> kept;
  for (const LandmarkState& landmark : after.landmarks) {
    const auto place = std::find(before.begin(), before.end(), landmark.p_W);
    if (place != before.end()) {
      kept.push_back(landmarks_[static_cast<std::size_t>(place - before.begin())]);
      continue;
    }
    const auto distance = [&](const Detection& d) {
      return (to_world(T_WB, T_BS, d.point_S) - landmark.p_W).norm();
    };
    const auto birth = std::min_element(
        births.births.begin(), births.births.end(),
        [&](const Detection& a, const Detection& b) { return distance(a) < distance(b); });
    kept.push_back(now_.at(birth->point_S));
  }
  landmarks_ = std::move(kept);
}

std::vector<sim::Label> labels_of(const DetectionList& filtered, const RadarScan& raw,
                                  const std::vector<sim::Label>& raw_labels) {
  std::vector<sim::Label> labels;
  std::size_t i = 0;
  for (const Detection& d : filtered.items) {
    while (raw.detections[i].point_S != d.point_S) ++i;  // the filter keeps the order
    labels.push_back(raw_labels[i++]);
  }
  return labels;
}

JudgedFlight fly_and_judge(const sim::Flight& flight, const Options& options) {
  if (options.backend == BackEnd::kSmoother) return judged_replay<Smoother>(flight, options);
  return judged_replay<Ekf>(flight, options);
}

}  // namespace rio::experiment
