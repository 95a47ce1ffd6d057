// SPDX-License-Identifier: BSD-3-Clause
// The sliding-window smoother as a whole: what enters and leaves the window, failures, starts in
// the middle of things. Its minimum is checked by ceres_referee_test.cpp.
#include "rio/smoother/smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rio/checks/replacements.hpp"
#include "rio/core/so3.hpp"
#include "support/scanwise_flight.hpp"

namespace rio::test {
namespace {

sim::Scenario short_flight(std::uint64_t seed) {
  sim::Scenario scenario = sim::Scenario::ideal();
  scenario.seed = seed;
  scenario.path.length = 20.0;
  scenario.path.stand_before = 1.5;
  return scenario;
}

class SmootherTest : public testing::Test {
 protected:
  SmootherTest() : flight_(short_flight(8)) { flight_.begin(flight_.options()); }

  void fly(std::size_t scans) {
    for (std::size_t i = 0; i < scans; ++i) ASSERT_EQ(flight_.step(), Status::kOk);
  }
  const Window& window() const { return flight_.back_end().window(); }
  const Estimate& x() const { return flight_.estimate(); }

  SmootherFlight flight_;
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
    removed += flight_.report().landmarks_removed;
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
Kept fly_published(const sim::Scenario& scenario, bool keep) {
  SmootherFlight flight(scenario);
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
  const Kept as_published = fly_published(short_flight(8), true);
  const Kept dropped = fly_published(short_flight(8), false);
  EXPECT_GT(as_published.retired, 100);
  EXPECT_EQ(dropped.retired, 0);
  EXPECT_GT(as_published.distances, dropped.distances + dropped.distances / 4);
}

TEST_F(SmootherTest, ABirthIsAPointMeasuredByTheNewestState) {
  int births = 0;
  while (births == 0 && !flight_.over()) {
    fly(1);
    births = flight_.report().landmarks_added;
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

/// All that a smoother shows, number by number.
std::vector<double> numbers_of(const Smoother& smoother) {
  std::vector<double> all;
  const auto add = [&all](const auto& m) { all.insert(all.end(), m.data(), m.data() + m.size()); };
  const auto add_state = [&](const NavState& x) {
    all.push_back(to_seconds(x.time));
    add(x.q_WB.coeffs());
    for (const Vector3d& v : {x.p_WB, x.v_WB, x.gyro_bias, x.accel_bias}) add(v);
  };
  for (std::size_t k = 0; k < smoother.window().size(); ++k) {
    const WindowState& state = smoother.window()[k];
    add_state(state.nav);
    for (const std::size_t count : state.measurements.sizes()) {
      all.push_back(static_cast<double>(count));
    }
    all.push_back(state.to_next.valid() ? 1.0 : 0.0);
  }
  const Estimate& x = smoother.estimate();
  add_state(x.nav);
  add(x.T_BS.rotation.coeffs());
  add(x.T_BS.translation);
  all.push_back(x.time_offset);
  for (const LandmarkState& landmark : x.landmarks) add(landmark.p_W);
  add(Eigen::MatrixXd(smoother.state_estimate().covariance().matrix()));
  add(Eigen::MatrixXd(smoother.prior().A()));
  return all;
}

/// A smoother without a front-end, which sees nothing but the points it is given as landmarks.
class BlindSmootherTest : public SmootherTest {
 protected:
  BlindSmootherTest() : smoother_(flight_.options()), rows_(flight_.options()) {
    smoother_.reset(flight_.flight().truth.front(), flight_.start_covariance());
    nothing_.scan = &scan_;
    nothing_.trails = &trails_;
  }

  void step(int scans = 1) {
    for (int i = 0; i < scans; ++i) {
      ASSERT_EQ(predict(), Status::kOk);
      ASSERT_EQ(update(), Status::kOk);
    }
  }
  Status update() {
    rows_.build(nothing_, smoother_.state_estimate(), &report_);
    return smoother_.update(nothing_, rows_);
  }
  Status predict() {
    bool gap = false;
    return smoother_.propagate(flight_.flight().scans[next_++].time, flight_.imu(), &gap);
  }
  /// @param sigma of the range [m]
  void give_birth(double sigma) {
    RadarDetection raw;
    raw.point_S = Vector3d(4.0, 1.0, 0.0);
    Promotions promotions;
    promotions.births.push_back(make_detection(raw, flight_.options().radar));
    promotions.births[0].sigma_range = sigma;
    smoother_.maintain_landmarks(nothing_, rows_, promotions, &report_);
  }

  Smoother smoother_;
  ScanRows rows_;
  DetectionList scan_;
  TrailSet trails_{1, 1};
  Observations nothing_;
  UpdateReport report_;
  std::size_t next_ = 0;
};

TEST_F(BlindSmootherTest, AFailedUpdateLeavesThePrediction) {
  step(15);
  give_birth(0.03);
  step();
  give_birth(0.0);  // infinite information: no solution exists any more
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(predict(), Status::kOk);
    const std::vector<double> predicted = numbers_of(smoother_);
    EXPECT_EQ(update(), Status::kNumerical);
    EXPECT_EQ(numbers_of(smoother_), predicted);  // to the last bit
  }
  // once the landmark is gone all goes on, with the IMU since the last solution
  smoother_.drop_landmarks(&report_);
  const Vector3d before = smoother_.estimate().nav.p_WB;
  EXPECT_EQ(update(), Status::kOk);
  EXPECT_EQ(smoother_.window().newest().nav.time, smoother_.estimate().nav.time);
  // nothing was measured: the solution is the prediction, but for the round-off of the system
  EXPECT_LT((smoother_.estimate().nav.p_WB - before).norm(), 1e-6);
}

TEST_F(BlindSmootherTest, AnotherVelocityBeginsANewWindow) {
  step(15);
  give_birth(0.03);
  const Estimate before = smoother_.estimate();
  ASSERT_EQ(before.landmarks.size(), 1U);
  constexpr double kSigma = 0.1;
  constexpr double kDuration = 0.5;
  const Vector3d error(1.0, -0.7, 0.4);
  const Matrix3d R_then = before.nav.q_WB.toRotationMatrix();
  const Vector3d v_B = R_then.transpose() * (before.nav.v_WB + error);
  const IndependentVelocity found{v_B, kSigma * kSigma * Matrix3d::Identity()};
  smoother_.replace([&](StateEstimate* x) { replace_velocity(found, kDuration, 0.0, x); },
                    Invalidates::kLandmarks, &report_);
  EXPECT_EQ(smoother_.window().size(), 1U);
  EXPECT_EQ(smoother_.estimate().landmarks.size(), 0U);
  EXPECT_EQ(report_.landmarks_removed, 1);
  const Eigen::MatrixXd P = smoother_.state_estimate().covariance().matrix();
  const NavState& nav = smoother_.estimate().nav;
  // the velocity is the new one, the position has followed it, and their sigmas know it
  EXPECT_LT((nav.v_WB - before.nav.v_WB - error).norm(), 0.02);
  EXPECT_LT((nav.p_WB - before.nav.p_WB - kDuration * error).norm(), 0.02);
  for (int v = body::kVelocity; v < body::kVelocity + 3; ++v) {
    EXPECT_LT(P(v, v), 1.01 * kSigma * kSigma);
    EXPECT_GT(P(v, v), 0.9 * kSigma * kSigma);
  }
  // the prior of the new window knows what the covariance does, in the axes of prior.hpp (E4)
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(P.rows(), P.cols());
  Eigen::MatrixXd M = I;
  const Matrix3d R = nav.q_WB.toRotationMatrix();
  M.topLeftCorner<3, 3>() = R;
  const Matrix3d heading = Vector3d::UnitZ() * R.row(2);
  M.block<3, 3>(body::kPosition, 0) = skew(nav.p_WB) * heading;
  M.block<3, 3>(body::kVelocity, 0) = skew(nav.v_WB) * heading;
  const Eigen::MatrixXd product = smoother_.prior().A() * M * P * M.transpose();
  // it adds 1e-5 squared to every variance; the least one is that of the gyroscope's bias
  const double least = P.diagonal().minCoeff();
  EXPECT_LE((product - I).diagonal().cwiseAbs().maxCoeff(), 10.0 * 1e-10 / least);
}

TEST_F(BlindSmootherTest, AReopenedPositionBeginsANewWindow) {
  step(15);
  give_birth(0.03);
  const Eigen::Index position = body::kPosition;
  const Eigen::MatrixXd before = smoother_.state_estimate().covariance().matrix();
  smoother_.replace([](StateEstimate* x) { widen_position(0.5, x); }, Invalidates::kLandmarks,
                    &report_);
  EXPECT_EQ(smoother_.window().size(), 1U);
  EXPECT_EQ(report_.landmarks_removed, 1);
  step();  // the next solution knows it, too
  const Eigen::MatrixXd P = smoother_.state_estimate().covariance().matrix();
  for (Eigen::Index i = position; i < position + 3; ++i) {
    EXPECT_NEAR(P(i, i) - before(i, i), 0.25, 0.01);
  }
}

TEST_F(BlindSmootherTest, WithoutMeasurementsItIsDeadReckoning) {
  StateEstimate state_estimate(flight_.options(), 0);
  state_estimate.reset(flight_.flight().truth.front(), flight_.start_covariance());
  for (std::size_t i = 0; i < 40; ++i) {
    step();
    bool gap = false;
    ASSERT_EQ(state_estimate.propagate(flight_.flight().scans[i].time, flight_.imu(), &gap),
              Status::kOk);
  }
  // means: as good as the information matrices, whose condition is some 1e10, let it be
  EXPECT_LT((smoother_.estimate().nav.p_WB - state_estimate.estimate().nav.p_WB).norm(), 1e-6);
  EXPECT_LT((smoother_.estimate().nav.v_WB - state_estimate.estimate().nav.v_WB).norm(), 1e-6);
  // covariance: the start adds 1e-5 squared to each variance
  const BodyCovariance expected = state_estimate.covariance().body();
  const BodyCovariance P = smoother_.state_estimate().covariance().body();
  for (int i = 0; i < body::kSize; ++i) EXPECT_NEAR(P(i, i), expected(i, i), 1e-4 * expected(i, i));
}

// Where the linearisation still moves, the covariance lags behind it; the states do not.
TEST_F(SmootherTest, AReusedFactorChangesTheSigmasByPercents) {
  Options own_factors = flight_.options();
  own_factors.smoother.factor_reuse = 0.0;
  SmootherFlight reference(short_flight(8));
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
