// SPDX-License-Identifier: BSD-3-Clause
// The multi-state EKF as a whole: clones, landmarks, gates, records, calibration.
#include "rio/ekf/ekf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <set>

#include "experiment/trial.hpp"
#include "rio/core/so3.hpp"
#include "rio/pipeline.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

using experiment::options_for;

/// A flight fed to the pipeline scan by scan.
class EkfTest : public testing::Test {
 protected:
  static const sim::Flight& flight() {
    static const sim::Flight flight = [] {
      sim::Scenario o = sim::Scenario::ideal();
      o.seed = 8;
      o.path.length = 20.0;
      return sim::simulate_flight(o);
    }();
    return flight;
  }
  void start(const Options& options) {
    options_ = options;
    options_.timing.imu_buffer = 100000;  // the whole flight
    imu_ = std::make_unique<ImuBuffer>(options_.timing, options_.imu);
    for (const ImuSample& sample : flight().imu) imu_->push_back(sample);
    pipeline_ = std::make_unique<Pipeline<Ekf>>(options_);
    BodyCovariance P0 = BodyCovariance::Identity() * 1e-4;
    P0.block<3, 3>(body::kAccelBias, body::kAccelBias) *= 25.0;
    pipeline_->reset(flight().truth.front(), P0);
  }
  Status process(const RadarScan& scan) {
    filter_detections(scan, options_.radar, options_.frontend.max_detections, list_);
    return pipeline_->process(list_, *imu_);
  }

  Options options_;
  std::unique_ptr<ImuBuffer> imu_;
  std::unique_ptr<Pipeline<Ekf>> pipeline_;
  DetectionList list_;
};

TEST_F(EkfTest, KeepsTheLastClonesFirstInFirstOut) {
  start(options_for(flight(), "published-ekf"));
  for (std::size_t i = 0; i < 20; ++i) {
    ASSERT_EQ(process(flight().scans[i]), Status::kOk);
    const Estimate& x = pipeline_->estimate();
    ASSERT_EQ(x.clones.size(), std::min<std::size_t>(i + 1, 7));
    for (ScanId id = i >= 7 ? i - 6 : 0; id <= i; ++id) EXPECT_GE(x.find_clone(id), 0);
    // the newest clone is the corrected pose of this scan
    const Clone& newest = x.clones[static_cast<std::size_t>(x.find_clone(i))];
    EXPECT_EQ(newest.T_WB.R, x.T_WB().R);
    EXPECT_EQ(newest.T_WB.p, x.T_WB().p);
  }
}

TEST_F(EkfTest, LandmarksEnterAfterSevenMatchesAndLeaveAtTheFirstMiss) {
  start(options_for(flight(), "published-ekf"));
  for (std::size_t i = 0; i < 7; ++i) {
    ASSERT_EQ(process(flight().scans[i]), Status::kOk);
    EXPECT_EQ(pipeline_->report().landmarks, 0);
  }
  ASSERT_EQ(process(flight().scans[7]), Status::kOk);  // born at 0, matched by 1 to 7
  const int landmarks = pipeline_->report().landmarks;
  EXPECT_GT(landmarks, 0);
  EXPECT_LE(landmarks, options_.update.max_landmarks);
  ASSERT_EQ(process({flight().scans[8].time, {}}), Status::kOk);  // nothing seen: all missed
  EXPECT_EQ(pipeline_->report().landmarks, 0);
  EXPECT_EQ(pipeline_->report().landmarks_removed, landmarks);
  EXPECT_EQ(pipeline_->report().trails, 0);
}

TEST_F(EkfTest, LandmarksSurviveUntilTheirTimeout) {
  Options o = options_for(flight(), "published-ekf");
  o.frontend.landmark_timeout = 2.5 / 15.0;  // between the second and the third missed scan
  o.update.max_landmarks = 3;
  start(o);
  for (std::size_t i = 0; i < 9; ++i) ASSERT_EQ(process(flight().scans[i]), Status::kOk);
  EXPECT_EQ(pipeline_->report().landmarks, 3);  // no more than there is room for
  std::size_t next = 9;
  for (const int left : {3, 3, 0}) {  // two empty scans are tolerated
    ASSERT_EQ(process({flight().scans[next++].time, {}}), Status::kOk);
    EXPECT_EQ(pipeline_->report().landmarks, left);
  }
}

