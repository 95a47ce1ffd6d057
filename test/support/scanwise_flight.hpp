// SPDX-License-Identifier: BSD-3-Clause
// A simulated flight fed to a back-end scan by scan, so that a test can stop at any scan and look
// into it.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "experiment/trial.hpp"
#include "rio/ekf/ekf.hpp"
#include "rio/pipeline.hpp"
#include "rio/smoother/smoother.hpp"

namespace rio::test {

template <class B>
class ScanwiseFlight {
 public:
  explicit ScanwiseFlight(sim::Flight flight) : flight_(std::move(flight)) {}
  explicit ScanwiseFlight(const sim::Scenario& scenario)
      : ScanwiseFlight(sim::simulate_flight(scenario)) {}

  /// Of a preset, told the sensors of the flight.
  Options options(const std::string& preset = "default") const {
    Options o = experiment::options_for(flight_, preset);
    o.backend = std::is_same_v<B, Smoother> ? BackEnd::kSmoother : BackEnd::kEkf;
    return o;
  }

  /// A new pipeline that starts at `start`.
  void begin(const Options& options, const NavState& start) {
    options_ = options;
    options_.timing.imu_buffer = static_cast<int>(flight_.imu.size()) + 1;  // the whole flight
    list_ = DetectionList(options.frontend.max_detections);
    imu_ = std::make_unique<ImuBuffer>(options_.timing, options_.imu);
    for (const ImuSample& sample : flight_.imu) imu_->push_back(sample);
    pipeline_ = std::make_unique<Pipeline<B>>(options_);
    pipeline_->reset(start, start_covariance());
    next_ = 0;
  }
  /// At the true first state.
  void begin(const Options& options) { begin(options, flight_.truth.front()); }

  /// 1 cm, 1 cm/s, 0.6 deg; the biases at turn-on.
  BodyCovariance start_covariance() const {
    BodyCovariance P0 = 1e-4 * BodyCovariance::Identity();
    const auto set = [&P0](int at, double sigma) {
      P0.diagonal().segment<3>(at).setConstant(sigma * sigma);
    };
    set(body::kGyroBias, options_.start.sigma_gyro_bias);
    set(body::kAccelBias, options_.start.sigma_accel_bias);
    return P0;
  }

  std::size_t next() const { return next_; }
  /// The next scan is lost.
  void skip() { ++next_; }
  bool over() const { return next_ >= flight_.scans.size(); }
  Status step() { return process(flight_.scans[next_++]); }
  Status process(const RadarScan& scan, std::size_t radar = 0) {
    filter_detections(scan, options_.radar_of(radar), options_.frontend.max_detections, list_);
    list_.radar = radar;
    return pipeline_->process(list_, *imu_);
  }

  const sim::Flight& flight() const { return flight_; }
  const ImuBuffer& imu() const { return *imu_; }
  Pipeline<B>& pipeline() { return *pipeline_; }
  const B& back_end() const { return pipeline_->backend(); }
  const StateEstimate& state_estimate() const { return back_end().state_estimate(); }
  const Estimate& estimate() const { return pipeline_->estimate(); }
  const UpdateReport& report() const { return pipeline_->report(); }

 private:
  sim::Flight flight_;
  Options options_;
  std::unique_ptr<ImuBuffer> imu_;
  std::unique_ptr<Pipeline<B>> pipeline_;
  DetectionList list_;
  std::size_t next_ = 0;
};

using EkfFlight = ScanwiseFlight<Ekf>;
using SmootherFlight = ScanwiseFlight<Smoother>;

/// 20 m with ideal sensors.
/// @param stand_before standstill before take-off [s]
inline sim::Scenario ideal_flight(double stand_before = sim::PathOptions{}.stand_before) {
  sim::Scenario scenario = sim::Scenario::ideal();
  scenario.seed = 8;
  scenario.path.length = 20.0;
  scenario.path.stand_before = stand_before;
  return scenario;
}

/// Such a flight with the default options.
template <class Flight>
class ScanwiseTest : public testing::Test {
 protected:
  explicit ScanwiseTest(const sim::Scenario& scenario = ideal_flight()) : flight_(scenario) {
    flight_.begin(flight_.options());
  }

  void fly(std::size_t scans) {
    for (std::size_t i = 0; i < scans; ++i) ASSERT_EQ(flight_.step(), Status::kOk);
  }
  const UpdateReport& report() const { return flight_.report(); }
  const Estimate& x() const { return flight_.estimate(); }

  Flight flight_;
};

}  // namespace rio::test
