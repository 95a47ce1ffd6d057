// SPDX-License-Identifier: BSD-3-Clause
// The information limit of a flight: the recursion against one least-squares problem over all
// states with differenced measurements, how the limit answers to better and worse sensors, and
// where the estimator stands.
#include "experiment/information_limit.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <map>
#include <stdexcept>
#include <vector>

#include "experiment/campaign.hpp"
#include "rio/models/detection.hpp"
#include "rio/propagate/strapdown.hpp"

namespace rio::experiment {
namespace {

/// The mean of one scan: body, calibration, and the reflector that is looked at.
struct Point {
  RigidPose T_WB;
  Vector3d v_WB;
  Vector3d gyro_bias = Vector3d::Zero();
  RigidPose T_BS;
  double doppler_scale = 0.0;
  double elevation_bias = 0.0;
  double time_offset = 0.0;
  Vector3d p_WL;
  Vector3d gyro_B;
  Vector3d accel_W;
};

constexpr int kBody = body::kSize;
constexpr int kCalibration = 9;
constexpr int kColumns = kBody + kCalibration + 3;  // body, calibration, reflector
using Error = Eigen::Matrix<double, kColumns, 1>;

Point moved(Point x, const Error& d) {
  x.T_WB = BodyPose::retract(x.T_WB, d.head<6>());
  x.v_WB += d.segment<3>(body::kVelocity);
  x.gyro_bias += d.segment<3>(body::kGyroBias);
  x.T_BS = Extrinsics::retract(x.T_BS, d.segment<6>(kBody));
  x.doppler_scale += d[kBody + 6];
  x.elevation_bias += d[kBody + 7];
  x.time_offset += d[kBody + 8];
  x.p_WL += d.tail<3>();
  return x;
}

/// Range, azimuth and elevation about the directions of `noise`, Doppler; in sigmas.
Eigen::Vector4d measure(Point x, const Detection& noise) {
  const double dt = -x.time_offset;  // measured before the stamp
  const Vector3d w = x.gyro_B - x.gyro_bias;
  x.T_WB = {x.T_WB.R * gamma(0, x.gyro_B * dt), x.T_WB.p + dt * x.v_WB};
  x.v_WB += dt * x.accel_W;
  const Vector3d e = to_radar(x.T_WB, x.T_BS, x.p_WL);
  const Vector3d v_S = x.T_BS.R.transpose() * (x.T_WB.R.transpose() * x.v_WB + w.cross(x.T_BS.p));
  const Vector3d u = e.normalized();
  const double azimuth = noise.sigma_azimuth_S.normalized().dot(u);
  const double elevation = noise.sigma_elevation_S.normalized().dot(u) + x.elevation_bias;
  return {e.norm() / noise.sigma_range, azimuth / noise.sigma_azimuth_S.norm(),
          elevation / noise.sigma_elevation_S.norm(),
          -(1.0 + x.doppler_scale) * u.dot(v_S) / noise.sigma_doppler};
}

Eigen::Matrix<double, 4, kColumns> differenced(const Point& x, const Detection& noise) {
  constexpr double kStep = 1e-5;  // truncation 1e-10, rounding 1e-11 of values about 100
  Eigen::Matrix<double, 4, kColumns> J;
  for (int k = 0; k < kColumns; ++k) {
    const Error d = kStep * Error::Unit(k);
    J.col(k) = (measure(moved(x, d), noise) - measure(moved(x, -d), noise)) / (2.0 * kStep);
  }
  return J;
}

/// Whitened rows of one least-squares problem; the last body state stands last.
class Batch {
 public:
  explicit Batch(Eigen::Index columns) : columns_(columns) {}

  /// `A` in the columns that begin at each of `at`, kBody or 3 or kCalibration wide.
  void add(const std::vector<std::pair<Eigen::Index, Eigen::MatrixXd>>& blocks) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(blocks.front().second.rows(), columns_);
    for (const auto& [at, A] : blocks) rows.middleCols(at, A.cols()) += A;
    const Eigen::Index before = A_.rows();
    A_.conservativeResize(before + rows.rows(), columns_);
    A_.bottomRows(rows.rows()) = rows;
  }

  /// Covariance of the last body state.
  Matrix15d covariance() const {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A_);
    const Matrix15d R = qr.matrixQR()
                            .block<kBody, kBody>(columns_ - kBody, columns_ - kBody)
                            .triangularView<Eigen::Upper>();
    return (R.transpose() * R).inverse();
  }

