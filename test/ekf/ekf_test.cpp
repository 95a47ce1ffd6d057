// SPDX-License-Identifier: BSD-3-Clause
// The multi-state EKF in flight: clones, landmarks, records, calibration. Gates and rows are in
// scan_rows_test.cpp, who leaves in landmark_policy_test.cpp.
#include "rio/ekf/ekf.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "rio/core/so3.hpp"
#include "support/scanwise_flight.hpp"
#include "support/symmetric.hpp"

namespace rio::test {
namespace {

using EkfTest = ScanwiseTest<EkfFlight>;

/// A back-end that takes no lambda with captures, as the pipeline and the checks pass them.
struct TakesFunctionsAlone : Ekf {
  using Ekf::Ekf;
  void replace(void (*change)(StateEstimate*), Invalidates what, UpdateReport* report);
};
static_assert(OdometryBackEnd<Ekf> && !OdometryBackEnd<TakesFunctionsAlone>);

TEST_F(EkfTest, KeepsTheLastClonesFirstInFirstOut) {
  flight_.begin(flight_.options("published-ekf"));
  for (std::size_t i = 0; i < 20; ++i) {
    fly(1);
    ASSERT_EQ(x().clones.size(), std::min<std::size_t>(i + 1, 7));
    for (ScanId id = i >= 7 ? i - 6 : 0; id <= i; ++id) EXPECT_GE(x().find_clone(id), 0);
    // the newest clone is the corrected pose of this scan
    const Clone& newest = x().clones[static_cast<std::size_t>(x().find_clone(i))];
    EXPECT_EQ(newest.T_WB.R, x().T_WB().R);
    EXPECT_EQ(newest.T_WB.p, x().T_WB().p);
  }
}

TEST_F(EkfTest, LandmarksEnterAfterSevenMatchesAndLeaveAtTheFirstMiss) {
  const Options o = flight_.options("published-ekf");
  flight_.begin(o);
  fly(7);
  EXPECT_EQ(report().landmarks, 0);
  fly(1);  // born at 0, matched by 1 to 7
  const int landmarks = report().landmarks;
  EXPECT_GT(landmarks, 0);
  EXPECT_LE(landmarks, o.update.max_landmarks);
  // nothing seen: all missed
  ASSERT_EQ(flight_.process({flight_.flight().scans[8].time, {}}), Status::kOk);
  EXPECT_EQ(report().landmarks, 0);
  EXPECT_EQ(report().landmarks_removed, landmarks);
  EXPECT_EQ(report().trails, 0);
}

// Records say which detection of the scan as received they are of, the vehicle's own among these.
TEST_F(EkfTest, TheVehiclesOwnEchoesTellNothingAndAreCounted) {
  Options o = flight_.options();
  o.frontend.ransac_threshold = 10.0;  // nothing is sorted out before the gate
  o.frontend.mover_sigmas = 0.0;
  flight_.begin(o);
  constexpr std::size_t kOwn = 2;
  constexpr std::size_t kWrong = 4;
  const RadarDetection echo{.point_S = {0.6, 0.1, -0.2}, .snr_db = 30.0};
  int gated = 0;
  for (std::size_t i = 0; i < 120; ++i) {
    RadarScan scan = flight_.flight().scans[i];
    ASSERT_GT(scan.detections.size(), kWrong);
    scan.detections.insert(scan.detections.begin() + kOwn, echo);
    const bool wrong = i > 110;
    if (wrong) scan.detections[kWrong].range_rate += 1.0;
    ASSERT_EQ(flight_.process(scan), Status::kOk);
    if (!wrong) continue;
    for (const InnovationRecord& record : report().records) {
      EXPECT_NE(record.detection, kOwn);
      if (record.model != Model::kDoppler || record.result != GateResult::kGated) continue;
      gated += record.detection == kWrong ? 1 : 0;
    }
  }
  EXPECT_GE(gated, 8);  // of nine
}

TEST_F(EkfTest, FindsAMountingError) {
  Options o = flight_.options();
  const Quaternion truth = o.radar.T_BS.rotation;
  o.radar.T_BS.rotation = (truth * quaternion_exp(Vector3d(0.02, 0.03, -0.02))).normalized();
  flight_.begin(o);
  const auto error = [&] { return quaternion_log(truth.conjugate() * x().T_BS.rotation).norm(); };
  const double before = error();
  while (!flight_.over()) fly(1);
  EXPECT_NEAR(before, 0.041, 0.001);
  EXPECT_LT(error(), 0.3 * before);
  // held fixed when its sigma is zero
  o.calibration.rotation_sigma = o.calibration.translation_sigma = 0.0;
  flight_.begin(o);
  fly(50);
  EXPECT_EQ(error(), before);
}

// However many landmarks share it; what it has in common with them is kept.
TEST_F(EkfTest, NeverLearnsTheErrorOfAllElevations) {
  const Options o = flight_.options();
  fly(100);
  ASSERT_GT(x().landmarks.size(), 5U);
  const Layout& layout = flight_.state_estimate().layout();
  const int at = layout.elevation_error();
  const Eigen::MatrixXd P = flight_.state_estimate().covariance().matrix();
  EXPECT_EQ(x().elevation_error, 0.0);
  EXPECT_EQ(P(at, at), o.calibration.elevation_sigma * o.calibration.elevation_sigma);
  EXPECT_GT(P.middleCols(at, 1).bottomRows(P.rows() - layout.landmark(0)).norm(), P(at, at));
}

TEST_F(EkfTest, CovarianceStaysSymmetricAndPositiveSemiDefinite) {
  while (!flight_.over()) {
    fly(1);
    if (flight_.next() % 50 != 0) continue;
    const Eigen::MatrixXd P = flight_.state_estimate().covariance().matrix();
    ASSERT_EQ(P, P.transpose());
    EXPECT_GT(eigenvalues(P)[0], -1e-12);  // clones make it singular: rounding may go either way
  }
}

}  // namespace
}  // namespace rio::test
