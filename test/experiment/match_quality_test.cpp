// SPDX-License-Identifier: BSD-3-Clause
// The judge of matches: on scans written by hand, and on flights whose answer is known.
#include "experiment/match_quality.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "experiment/campaign.hpp"

namespace rio::experiment {
namespace {

using sim::Cause;
using sim::Label;

/// Scans and matches written by hand; detection i of a scan lies at (scan + 1, i, 0).
class MatchJudgeTest : public testing::Test {
 protected:
  void begin(const std::vector<Label>& labels) {
    ++scan_;
    list_.items.clear();
    for (std::size_t i = 0; i < labels.size(); ++i) {
      list_.items.push_back(
          make_detection({.point_S = {scan_ + 1.0, static_cast<double>(i), 0.0}}, RadarOptions{}));
    }
    seen_.scan = &list_;
    seen_.trails = &trails_;
    seen_.matches = AssociationResult{};
    judge_.begin(labels);
  }
  /// A trail that ends in a detection of the scan at hand.
  void leave_trail(std::size_t detection) { trails_.create({0, list_.items[detection]}); }
  void judge() { judge_.judge(seen_, estimate_.landmarks.size()); }
  /// A landmark where a detection of the scan at hand is, the radar at the origin.
  void bear(std::size_t detection) {
    LandmarkState landmark;
    landmark.p_W = list_.items[detection].point_S;
    estimate_.landmarks.push_back(landmark);
    births_.births.push_back(list_.items[detection]);
  }
  std::vector<Vector3d> places() const {
    std::vector<Vector3d> all;
    for (const LandmarkState& landmark : estimate_.landmarks) all.push_back(landmark.p_W);
    return all;
  }