 private:
  Eigen::Index columns_;
  Eigen::MatrixXd A_;
};

Eigen::MatrixXd inverse_root(const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd L = covariance.llt().matrixL();
  return L.triangularView<Eigen::Lower>().solve(
      Eigen::MatrixXd::Identity(covariance.rows(), covariance.cols()));
}

/// Two seconds of flight from 8 s on, noise as the filter models it, 6 reflectors a scan.
sim::Flight short_flight() {
  sim::Scenario s = sim::Scenario::ideal();
  s.seed = 3;
  s.path.length = 40.0;
  s.max_duration = 10.0;
  s.radar.max_static = 6;
  return sim::simulate_flight(s);
}

LimitPrior short_prior(const sim::Flight& flight) {
  LimitPrior prior;
  prior.time = flight.trajectory.start() + from_seconds(8.0);
  Eigen::Matrix<double, 5, 1> sigmas;
  sigmas << 0.02, 0.01, 0.05, 0.003, 0.05;
  for (int i = 0; i < kBody; ++i) prior.covariance(i, i) = sigmas[i / 3] * sigmas[i / 3];
  prior.calibration = {.rotation_sigma = 0.05,
                       .translation_sigma = 0.03,
                       .time_offset_sigma = 0.02,
                       .doppler_scale_sigma = 0.02,
                       .elevation_bias_sigma = 0.03};
  return prior;
}

/// The last covariance by one least-squares problem.
Matrix15d batch_covariance(const sim::Flight& flight, const Options& o, const LimitPrior& prior) {
  std::vector<std::size_t> scans;
  std::map<int, Eigen::Index> reflectors;
  for (std::size_t i = 0; i < flight.scans.size(); ++i) {
    if (flight.scans[i].time < prior.time) continue;
    scans.push_back(i);
    for (const sim::Label& label : flight.labels[i]) {
      reflectors.emplace(label.reflector, static_cast<Eigen::Index>(reflectors.size()));
    }
  }
  EXPECT_LE(reflectors.size(), kMaxLandmarks);  // else the recursion would drop some
  const Eigen::Index bodies = kCalibration + 3 * static_cast<Eigen::Index>(reflectors.size());
  const auto body_at = [&](std::size_t k) { return bodies + kBody * static_cast<Eigen::Index>(k); };
  Batch batch(body_at(scans.size() + 1));

  const CalibrationOptions& c = prior.calibration;
  Eigen::Matrix<double, kCalibration, 1> sigmas;
  sigmas << Vector3d::Constant(c.rotation_sigma), Vector3d::Constant(c.translation_sigma),
      c.doppler_scale_sigma, c.elevation_bias_sigma, c.time_offset_sigma;
  batch.add({{0, Eigen::MatrixXd(sigmas.cwiseInverse().asDiagonal())}});
  batch.add({{body_at(0), inverse_root(prior.covariance)}});

  TimingOptions timing;
  timing.imu_buffer = static_cast<int>(flight.imu.size());
  ImuBuffer imu(timing, o.imu);
  for (const ImuSample& s : flight.imu) {
    const sim::Trajectory::Point truth = flight.trajectory.at(s.time);
    imu.push_back({s.time, truth.gyro_B, truth.accel_B});
  }
  Time last = prior.time;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const RadarScan& scan = flight.scans[scans[k]];
    Propagation p;
    p.state = flight.trajectory.at(last).nav;
    imu.for_each_step(last, scan.time, [&](const ImuStep& step) { p.step(step, o.imu); });
    const Eigen::MatrixXd root = inverse_root(p.noise());
    batch.add({{body_at(k), root * p.transition()}, {body_at(k + 1), -root}});
    const sim::Trajectory::Point truth = flight.trajectory.at(scan.time);
    for (const sim::Label& label : flight.labels[scans[k]]) {
      Point x;
      x.T_WB = {truth.nav.q_WB.toRotationMatrix(), truth.nav.p_WB};
      x.v_WB = truth.nav.v_WB;
      x.T_BS = RigidPose(flight.scenario.radar.T_BS);
      x.gyro_B = truth.gyro_B;
      x.accel_W = truth.accel_W;
      x.p_WL = flight.room.reflectors[static_cast<std::size_t>(label.reflector)].position_W;
      const Detection noise =
          make_detection({.point_S = to_radar(x.T_WB, x.T_BS, x.p_WL)}, o.radar);
      const Eigen::Matrix<double, 4, kColumns> J = differenced(x, noise);
      batch.add({{0, J.middleCols<kCalibration>(kBody)},
                 {kCalibration + 3 * reflectors.at(label.reflector), J.rightCols<3>()},
                 {body_at(k + 1), J.leftCols<kBody>()}});
    }
    last = scan.time;
  }
  return batch.covariance();
}

