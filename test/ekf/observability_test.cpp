// SPDX-License-Identifier: BSD-3-Clause
// The default filter as a whole leaves position and heading unobservable: what it claims to know of
// them comes from its start alone.
//
// N: the four directions along which no sensor of this system sees a change, translation and the
// rotation about gravity, as errors of all blocks at one estimate.
// (E1) H N = 0 at every update and Phi N = N' between them: two filters that start with P0 and
//      P0 + alpha N N^T then have equal gains, hence equal estimates, and end with covariances that
//      differ by alpha N' N'^T, N' at the final estimate.
// (E2) With P0 = sigma^2 N N^T + (something positive semi-definite), (E1) bounds the variance of
// the
//      heading from below by sigma^2, at all times.
// References: Hesch et al. 2014 (null space of the stacked system), Huang et al. 2010.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <memory>

#include "experiment/trial.hpp"
#include "rio/ekf/ekf.hpp"
#include "rio/pipeline.hpp"

namespace rio::test {
namespace {

using Eigen::MatrixXd;

constexpr double kTimeOffset = 0.02;  // told to nobody: the filter has to find it [s]

const sim::Flight& flight() {
  static const sim::Flight flight = [] {
    sim::Scenario scenario = sim::Scenario::ideal();
    scenario.seed = 8;
    scenario.path.length = 20.0;
    scenario.radar.stamp_offset = kTimeOffset;
    return sim::simulate_flight(scenario);
  }();
  return flight;
}

/// N at x for all blocks: columns 0 to 2 translation, column 3 rotation about gravity. Calibration
/// and biases do not change.
MatrixXd null_space(const Layout& layout, const Estimate& x) {
  MatrixXd N = MatrixXd::Zero(layout.size(static_cast<int>(x.landmarks.size())), 4);
  const Vector3d up = Vector3d::UnitZ();
  const auto pose = [&](int at, const RigidPose& T_WB) {
    N.block<3, 1>(at, 3) = T_WB.R.transpose() * up;
    N.block<3, 3>(at + 3, 0).setIdentity();
    N.block<3, 1>(at + 3, 3) = up.cross(T_WB.p);
  };
  pose(body::kAttitude, x.T_WB());
  N.block<3, 1>(body::kVelocity, 3) = up.cross(x.nav.v_WB);
  for (std::size_t i = 0; i < x.clones.size(); ++i) {
    pose(layout.clone(static_cast<int>(i)), x.clones[i].T_WB);
  }
  for (std::size_t i = 0; i < x.landmarks.size(); ++i) {
    const int at = layout.landmark(static_cast<int>(i));
    N.block<3, 3>(at, 0).setIdentity();
    N.block<3, 1>(at, 3) = up.cross(x.landmarks[i].p_W);
  }
  return N;
}

double heading_variance(const Pipeline<Ekf>& pipeline) {
  const Vector3d up_B = pipeline.estimate().nav.q_WB.conjugate() * Vector3d::UnitZ();
  const Covariance& P = pipeline.backend().state_estimate().covariance();
  return up_B.dot(P.body().block<3, 3>(body::kAttitude, body::kAttitude) * up_B);
}

/// Filters that fly the same data from different P0.
class ObservabilityTest : public testing::Test {
 protected:
  ObservabilityTest() : options_(experiment::options_for(flight(), "default")) {
    options_.timing.imu_buffer = 100000;  // the whole flight
  }

  /// From the true state with an ordinary P0 plus alpha N N^T.
  std::unique_ptr<Pipeline<Ekf>> start(double alpha) {
    imu_ = std::make_unique<ImuBuffer>(options_.timing, options_.imu);
    for (const ImuSample& sample : flight().imu) imu_->push_back(sample);
    auto pipeline = std::make_unique<Pipeline<Ekf>>(options_);
    NavState first = flight().truth.front();
    first.p_WB += Vector3d(3.0, -2.0, 1.0);  // away from the axis that the rotation is about
    Estimate x;
    x.nav = first;
    const MatrixXd N =
        null_space(pipeline->backend().state_estimate().layout(), x).topRows(body::kSize);
    BodyCovariance P0 = kSigma * kSigma * BodyCovariance::Identity();
    P0.block<3, 3>(body::kAccelBias, body::kAccelBias) *= 25.0;
    pipeline->reset(first, P0 + alpha * N * N.transpose());
    return pipeline;
  }
  void process(const RadarScan& scan, Pipeline<Ekf>* pipeline) {
    filter_detections(scan, options_.radar, options_.frontend.max_detections, list_);
    ASSERT_EQ(pipeline->process(list_, *imu_), Status::kOk);
  }

