// SPDX-License-Identifier: BSD-3-Clause
// The sliding-window smoother in flight: what enters and leaves the window, and starts in the
// middle of things. Without a front-end: smoother_alone_test.cpp. Its minimum is checked by
// ceres_referee_test.cpp.
#include "rio/smoother/smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/scanwise_flight.hpp"

namespace rio::test {
namespace {

constexpr double kStandBefore = 1.5;  // [s]

class SmootherTest : public ScanwiseTest<SmootherFlight> {
 protected:
  SmootherTest() : ScanwiseTest(ideal_flight(kStandBefore)) {}

  const Window& window() const { return flight_.back_end().window(); }
};

// The scans of two windows at most tell of it.
TEST_F(SmootherTest, HardlyLearnsTheErrorOfAllElevations) {
  const Options o = flight_.options();
  const int at = flight_.state_estimate().layout().elevation_error();
  double least = 1.0;
  while (!flight_.over()) {
    fly(1);
    least = std::min(least, flight_.state_estimate().covariance().matrix()(at, at));
  }
  ASSERT_GT(x().landmarks.size(), 5U);
  EXPECT_GT(std::sqrt(least), 0.45 * o.calibration.elevation_sigma);  // as a constant: 0.26
}

// They are the clones; that of the start is no scan.
TEST_F(SmootherTest, KeepsTheLastStatesFirstInFirstOut) {
  const auto n = static_cast<std::size_t>(flight_.options().smoother.window);
  std::vector<Time> times = {x().nav.time};
  for (std::size_t i = 0; i < 3 * n; ++i) {
    fly(1);
    times.push_back(x().nav.time);
    ASSERT_EQ(window().size(), std::min(i + 2, n));
    ASSERT_EQ(x().clones.size(), window().size());
    for (std::size_t k = 0; k < window().size(); ++k) {
      const WindowState& state = window()[k];
      EXPECT_EQ(state.nav.time, times[times.size() - window().size() + k]);
      EXPECT_EQ(state.to_next.valid(), k + 1 < window().size());
      EXPECT_EQ(x().clones[k].scan, state.scan);
      EXPECT_EQ(x().clones[k].T_WB.p, state.nav.p_WB);
      EXPECT_EQ(x().clones[k].T_WB.R, state.nav.q_WB.toRotationMatrix());
    }
    const int newest = static_cast<int>(window().size()) - 1;
    EXPECT_EQ(window().find(i), newest);
    EXPECT_EQ(x().find_clone(i), newest);
    EXPECT_EQ(window().newest().nav.p_WB, x().nav.p_WB);
    EXPECT_EQ(window().newest().nav.q_WB.coeffs(), x().nav.q_WB.coeffs());
  }
}

/// Of the measured ranges of the landmarks to where they are, in sigmas.
double largest_range_error(const SmootherFlight& flight) {
  const Window& window = flight.back_end().window();
  const Estimate& x = flight.estimate();
  double largest = 0.0;
  for (std::size_t k = 0; k < window.size(); ++k) {
    const RigidPose T_WB(window[k].nav.q_WB.toRotationMatrix(), window[k].nav.p_WB);
    for (const auto& m : window[k].measurements.of<LandmarkPointModel>()) {
      const Vector3d l = x.landmarks[m.landmark].p_W;
      const double range = to_radar(T_WB, RigidPose(x.T_BS), l).norm();
      largest = std::max(largest, std::abs(m.z.range - range) / m.z.sigma_range);
    }
  }
  return largest;
}

TEST_F(SmootherTest, FactorsFollowTheirLandmarksWhenOthersLeave) {
  Options o = flight_.options();
  o.frontend.landmark_timeout = 0.3;  // they come and go
  flight_.begin(o);
  int removed = 0;
  int kept = 0;
  while (!flight_.over()) {
    fly(1);
    removed += report().landmarks_removed;
    for (std::size_t k = 0; k < window().size(); ++k) {
      for (const auto& m : window()[k].measurements.of<LandmarkPointModel>()) {
        ASSERT_LT(m.landmark, x().landmarks.size());
        ++kept;
      }
    }
    // a factor of another landmark would be off by metres, a hundred sigmas
    ASSERT_LT(largest_range_error(flight_), 8.0) << flight_.next();
  }
  EXPECT_GT(removed, 100);
  EXPECT_GT(kept, 1000);
}

/// Landmark distances in the window, and how many landmarks hold them alone.
struct Kept {
  int distances = 0;
  int retired = 0;
};
Kept fly_published(bool keep) {
  SmootherFlight flight(ideal_flight(kStandBefore));
  Options o = flight.options("published-smoother");
  o.smoother.keep_landmark_factors = keep;
  flight.begin(o);
  Kept kept;
  while (!flight.over()) {
    EXPECT_EQ(flight.step(), Status::kOk);
    const Window& window = flight.back_end().window();
    const auto& landmarks = flight.estimate().landmarks;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      kept.retired += landmarks[i].retired ? 1 : 0;
      EXPECT_TRUE(!landmarks[i].retired || window.measures_landmark(i)) << "no state needs it";
    }
    for (std::size_t k = 0; k < window.size(); ++k) {
      for (const auto& m : window[k].measurements.of<LandmarkDistanceModel>()) {
        EXPECT_LT(m.landmark, landmarks.size());
        EXPECT_TRUE(k + 1 < window.size() || !landmarks[m.landmark].retired) << "matched";
        ++kept.distances;
      }
    }
  }
  return kept;
}

// Michalczyk et al. 2024, III-B and III-D: the factors of the states of the window stay; a missed
// landmark is marginalised when the last state that has measured it leaves.
TEST(PublishedSmoother, KeepsTheFactorsOfAMissedLandmarkWhileTheirStatesAreInTheWindow) {
  const Kept as_published = fly_published(true);
  const Kept dropped = fly_published(false);
  EXPECT_GT(as_published.retired, 100);
  EXPECT_EQ(dropped.retired, 0);
  EXPECT_GT(as_published.distances, dropped.distances + dropped.distances / 4);
}

TEST_F(SmootherTest, ABirthIsAPointMeasuredByTheNewestState) {
  int births = 0;
  while (births == 0 && !flight_.over()) {
    fly(1);
    births = report().landmarks_added;
  }
  ASSERT_GT(births, 0);
  ASSERT_EQ(x().landmarks.size(), static_cast<std::size_t>(births));
  const auto& points = window().newest().measurements.of<LandmarkPointModel>();
  ASSERT_EQ(points.size(), static_cast<std::size_t>(births));
  for (std::size_t i = 0; i < x().landmarks.size(); ++i) {
    const Measured<LandmarkPointModel>& m = points[i];
    EXPECT_EQ(m.landmark, i);
    EXPECT_EQ(m.weight, 1.0);
    EXPECT_FALSE(m.doppler.has_value());  // the Doppler was used as such
    const Vector3d e = to_radar(x().T_WB(), RigidPose(x().T_BS), x().landmarks[i].p_W);
    EXPECT_NEAR(e.norm(), m.z.range, 1e-12);
    EXPECT_NEAR(e.dot(m.z.sigma_azimuth_S), 0.0, 1e-12);
    EXPECT_NEAR(e.dot(m.z.sigma_elevation_S), 0.0, 1e-12);
  }
  fly(1);  // the birth alone holds those that were not seen again
}

TEST_F(SmootherTest, SilenceOfTheRadarEndsTheLandmarks) {
  fly(60);
  ASSERT_GT(x().landmarks.size(), 0U);
  for (int i = 0; i < 17; ++i) flight_.skip();  // more than a second
  fly(1);
  EXPECT_EQ(x().landmarks.size(), 0U);
  for (std::size_t k = 0; k < window().size(); ++k) {
    EXPECT_TRUE(window()[k].measurements.of<LandmarkPointModel>().empty());
  }
  fly(30);
}

TEST_F(SmootherTest, AScanAtTheVeryTimeOfTheStartIsMeasuredByTheStart) {
  const sim::Flight& flight = flight_.flight();
  flight_.begin(flight_.options(), flight.truth_at(flight.scans[0].time));
  fly(1);
  ASSERT_EQ(window().size(), 1U);
  EXPECT_EQ(window().newest().scan, 0U);
  EXPECT_GT(window().newest().measurements.of<DopplerModel>().size(), 5U);
  EXPECT_TRUE(x().nav.p_WB.allFinite());
  fly(1);
  EXPECT_EQ(window().size(), 2U);
  fly(40);
}

// Where the linearisation still moves, the covariance lags behind it; the states do not.
TEST_F(SmootherTest, AReusedFactorChangesTheSigmasByPercents) {
  Options own_factors = flight_.options();
  own_factors.smoother.factor_reuse = 0.0;
  SmootherFlight reference(ideal_flight(kStandBefore));
  reference.begin(own_factors);
  double largest = 0.0;
  while (!flight_.over()) {
    fly(1);
    ASSERT_EQ(reference.step(), Status::kOk);
    const auto sigmas = [](const SmootherFlight& flight) -> Eigen::VectorXd {
      return flight.state_estimate().covariance().body().diagonal().cwiseSqrt();
    };
    const Eigen::VectorXd sigma = sigmas(reference);
    const Eigen::VectorXd ratio = sigmas(flight_).cwiseQuotient(sigma);
    largest = std::max(largest, (ratio.array() - 1.0).abs().maxCoeff());
    // both end within a tenth of a sigma of their minimum (SmootherOptions::tolerance)
    const Vector3d apart = x().nav.p_WB - reference.estimate().nav.p_WB;
    EXPECT_LT(apart.norm(), 0.2 * sigma.segment<3>(body::kPosition).norm()) << flight_.next();
  }
  EXPECT_GT(largest, 1e-4);  // some were reused
  EXPECT_LT(largest, 0.1);   // 0.05 here
}

}  // namespace
}  // namespace rio::test