TEST(InformationLimit, IsThatOfOneLeastSquaresProblem) {
  const sim::Flight flight = short_flight();
  const LimitPrior prior = short_prior(flight);
  const Options o = options_for(flight, "default");
  const Matrix15d P = batch_covariance(flight, o, prior);
  const std::vector<LimitStep> steps = information_limit(flight, o, prior);
  ASSERT_GE(steps.size(), 28U);  // 2 s at 15 Hz
  // the difference quotients are exact to 1e-9
  constexpr double kRelative = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const double expected = std::sqrt(P(body::kPosition + i, body::kPosition + i));
    EXPECT_NEAR(steps.back().position[i], expected, kRelative * expected);
  }
  const double velocity = std::sqrt(P.diagonal().segment<3>(body::kVelocity).sum());
  EXPECT_NEAR(steps.back().velocity, velocity, kRelative * velocity);
  const Vector3d up =
      flight.trajectory.at(steps.back().time).nav.q_WB.conjugate() * Vector3d::UnitZ();
  const double heading = std::sqrt(up.dot(P.topLeftCorner<3, 3>() * up));
  EXPECT_NEAR(steps.back().heading, heading, kRelative * heading);
}

/// Final RMSE of the short flight.
double rmse(const sim::Flight& flight, const Options& options, const LimitPrior& prior) {
  return information_limit(flight, options, prior).back().rmse();
}

TEST(InformationLimit, BetterSensorsLowerIt) {
  const sim::Flight flight = short_flight();
  const LimitPrior prior = short_prior(flight);
  const Options plain = options_for(flight, "default");
  const double limit = rmse(flight, plain, prior);
  Options better = plain;
  better.radar.sigma_doppler *= 0.5;
  EXPECT_LT(rmse(flight, better, prior), 0.99 * limit);
  better = plain;
  better.radar.sigma_range *= 0.5;
  EXPECT_LT(rmse(flight, better, prior), 0.99 * limit);
  better = plain;
  better.radar.sigma_azimuth *= 0.5;
  EXPECT_LT(rmse(flight, better, prior), 0.99 * limit);
  better = plain;
  better.imu.accel_noise_density *= 100.0;
  EXPECT_GT(rmse(flight, better, prior), 1.01 * limit);
}

TEST(InformationLimit, EveryUnknownOfTheCalibrationRaisesIt) {
  const sim::Flight flight = short_flight();
  const Options o = options_for(flight, "default");
  LimitPrior known = short_prior(flight);
  known.calibration = {0.0, 0.0, 0.0, 0.0, 0.0};
  const double limit = rmse(flight, o, known);
  const CalibrationOptions all = short_prior(flight).calibration;
  for (const auto sigma :
       {&CalibrationOptions::rotation_sigma, &CalibrationOptions::translation_sigma,
        &CalibrationOptions::doppler_scale_sigma, &CalibrationOptions::elevation_bias_sigma,
        &CalibrationOptions::time_offset_sigma}) {
    LimitPrior unknown = known;
    unknown.calibration.*sigma = all.*sigma;
    EXPECT_GT(rmse(flight, o, unknown), limit * (1.0 + 1e-6));  // more than rounding
  }
}

TEST(InformationLimit, FewerEchoesRaiseIt) {
  sim::Flight flight = short_flight();
  const LimitPrior prior = short_prior(flight);
  const Options o = options_for(flight, "default");
  const double limit = rmse(flight, o, prior);
  for (auto& labels : flight.labels) {
    for (sim::Label& label : labels) {
      if (label.reflector % 2 == 0) label.cause = sim::Cause::kMirror;  // what does not count
    }
  }
  EXPECT_GT(rmse(flight, o, prior), 1.05 * limit);
}