// Seen again from the same place a reflector repeats its error.
TEST_F(EkfTest, AtRestLandmarksFromBeforeStayAndTellNothing) {
  start(options_for(flight(), "default"));
  constexpr auto kPoint = static_cast<std::size_t>(Model::kLandmarkPoint);
  int used_before_takeoff = 0;
  int used_after_landing = 0;
  int matched_after_landing = 0;
  for (const RadarScan& scan : flight().scans) {
    ASSERT_EQ(process(scan), Status::kOk);
    const UpdateReport& report = pipeline_->report();
    if (!report.at_rest || report.landmarks_matched == 0) continue;
    const int rows = report.models[kPoint].rows_used + report.models[kPoint].rows_gated;
    const Estimate& x = pipeline_->estimate();
    if (x.distance_travelled < 0.3) used_before_takeoff += rows;
    if (x.distance_travelled < 10.0) continue;
    matched_after_landing += report.landmarks_matched;
    used_after_landing += rows / 4;  // of those first measured on the last decimetres
  }
  EXPECT_GT(used_before_takeoff, 5);
  EXPECT_GT(matched_after_landing, 5);
  EXPECT_LT(used_after_landing, matched_after_landing - 20);  // those from before
}

TEST_F(EkfTest, OutlierIsGatedAndRecorded) {
  Options o = options_for(flight(), "default");
  o.frontend.ransac_threshold = 10.0;  // nothing is sorted out before the gate
  o.frontend.mover_sigmas = 0.0;
  start(o);
  for (std::size_t i = 0; i < 5; ++i) ASSERT_EQ(process(flight().scans[i]), Status::kOk);
  RadarScan scan = flight().scans[5];
  scan.detections[0].range_rate += 1.0;
  ASSERT_EQ(process(scan), Status::kOk);
  bool found = false;
  for (const InnovationRecord& record : pipeline_->report().records) {
    if (record.model != Model::kDoppler || record.detection != 0) continue;
    found = true;
    EXPECT_EQ(record.result, GateResult::kGated);
    EXPECT_NEAR(record.innovation, 1.0, 0.2);
    EXPECT_NEAR(record.nis, std::pow(record.innovation / record.sigma, 2), 1e-9);
    EXPECT_GT(record.nis, record.gate);
    EXPECT_NEAR(record.gate, 6.635, 1e-3);  // chi-squared, 99 %, one degree
  }
  EXPECT_TRUE(found);
  const ModelReport& doppler =
      pipeline_->report().models[static_cast<std::size_t>(Model::kDoppler)];
  EXPECT_EQ(doppler.rows_used + doppler.rows_gated, static_cast<int>(scan.detections.size()));
}

// Records say which detection of the scan as received they are of, the vehicle's own among these.
TEST_F(EkfTest, TheVehiclesOwnEchoesTellNothingAndAreCounted) {
  Options o = options_for(flight(), "default");
  o.frontend.ransac_threshold = 10.0;  // nothing is sorted out before the gate
  o.frontend.mover_sigmas = 0.0;
  start(o);
  constexpr std::size_t kOwn = 2;
  constexpr std::size_t kWrong = 4;
  RadarDetection echo;
  echo.point_S = Vector3d(0.6, 0.1, -0.2);
  echo.snr_db = 30.0;
  int gated = 0;
  for (std::size_t i = 0; i < 120; ++i) {
    RadarScan scan = flight().scans[i];
    ASSERT_GT(scan.detections.size(), kWrong);
    scan.detections.insert(scan.detections.begin() + kOwn, echo);
    const bool wrong = i > 110;
    if (wrong) scan.detections[kWrong].range_rate += 1.0;
    ASSERT_EQ(process(scan), Status::kOk);
    if (!wrong) continue;
    for (const InnovationRecord& record : pipeline_->report().records) {
      EXPECT_NE(record.detection, kOwn);
      if (record.model != Model::kDoppler || record.result != GateResult::kGated) continue;
      gated += record.detection == kWrong ? 1 : 0;
    }
  }
  EXPECT_GE(gated, 8);  // of nine
}

