// SPDX-License-Identifier: BSD-3-Clause
// The sliding-window smoother as a whole: what enters and leaves the window, failures, starts in
// the middle of things, consistency. Its minimum is checked by ceres_referee_test.cpp.
#include "rio/smoother/smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rio/checks/replacements.hpp"
#include "rio/core/so3.hpp"
#include "rio/testing/allocation_guard.hpp"
#include "support/smoother_flight.hpp"
#include "support/symmetric.hpp"

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
  const Window& window() const { return flight_.smoother().window(); }
  const Estimate& x() const { return flight_.estimate(); }
  std::size_t capacity() { return static_cast<std::size_t>(flight_.options().smoother.window); }

  SmootherFlight flight_;
};

TEST_F(SmootherTest, KeepsTheLastStatesFirstInFirstOut) {
  const std::size_t n = capacity();
  std::vector<Time> times = {x().nav.time};
  for (std::size_t i = 0; i < 3 * n; ++i) {
    fly(1);
    times.push_back(x().nav.time);
    ASSERT_EQ(window().size(), std::min(i + 2, n));  // the state of the start is one of them
    for (std::size_t k = 0; k < window().size(); ++k) {
      EXPECT_EQ(window()[k].nav.time, times[times.size() - window().size() + k]);
      EXPECT_EQ(window()[k].to_next.valid(), k + 1 < window().size());
    }
    EXPECT_EQ(window().newest().scan, i);
    EXPECT_EQ(window().newest().nav.p_WB, x().nav.p_WB);
    EXPECT_EQ(window().newest().nav.q_WB.coeffs(), x().nav.q_WB.coeffs());
  }
}

TEST_F(SmootherTest, ItsStatesAreTheClones) {
  fly(30);
  ASSERT_EQ(x().clones.size(), window().size());
  for (std::size_t k = 0; k < window().size(); ++k) {
    EXPECT_EQ(x().clones[k].scan, window()[k].scan);
    EXPECT_EQ(x().clones[k].T_WB.p, window()[k].nav.p_WB);
    EXPECT_EQ(x().clones[k].T_WB.R, window()[k].nav.q_WB.toRotationMatrix());
  }
}

TEST_F(SmootherTest, TheStartIsNoScan) {
  fly(1);
  ASSERT_EQ(window().size(), 2U);
  EXPECT_EQ(window().find(0), 1);
  EXPECT_EQ(x().find_clone(0), 1);
}