  struct Comparison {
    double covariance = 0.0;  ///< largest element of P_b - P_a - alpha N N^T, over alpha
    double position = 0.0;    ///< largest distance of the two estimates [m]
    bool same_size = false;
    int rest_scans = 0;
    UpdateReport last;
  };
  /// (E1) over the whole flight.
  Comparison compare() {
    constexpr double kAlpha = 1.0;  // a radian, a metre: ten thousand times the ordinary P0
    const auto a = start(0.0);
    const auto b = start(kAlpha);
    Comparison c;
    for (const RadarScan& scan : flight().scans) {
      process(scan, a.get());
      process(scan, b.get());
      const double apart = (a->estimate().nav.p_WB - b->estimate().nav.p_WB).norm();
      c.position = std::max(c.position, apart);
      c.rest_scans += a->report().at_rest ? 1 : 0;
    }
    c.last = a->report();
    const StateEstimate& of_a = a->backend().state_estimate();
    const StateEstimate& of_b = b->backend().state_estimate();
    c.same_size = of_a.covariance().size() == of_b.covariance().size();
    const int size = std::min(of_a.covariance().size(), of_b.covariance().size());
    const MatrixXd N = null_space(of_a.layout(), of_a.estimate()).topRows(size);
    const MatrixXd excess = of_b.covariance().matrix().topLeftCorner(size, size) -
                            of_a.covariance().matrix().topLeftCorner(size, size) -
                            kAlpha * N * N.transpose();
    c.covariance = excess.cwiseAbs().maxCoeff() / kAlpha;
    return c;
  }

  static constexpr double kSigma = 0.01;
  Options options_;
  std::unique_ptr<ImuBuffer> imu_;
  DetectionList list_;
};

TEST_F(ObservabilityTest, AddedUncertaintyOfPositionAndHeadingStaysAsItIs) {
  const Comparison c = compare();
  // rounding of numbers around 1 over 600 updates; measured: 1e-9 and 1e-10
  EXPECT_TRUE(c.same_size);
  EXPECT_LT(c.covariance, 1e-6);
  EXPECT_LT(c.position, 1e-6);
  // every kind of block and of measurement has taken part
  EXPECT_GT(c.last.landmarks, 10);
  EXPECT_EQ(c.last.clones, options_.update.max_clones);
  EXPECT_GT(c.rest_scans, 10);
  EXPECT_EQ(c.last.calibration[static_cast<std::size_t>(Calibration::kTimeOffset)].observability,
            Observability::kObserved);
}

TEST_F(ObservabilityTest, TheTrailsKeepItSoToo) {
  options_.update.use_trails = true;
  const Comparison c = compare();
  EXPECT_LT(c.covariance, 1e-6);
  EXPECT_LT(c.position, 1e-6);
}

// Without re-expression, linearisation points that move make the filter believe it sees the
// heading.
TEST_F(ObservabilityTest, WithoutReexpressionItIsLost) {
  options_.update.consistent_covariance = false;
  const Comparison c = compare();
  EXPECT_GT(c.covariance, 1e-2);
  EXPECT_GT(c.position, 1e-2);
}

// (E2): what was not known of the heading at the start is never known later. What a scan may take
// away is only what the gyroscope has added since. A wide prior of the heading shows it.
TEST_F(ObservabilityTest, HeadingIsNeverBetterKnownThanAtTheStart) {
  const auto smallest_ratio = [this] {
    constexpr double kAlpha = 0.1;
    const auto pipeline = start(kAlpha);
    const double first = heading_variance(*pipeline);
    EXPECT_NEAR(first, kSigma * kSigma + kAlpha, 1e-12);
    double smallest = 1e300;
    for (const RadarScan& scan : flight().scans) {
      process(scan, pipeline.get());
      smallest = std::min(smallest, heading_variance(*pipeline) / first);
    }
    return smallest;
  };
  EXPECT_GE(smallest_ratio(), 1.0 - 1e-9);
  options_.update.consistent_covariance = false;
  EXPECT_LT(smallest_ratio(), 1.0 - 1e-4);  // information from nowhere
}

}  // namespace
}  // namespace rio::test