TEST_F(EkfTest, EachDetectionIsUsedOnce) {
  start(options_for(flight(), "default"));
  int points = 0;
  int doppler = 0;
  for (std::size_t i = 0; i < 150; ++i) {  // the first 60 at rest
    ASSERT_EQ(process(flight().scans[i]), Status::kOk);
    std::set<int> used;
    for (const InnovationRecord& record : pipeline_->report().records) {
      if (record.result != GateResult::kUsed || record.model == Model::kRest) continue;
      EXPECT_TRUE(used.insert(record.detection).second) << record.detection;
      EXPECT_TRUE(record.model == Model::kLandmarkPoint || record.model == Model::kDoppler);
      points += record.model == Model::kLandmarkPoint ? 1 : 0;
      doppler += record.model == Model::kDoppler ? 1 : 0;
      EXPECT_EQ(record.dof, record.model == Model::kLandmarkPoint ? 4 : 1);
    }
  }
  EXPECT_GT(points, 100);
  EXPECT_GT(doppler, 100);
}

TEST_F(EkfTest, SilenceOfTheRadarEndsTheLandmarks) {
  start(options_for(flight(), "default"));
  std::size_t i = 0;
  for (; i < 60; ++i) ASSERT_EQ(process(flight().scans[i]), Status::kOk);
  const int before = pipeline_->report().landmarks;
  ASSERT_GT(before, 0);
  i += 14;  // 15 periods are one second: not yet
  ASSERT_EQ(process(flight().scans[i]), Status::kOk);
  EXPECT_GT(pipeline_->report().landmarks, 0);
  i += 17;
  ASSERT_EQ(process(flight().scans[i]), Status::kOk);
  EXPECT_EQ(pipeline_->report().landmarks, 0);
  EXPECT_EQ(pipeline_->report().landmarks_matched, 0);
}

TEST_F(EkfTest, OfTooManyLandmarksTheLongestUnseenGivesWay) {
  Options o = options_for(flight(), "default");
  o.update.max_landmarks = 3;
  o.frontend.landmark_timeout = 1000.0;
  start(o);
  int replaced = 0;
  for (const RadarScan& scan : flight().scans) {
    StaticVector<LandmarkState, kMaxLandmarks> before = pipeline_->estimate().landmarks;
    ASSERT_EQ(process(scan), Status::kOk);
    const UpdateReport& report = pipeline_->report();
    ASSERT_LE(report.landmarks, 3);
    if (report.landmarks_removed != 1) continue;
    ++replaced;
    Time oldest = scan.time;
    for (const LandmarkState& landmark : before) oldest = std::min(oldest, landmark.last_seen);
    EXPECT_GT(to_seconds(scan.time - oldest), 7.9);  // what is in view stays
    for (const LandmarkState& landmark : pipeline_->estimate().landmarks) {
      EXPECT_GE(landmark.last_seen, oldest);
    }
  }
  EXPECT_GT(replaced, 3);  // none in view gives way, and the flight lasts some seconds
}

TEST_F(EkfTest, FindsAMountingError) {
  Options o = options_for(flight(), "default");
  const Quaternion truth = o.radar.T_BS.rotation;
  o.radar.T_BS.rotation = (truth * quaternion_exp(Vector3d(0.02, 0.03, -0.02))).normalized();
  start(o);
  const auto error = [&] {
    return quaternion_log(truth.conjugate() * pipeline_->estimate().T_BS.rotation).norm();
  };
  const double before = error();
  for (const RadarScan& scan : flight().scans) ASSERT_EQ(process(scan), Status::kOk);
  EXPECT_NEAR(before, 0.041, 0.001);
  EXPECT_LT(error(), 0.3 * before);
  // held fixed when its sigma is zero
  o.calibration.rotation_sigma = o.calibration.translation_sigma = 0.0;
  start(o);
  for (std::size_t i = 0; i < 50; ++i) ASSERT_EQ(process(flight().scans[i]), Status::kOk);
  EXPECT_EQ(error(), before);
}

TEST_F(EkfTest, CovarianceStaysSymmetricAndPositiveSemiDefinite) {
  start(options_for(flight(), "default"));
  for (std::size_t i = 0; i < flight().scans.size(); ++i) {
    ASSERT_EQ(process(flight().scans[i]), Status::kOk);
    if (i % 50 != 0) continue;
    const Eigen::MatrixXd P = pipeline_->backend().state_estimate().covariance().matrix();
    ASSERT_EQ(P, P.transpose());
    EXPECT_GT(eigenvalues(P)[0], -1e-12);  // clones make it singular: rounding may go either way
  }
}

}  // namespace
}  // namespace rio::test
