// SPDX-License-Identifier: BSD-3-Clause
// The Birge ratio of a parameter that a Kalman filter estimates, measured ten times a second.
#include "rio/update/birge_ratio.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "rio/sim/random.hpp"

namespace rio {
namespace {

constexpr double kNoiseSigma = 1.0;
constexpr double kPriorSigma = 0.5;

/// A constant or a random walk, estimated by measurements whose noise is assumed independent.
class Filter {
 public:
  /// @param walk variance per second
  explicit Filter(double prior_error, double walk = 0.0) : walk_(walk), error_(prior_error) {
    ratio_ = told();
  }

  /// The parameter moves.
  void walk(double step, double seconds) {
    value_ += step;
    error_ -= step;
    P_ += walk_ * seconds;
  }

  /// @param noise its error
  void measure(double noise, double variance = kNoiseSigma * kNoiseSigma) {
    const double gain = P_ / (P_ + variance);
    error_ += gain * (noise - error_);
    P_ *= 1.0 - gain;
    time_ += Time(100'000'000);
    ratio_ = told();
  }
  void widen() { P_ = kPriorSigma * kPriorSigma; }
  double error() const { return error_; }
  double sigma() const { return std::sqrt(P_); }
  double ratio() const { return ratio_; }

 private:
  double told() { return birge_.add(time_, value_ + error_, sigma(), walk_); }

  BirgeRatio birge_;
  Time time_{0};
  double walk_;
  double value_ = 0.0;  ///< true
  double error_;
  double P_ = kPriorSigma * kPriorSigma;
  double ratio_ = 1.0;
};

/// Means over 500 flights of a minute; the error of a measurement repeats `persistence` times.
struct Flights {
  explicit Flights(int persistence, double walk = 0.0) {
    constexpr int kFlights = 500;
    sim::Random random(3);
    for (int flight = 0; flight < kFlights; ++flight) {
      constexpr double kPeriod = 0.1;  // [s]
      Filter filter(kPriorSigma * random.normal(), walk);
      double noise = 0.0;
      for (int i = 0; i < 600; ++i) {
        if (walk > 0.0) filter.walk(std::sqrt(walk * kPeriod) * random.normal(), kPeriod);
        if (i % persistence == 0) noise = random.normal();
        filter.measure(noise);
      }
      const double z = filter.error() / filter.sigma();
      by_covariance += z * z / kFlights;
      told += z * z / (filter.ratio() * filter.ratio()) / kFlights;
      ratio += filter.ratio() / kFlights;
    }
  }
  double by_covariance = 0.0;  ///< NEES
  double told = 0.0;           ///< same, with the ratio
  double ratio = 0.0;
};

TEST(BirgeRatio, OfIndependentErrorsIsNearlyOne) {
  const Flights flights(1);
  EXPECT_NEAR(flights.by_covariance, 1.0, 0.2);
  EXPECT_LT(flights.ratio, 1.15);  // at least 1, so its mean is above
}

TEST(BirgeRatio, ErrorsThatPersistWidenTheSigma) {
  const Flights flights(10);
  EXPECT_GT(flights.by_covariance, 7.0);
  EXPECT_NEAR(flights.told, 1.0, 0.5);
}

// The sigma no longer falls: after a minute it is that at which the walk and the measurements are
// in balance, half of the prior's.
constexpr double kWalk = 0.04;

TEST(BirgeRatio, OfARandomWalkIsNearlyOne) {
  const Flights flights(1, kWalk);
  EXPECT_NEAR(flights.by_covariance, 1.0, 0.2);
  EXPECT_LT(flights.ratio, 1.15);
}

TEST(BirgeRatio, ErrorsThatPersistWidenTheSigmaOfARandomWalk) {
  const Flights flights(10, kWalk);
  EXPECT_GT(flights.by_covariance, 2.5);
  EXPECT_LT(flights.told, 0.7 * flights.by_covariance);
  EXPECT_GT(flights.ratio, 1.2);
}

TEST(BirgeRatio, AWrongPriorIsNotCounted) {
  Filter filter(10.0 * kPriorSigma);
  for (int i = 0; i < 600; ++i) filter.measure(0.0);
  EXPECT_LT(filter.ratio(), 1.1);
}

TEST(BirgeRatio, AWiderPriorBeginsAnInterval) {
  Filter filter(0.0);
  for (int i = 0; i < 200; ++i) filter.measure(0.0);
  filter.widen();
  for (int i = 0; i < 600; ++i) filter.measure(0.5);  // until P is smaller than before
  EXPECT_LT(filter.ratio(), 1.3);
}

// At rest neither the value nor its sigma changes: that is no evidence of consistency.
TEST(BirgeRatio, WithoutInformationTheIntervalContinues) {
  Filter filter(0.0);
  for (int i = 0; i < 600; ++i) filter.measure(i / 40 % 2 == 0 ? 1.0 : -1.0);
  const double before = filter.ratio();
  EXPECT_GT(before, 2.0);
  for (int i = 0; i < 6000; ++i) filter.measure(0.0, 1e9);
  EXPECT_EQ(filter.ratio(), before);
}

}  // namespace
}  // namespace rio