  double scan_ = 0.0;
  DetectionList list_;
  TrailSet trails_{8, 3};
  Observations seen_;
  Estimate estimate_;
  Promotions births_;
  MatchJudge judge_;
};

TEST_F(MatchJudgeTest, ATrailStandsForTheReflectorOfItsNewestDetection) {
  begin({{Cause::kStatic, 5}, {Cause::kStatic, 6}, {Cause::kMirror, 5}});
  judge();
  EXPECT_EQ(judge_.quality().possible, 0);
  EXPECT_TRUE(std::isnan(judge_.quality().recall()));
  EXPECT_TRUE(std::isnan(judge_.quality().trails.precision()));
  for (const std::size_t i : {0U, 1U, 2U}) leave_trail(i);
  // 6, 5, the image of 5, and 7, which nothing stands for
  begin({{Cause::kStatic, 6}, {Cause::kStatic, 5}, {Cause::kMirror, 5}, {Cause::kStatic, 7}});
  seen_.matches.trails.push_back({1, 0});  // right
  seen_.matches.trails.push_back({0, 3});  // 5 is not 7
  seen_.matches.trails.push_back({2, 2});  // an image is no reflector
  judge();
  EXPECT_EQ(judge_.quality().trails.made, 3);
  EXPECT_EQ(judge_.quality().trails.right, 1);
  EXPECT_EQ(judge_.quality().landmarks.made, 0);
  EXPECT_EQ(judge_.quality().possible, 2);
  EXPECT_DOUBLE_EQ(judge_.quality().trails.precision(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(judge_.quality().recall(), 0.5);
}

TEST_F(MatchJudgeTest, ALandmarkStandsForTheReflectorItWasBornFrom) {
  begin({{Cause::kStatic, 5}, {Cause::kStatic, 6}, {Cause::kStatic, 7}});
  judge();
  bear(2);
  bear(0);
  judge_.keep({}, births_, estimate_);
  const std::vector<Label> labels = {{Cause::kStatic, 5}, {Cause::kStatic, 7}};
  begin(labels);
  seen_.matches.landmarks.push_back({0, 1});  // 7 is 7
  seen_.matches.landmarks.push_back({1, 0});  // 5 is 5
  judge();
  EXPECT_EQ(judge_.quality().landmarks.right, 2);
  EXPECT_DOUBLE_EQ(judge_.quality().recall(), 1.0);
  // the first leaves, the second takes its place: the same match is wrong now
  births_.births.clear();
  const std::vector<Vector3d> before = places();
  estimate_.landmarks[0] = estimate_.landmarks[1];
  estimate_.landmarks.pop_back();
  judge_.keep(before, births_, estimate_);
  begin(labels);
  seen_.matches.landmarks.push_back({0, 1});
  judge();
  EXPECT_EQ(judge_.quality().landmarks.made, 3);
  EXPECT_EQ(judge_.quality().landmarks.right, 2);
  EXPECT_EQ(judge_.quality().possible, 3);
}

TEST_F(MatchJudgeTest, InnovationsOfRightAndWrongMatchesAreCountedApart) {
  begin({{Cause::kStatic, 5}, {Cause::kStatic, 6}});
  judge();
  bear(0);
  bear(1);
  judge_.keep({}, births_, estimate_);
  begin({{Cause::kStatic, 5}, {Cause::kStatic, 7}});
  seen_.matches.landmarks.push_back({0, 0});
  seen_.matches.landmarks.push_back({1, 1});  // 6 is not 7
  judge();
  UpdateReport report;
  const auto record = [&report](Model model, GateResult result, std::uint16_t detection,
                                double nis) {
    report.records.push_back(
        {.model = model, .result = result, .detection = detection, .dof = 3, .nis = nis});
  };
  record(Model::kLandmarkPoint, GateResult::kUsed, 0, 2.0);
  record(Model::kLandmarkPosition, GateResult::kUsed, 0, 4.0);
  record(Model::kLandmarkPoint, GateResult::kUsed, 1, 9.0);
  record(Model::kLandmarkPoint, GateResult::kGated, 1, 99.0);
  record(Model::kDoppler, GateResult::kUsed, 0, 99.0);
  judge_.tally(report);
  EXPECT_DOUBLE_EQ(judge_.quality().right.mean(), 1.0);
  EXPECT_DOUBLE_EQ(judge_.quality().wrong.mean(), 3.0);
  EXPECT_TRUE(std::isnan(MatchQuality{}.right.mean()));
}

TEST_F(MatchJudgeTest, DroppedLandmarksAreForgotten) {
  begin({{Cause::kStatic, 5}});
  judge();
  bear(0);
  judge_.keep({}, births_, estimate_);
  estimate_.landmarks.clear();
  begin({{Cause::kStatic, 5}});
  judge();
  EXPECT_EQ(judge_.quality().possible, 0);
}

TEST(LabelsOf, FollowTheFilter) {
  RadarScan raw;
  for (int i = 0; i < 6; ++i) raw.detections.push_back({.point_S = {1.0 + i, 0.0, 0.0}});
  raw.detections[1].point_S.x() = 0.01;  // too near
  raw.detections[4].range_rate = NAN;
  std::vector<Label> labels;
  for (int i = 0; i < 6; ++i) labels.push_back({Cause::kStatic, i});
  DetectionList filtered;
  filter_detections(raw, RadarOptions{}, 128, filtered);
  std::vector<int> reflectors;
  for (const Label& l : labels_of(filtered, raw, labels)) reflectors.push_back(l.reflector);
  EXPECT_EQ(reflectors, (std::vector<int>{0, 2, 3, 5}));
}

sim::Flight short_flight() {
  sim::Scenario s = cases_of("monte-carlo", 1, 501).front().scenario;
  s.path.length = 15.0;
  return sim::simulate_flight(s);
}

// The research API as driven here is the odometry API: a judged flight tells of the estimator that
// users get.
TEST(FlyAndJudge, GivesTheEstimatesOfDoorOne) {
  const sim::Flight flight = short_flight();
  for (const char* name : {"published-uncertainty", "published-ekf", "default"}) {
    const Options options = options_for(flight, name);
    const std::vector<eval::PosePair> expected = pose_pairs(fly(flight, options));
    const std::vector<eval::PosePair> judged = fly_and_judge(flight, options).pairs;
    ASSERT_EQ(judged.size(), expected.size()) << name;
    for (std::size_t i = 0; i < judged.size(); ++i) {
      ASSERT_EQ(judged[i].estimate.p, expected[i].estimate.p) << name << " " << i;
      ASSERT_EQ(judged[i].truth.p, expected[i].truth.p) << name << " " << i;
    }
  }
}

// With points so sharp that nothing can be mistaken, all matches are right and hardly one is
// missed.
TEST(FlyAndJudge, SharpPointsAreMatchedRightly) {
  sim::Scenario s = cases_of("monte-carlo", 1, 502).front().scenario;
  s.path.length = 15.0;
  s.radar.sigma_range = 0.002;
  s.radar.sigma_azimuth = s.radar.sigma_elevation = 0.002;
  const sim::Flight flight = sim::simulate_flight(s);
  const MatchQuality m =
      fly_and_judge(flight, options_for(flight, "published-uncertainty")).matches;
  EXPECT_GT(m.landmarks.made, 1000);
  EXPECT_GT(m.trails.made, 1000);
  EXPECT_GT(m.landmarks.precision(), 0.98);
  EXPECT_GT(m.trails.precision(), 0.98);
  EXPECT_GT(m.recall(), 0.9);
}

}  // namespace
}  // namespace rio::experiment