TEST(InformationLimit, NoiseOfTheSimulatedRadarCounts) {
  const sim::Flight flight = short_flight();
  const LimitPrior prior = short_prior(flight);
  const Options o = options_for(flight, "default");
  const double limit = rmse(flight, o, prior);
  sim::Flight worse = flight;
  worse.scenario.radar.weak_angle_growth = 1.0;
  EXPECT_GT(rmse(worse, o, prior), limit * (1.0 + 1e-3));
  worse = flight;
  worse.scenario.radar.angle_grid = 1.0 / 32.0;
  EXPECT_GT(rmse(worse, o, prior), limit * (1.0 + 1e-3));
  worse = flight;
  worse.scenario.radar.wander_sigma = 0.05;
  EXPECT_GT(rmse(worse, o, prior), limit * (1.0 + 1e-3));
}

TEST(InformationLimit, LateStampsAreKnownToBeLate) {
  const sim::Flight flight = short_flight();
  sim::Flight late = flight;
  late.scenario.radar.stamp_offset = 0.03;
  for (RadarScan& scan : late.scans) scan.time += from_seconds(0.03);
  const LimitPrior prior = short_prior(flight);
  const Options o = options_for(flight, "default");
  EXPECT_EQ(rmse(late, o, prior), rmse(flight, o, prior));
}

/// A whole flight of the scenario "monte-carlo": 40 m, noise as the filter models it.
sim::Flight whole_flight(std::uint64_t seed) {
  return sim::simulate_flight(cases_of("monte-carlo", 1, seed).front().scenario);
}

TEST(InformationLimit, LandmarksForgottenEarlierRaiseIt) {
  const sim::Flight flight = whole_flight(1);
  Options o = options_for(flight, "default");
  const LimitPrior prior = limit_prior(flight, o);
  double before = 0.0;
  for (const double timeout : {10.0, 0.5, 0.0}) {
    o.frontend.landmark_timeout = timeout;
    const double limit = rmse(flight, o, prior);
    EXPECT_GT(limit, 1.05 * before) << timeout;
    before = limit;
  }
}

TEST(InformationLimit, BeginsWhereTheAlignmentEnds) {
  const sim::Flight flight = whole_flight(2);
  const Options o = options_for(flight, "default");
  const LimitPrior prior = limit_prior(flight, o);
  const Trial trial = fly(flight, o);
  const std::vector<LimitStep> steps = information_limit(flight, o, prior);
  ASSERT_LE(trial.steps.size(), steps.size());
  EXPECT_EQ(trial.steps.front().truth.time, steps.front().time);
  EXPECT_EQ(steps.front().distance, 0.0);
  EXPECT_NEAR(steps.back().distance, 40.0, 0.1);
  EXPECT_DOUBLE_EQ(limit_of_drift(steps), 100.0 * steps.back().rmse() / steps.back().distance);
  // a scan period of "standing" at 0.01 m/s adds less than 0.1 mm in the sum of squares
  EXPECT_NEAR(steps.front().rmse(), std::sqrt(3.0) * o.start.sigma_position, 1e-4);
  EXPECT_TRUE(std::isnan(limit_of_drift({})));
  const std::vector<eval::PosePair> pairs = mean_errors_at_limit(flight, steps);
  ASSERT_EQ(pairs.size(), steps.size());
  // the mean of |e| for a Gaussian error of unit variance
  EXPECT_NEAR((pairs.back().estimate.p - pairs.back().truth.p).norm(),
              0.7978845608 * steps.back().rmse(), 1e-9);
}

TEST(InformationLimit, NeedsAStandstill) {
  sim::Flight flight = short_flight();
  flight.imu.erase(flight.imu.begin(), flight.imu.begin() + 1200);  // 6 s: it moves by then
  EXPECT_THROW(limit_prior(flight, options_for(flight, "default")), std::runtime_error);
}

TEST(InformationLimit, TheEstimatorComesNearAndStaysAbove) {
  double squared_error = 0.0;
  double squared_limit = 0.0;
  constexpr int kFlights = 6;
  for (std::uint64_t seed = 1; seed <= kFlights; ++seed) {
    const sim::Flight flight = whole_flight(seed);
    const Options o = options_for(flight, "default");
    const std::vector<Step> steps = fly(flight, o).steps;
    squared_error += (steps.back().estimate.p_WB - steps.back().truth.p_WB).squaredNorm();
    const double limit = information_limit(flight, o, limit_prior(flight, o)).back().rmse();
    squared_limit += limit * limit;
  }
  const double ratio = std::sqrt(squared_error / squared_limit);
  // 18 squared components: the RMS of an estimator at the limit spreads by 17 %
  EXPECT_GT(ratio, 0.7);
  EXPECT_LT(ratio, 3.0);
}

}  // namespace
}  // namespace rio::experiment
