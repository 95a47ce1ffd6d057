// SPDX-License-Identifier: BSD-3-Clause
// The measurements of a scan as both back-ends use them, and the report of its points.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "rio/update/point_report.hpp"
#include "rio/update/scan_measurements.hpp"

namespace rio {
namespace {

Measured<LandmarkPointModel> point_of(std::size_t landmark) {
  Measured<LandmarkPointModel> m;
  m.landmark = landmark;
  return m;
}

class ScanMeasurementsTest : public testing::Test {
 protected:
  /// A Doppler, points of the landmarks 0 to 3, a distance to landmark 3, a trail distance.
  ScanMeasurementsTest() {
    all_.add(Measured<DopplerModel>{});
    for (std::size_t i = 0; i < 4; ++i) all_.add(point_of(i));
    all_.add(Measured<LandmarkDistanceModel>{{}, 0, 3});
    all_.add(Measured<TrailDistanceModel>{});
  }
  std::vector<std::size_t> landmarks() const {
    std::vector<std::size_t> out;
    for (const auto& m : all_.of<LandmarkPointModel>()) out.push_back(m.landmark);
    return out;
  }

  ScanMeasurements all_;
};

TEST_F(ScanMeasurementsTest, AreKeptByModel) {
  EXPECT_EQ(all_.size(), 7U);
  EXPECT_EQ(all_.sizes(), (ScanMeasurements::Sizes{1, 4, 1, 0, 1, 0}));
  std::size_t seen = 0;
  all_.for_each([&seen](const auto&) { ++seen; });
  EXPECT_EQ(seen, 7U);
  all_.clear();
  EXPECT_EQ(all_.size(), 0U);
}

TEST_F(ScanMeasurementsTest, CutRemovesWhatWasAppended) {
  const ScanMeasurements::Sizes before = all_.sizes();
  ScanMeasurements more;
  more.add(Measured<RestModel>{});
  more.add(point_of(9));
  all_.append(more);
  EXPECT_EQ(all_.size(), 9U);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 1, 2, 3, 9}));
  all_.cut(before);
  EXPECT_EQ(all_.sizes(), before);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST_F(ScanMeasurementsTest, TheLastLandmarkTakesThePlaceOfTheForgottenOne) {
  all_.forget_landmark(1, 3);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 2, 1}));
  EXPECT_EQ(all_.of<LandmarkDistanceModel>()[0].landmark, 1U);
  all_.forget_landmark(2, 2);
  EXPECT_EQ(landmarks(), (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(all_.of<DopplerModel>().size(), 1U);
  EXPECT_EQ(all_.of<TrailDistanceModel>().size(), 1U);
}

constexpr double kForward = 2.0;  // of the radar along its boresight [m/s]

/// A point ahead at `range`, with the range rate of a static one there plus `error`.
Detection ahead(double range, double error) {
  return make_detection(
      {.point_S = {range, 0.0, 0.0}, .range_rate = -kForward + error, .snr_db = range},
      RadarOptions{});
}

/// A scan of six detections, one of each label, the own echo third.
class PointReports : public testing::Test {
 protected:
  PointReports() {
    for (int i = 0; i < 6; ++i) received_.items.push_back(ahead(1.0 + i, 0.1 * i));
    (void)own_.push_back(2);
    rest_ = received_;
    rest_.items.erase(rest_.items.begin() + 2);
    seen_.scan = &rest_;
    seen_.ego_velocity.inlier[0] = seen_.ego_velocity.inlier[1] = true;
    seen_.ego_velocity.inlier[2] = true;
    seen_.moves[2] = true;
    seen_.ego_velocity.outlier[3] = true;
    (void)seen_.matches.landmarks.push_back({0, 1});
    x_.nav.v_WB = Vector3d(0.0, kForward, 0.0);
    x_.nav.p_WB = Vector3d(10.0, 20.0, 30.0);
    x_.nav.q_WB = Quaternion(Eigen::AngleAxisd(std::acos(0.0), Vector3d::UnitZ()));
    x_.T_BS.translation = Vector3d(0.5, 0.0, 0.0);
  }
  std::vector<PointReport> report(bool trails = false) {
    std::vector<PointReport> points;
    report_points(received_, own_, seen_, x_, trails, &points);
    return points;
  }

  DetectionList received_, rest_;
  OwnEchoList own_;
  Observations seen_;
  Estimate x_;
};

TEST_F(PointReports, HaveLabelsPlacesAndResidualsInTheOrderOfTheFilteredScan) {
  const std::vector<PointReport> points = report();
  const std::vector<PointLabel> expected = {PointLabel::kStatic,  PointLabel::kMatched,
                                            PointLabel::kOwnEcho, PointLabel::kMover,
                                            PointLabel::kOutlier, PointLabel::kUnused};
  ASSERT_EQ(points.size(), expected.size());
  for (int i = 0; i < 6; ++i) {
    const PointReport& point = points[static_cast<std::size_t>(i)];
    EXPECT_EQ(point.label, expected[static_cast<std::size_t>(i)]) << i;
    EXPECT_EQ(point.snr_db, 1.0 + i);
    EXPECT_LT((point.point_W - Vector3d(10.0, 21.5 + i, 30.0)).norm(), 1e-12);
    EXPECT_NEAR(point.residual, 0.1 * i, 1e-12);
    EXPECT_GT(point.residual_sigma, 0.0);
  }
}

TEST_F(PointReports, TrailsMatchOnlyWhereTheyMeasure) {
  (void)seen_.matches.trails.push_back({0, 0});
  EXPECT_EQ(report(false)[0].label, PointLabel::kStatic);
  EXPECT_EQ(report(true)[0].label, PointLabel::kMatched);
}

}  // namespace
}  // namespace rio