/// Of the measured ranges of the landmarks to where they are, in sigmas.
double largest_range_error(const SmootherFlight& flight) {
  const Window& window = flight.smoother().window();
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
  Options o = experiment::options_for(flight.flight(), "published-smoother");
  o.timing.imu_buffer = static_cast<int>(flight.flight().imu.size()) + 1;
  o.smoother.keep_landmark_factors = keep;
  flight.begin(o);
  Kept kept;
  while (!flight.over()) {
    EXPECT_EQ(flight.step(), Status::kOk);
    const Window& window = flight.smoother().window();
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
  for (std::size_t k = 0; k < window().size(); ++k)
    EXPECT_TRUE(window()[k].measurements.of<LandmarkPointModel>().empty());
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

/// What a smoother shows.
struct Shown {
  explicit Shown(const Smoother& s)
      : window(s.window()),
        estimate(s.estimate()),
        P(s.state_estimate().covariance().matrix()),
        A(s.prior().A()) {}

  Window window;
  Estimate estimate;
  Eigen::MatrixXd P;
  Eigen::MatrixXd A;
};

void expect_same(const NavState& a, const NavState& b) {
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.q_WB.coeffs(), b.q_WB.coeffs());
  EXPECT_EQ(a.p_WB, b.p_WB);
  EXPECT_EQ(a.v_WB, b.v_WB);
  EXPECT_EQ(a.gyro_bias, b.gyro_bias);
  EXPECT_EQ(a.accel_bias, b.accel_bias);
}
/// To the last bit.
void expect_same(const Shown& a, const Shown& b) {
  ASSERT_EQ(a.window.size(), b.window.size());
  for (std::size_t k = 0; k < a.window.size(); ++k) {
    expect_same(a.window[k].nav, b.window[k].nav);
    EXPECT_EQ(a.window[k].measurements.sizes(), b.window[k].measurements.sizes());
    EXPECT_EQ(a.window[k].to_next.valid(), b.window[k].to_next.valid());
  }
  EXPECT_EQ(a.P, b.P);
  EXPECT_EQ(a.A, b.A);
  expect_same(a.estimate.nav, b.estimate.nav);
  EXPECT_EQ(a.estimate.T_BS.rotation.coeffs(), b.estimate.T_BS.rotation.coeffs());
  EXPECT_EQ(a.estimate.T_BS.translation, b.estimate.T_BS.translation);
  EXPECT_EQ(a.estimate.time_offset, b.estimate.time_offset);
  ASSERT_EQ(a.estimate.landmarks.size(), b.estimate.landmarks.size());
  for (std::size_t i = 0; i < a.estimate.landmarks.size(); ++i) {
    EXPECT_EQ(a.estimate.landmarks[i].p_W, b.estimate.landmarks[i].p_W);
  }
}

TEST_F(SmootherTest, TheSameInputGivesTheSameBytes) {
  SmootherFlight other(short_flight(8));
  other.begin(other.options());
  for (int i = 0; i < 100; ++i) {
    fly(1);
    ASSERT_EQ(other.step(), Status::kOk);
  }
  expect_same(Shown(flight_.smoother()), Shown(other.smoother()));
}

/// A smoother without a front-end, which sees nothing but the points it is given as landmarks.
class BlindSmootherTest : public SmootherTest {
 protected:
  BlindSmootherTest() : smoother_(flight_.options()), rows_(flight_.options()) {
    smoother_.reset(flight_.flight().truth.front(), flight_.start_covariance());
    nothing_.scan = &scan_;
    nothing_.trails = &trails_;
  }

  Status step() {
    EXPECT_EQ(predict(), Status::kOk);
    return update();
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
  for (int i = 0; i < 15; ++i) ASSERT_EQ(step(), Status::kOk);
  give_birth(0.03);
  ASSERT_EQ(step(), Status::kOk);
  give_birth(0.0);  // infinite information: no solution exists any more
  for (int i = 0; i < 2; ++i) {
    ASSERT_EQ(predict(), Status::kOk);
    const Shown predicted(smoother_);
    EXPECT_EQ(update(), Status::kNumerical);
    expect_same(Shown(smoother_), predicted);
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
  for (int i = 0; i < 15; ++i) ASSERT_EQ(step(), Status::kOk);
  give_birth(0.03);
  const Shown before(smoother_);
  ASSERT_EQ(before.estimate.landmarks.size(), 1U);
  constexpr double kSigma = 0.1;
  constexpr double kDuration = 0.5;
  const Vector3d error(1.0, -0.7, 0.4);
  const Matrix3d R_then = before.estimate.nav.q_WB.toRotationMatrix();
  const Vector3d v_B = R_then.transpose() * (before.estimate.nav.v_WB + error);
  const IndependentVelocity found{v_B, kSigma * kSigma * Matrix3d::Identity()};
  smoother_.replace([&](StateEstimate* x) { replace_velocity(found, kDuration, 0.0, x); },
                    Invalidates::kLandmarks, &report_);
  EXPECT_EQ(smoother_.window().size(), 1U);
  EXPECT_EQ(smoother_.estimate().landmarks.size(), 0U);
  EXPECT_EQ(report_.landmarks_removed, 1);
  const Eigen::MatrixXd P = smoother_.state_estimate().covariance().matrix();
  const NavState& nav = smoother_.estimate().nav;
  // the velocity is the new one, the position has followed it, and their sigmas know it
  EXPECT_LT((nav.v_WB - before.estimate.nav.v_WB - error).norm(), 0.02);
  EXPECT_LT((nav.p_WB - before.estimate.nav.p_WB - kDuration * error).norm(), 0.02);
  for (int v = body::kVelocity; v < body::kVelocity + 3; ++v) {
    EXPECT_LT(P(v, v), 1.01 * kSigma * kSigma);
    EXPECT_GT(P(v, v), 0.9 * kSigma * kSigma);
  }
  // the prior of the new window knows what the covariance does, in the axes of prior.hpp (E4)
  Eigen::MatrixXd M = Eigen::MatrixXd::Identity(P.rows(), P.cols());
  const Matrix3d R = nav.q_WB.toRotationMatrix();
  M.topLeftCorner<3, 3>() = R;
  const Matrix3d heading = Vector3d::UnitZ() * R.row(2);
  M.block<3, 3>(body::kPosition, 0) = skew(nav.p_WB) * heading;
  M.block<3, 3>(body::kVelocity, 0) = skew(nav.v_WB) * heading;
  const Eigen::MatrixXd product = smoother_.prior().A() * M * P * M.transpose();
  // it adds 1e-5 squared to every variance; the least one is that of the gyroscope's bias
  const double least = P.diagonal().minCoeff();
  EXPECT_LE(
      (product - Eigen::MatrixXd::Identity(P.rows(), P.cols())).diagonal().cwiseAbs().maxCoeff(),
      10.0 * 1e-10 / least);
}

TEST_F(BlindSmootherTest, AReopenedPositionBeginsANewWindow) {
  for (int i = 0; i < 15; ++i) ASSERT_EQ(step(), Status::kOk);
  give_birth(0.03);
  const Eigen::Index position = body::kPosition;
  const Eigen::MatrixXd before = smoother_.state_estimate().covariance().matrix();
  smoother_.replace([](StateEstimate* x) { widen_position(0.5, x); }, Invalidates::kLandmarks,
                    &report_);
  EXPECT_EQ(smoother_.window().size(), 1U);
  EXPECT_EQ(report_.landmarks_removed, 1);
  ASSERT_EQ(step(), Status::kOk);  // the next solution knows it, too
  const Eigen::MatrixXd P = smoother_.state_estimate().covariance().matrix();
  for (Eigen::Index i = position; i < position + 3; ++i) {
    EXPECT_NEAR(P(i, i) - before(i, i), 0.25, 0.01);
  }
}

TEST_F(BlindSmootherTest, WithoutMeasurementsItIsDeadReckoning) {
  StateEstimate state_estimate(flight_.options(), 0);
  state_estimate.reset(flight_.flight().truth.front(), flight_.start_covariance());
  for (std::size_t i = 0; i < 40; ++i) {
    ASSERT_EQ(step(), Status::kOk);
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

TEST_F(SmootherTest, AllocatesNothing) {
  if (!AllocationGuard::kWorks) GTEST_SKIP() << "allocations are not counted under a sanitizer";
  for (const bool distances : {false, true}) {
    Options o = flight_.options();
    o.frontend.landmark_timeout = 1.0;
    if (distances) {
      o.update.use_trails = true;
      o.update.landmark_measurement = LandmarkMeasurement::kDistance;
    }
    flight_.begin(o);
    const AllocationGuard guard;
    while (!flight_.over()) fly(1);
    EXPECT_EQ(guard.count(), 0) << distances;
  }
}

TEST_F(SmootherTest, CovarianceStaysSymmetricAndPositiveDefinite) {
  while (!flight_.over()) {
    fly(1);
    if (flight_.next() % 50 != 0) continue;
    const Eigen::MatrixXd P = flight_.smoother().state_estimate().covariance().matrix();
    ASSERT_EQ(P, P.transpose());
    EXPECT_GT(eigenvalues(P)[0], 0.0);
  }
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
      return flight.smoother().state_estimate().covariance().body().diagonal().cwiseSqrt();
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

TEST(SmootherConsistency, NeesIsThatOfItsDimension) {
  constexpr int kRuns = 4;
  experiment::BlockNees sum;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    SmootherFlight flight(short_flight(seed));
    flight.begin(flight.options());
    while (!flight.over()) {
      ASSERT_EQ(flight.step(), Status::kOk);
      if (flight.next() % 15 != 0) continue;
      const NavState& nav = flight.estimate().nav;
      const experiment::BlockNees nees =
          experiment::block_nees({nav, flight.flight().truth_at(nav.time),
                                  flight.smoother().state_estimate().covariance().body()});
      sum.position += nees.position;
      sum.attitude += nees.attitude;
      sum.heading += nees.heading;
      sum.velocity += nees.velocity;
      ++count;
    }
  }
  // one per dimension; four flights with a few independent errors each leave half of it to chance
  for (const double total : {sum.position, sum.attitude, sum.velocity}) {
    EXPECT_GT(total / count, 0.3);
    EXPECT_LT(total / count, 1.7);
  }
  EXPECT_LT(sum.heading / count, 2.5);  // the start is exact, so it may be near to zero
}

}  // namespace
}  // namespace rio::test
