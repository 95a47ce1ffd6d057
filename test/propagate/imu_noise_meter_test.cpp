// SPDX-License-Identifier: BSD-3-Clause
// The density measured against what the samples really do to the integrated velocity.
#include "rio/propagate/imu_noise_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/strapdown.hpp"
#include "support/measured.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

/// Stationary vibration: tones with random phases, the same spectrum in every axis.
class Vibration {
 public:
  /// `rms` [m/s^2] spread evenly from `low` to `high` [Hz]
  Vibration(double rms, double low, double high, test::Random* random)
      : amplitude_(rms * std::sqrt(2.0 / kTones)) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kTones; ++i) {
        const double f = low + (high - low) * (i + random->uniform(0.0, 1.0)) / kTones;
        omega_(axis, i) = 2.0 * std::numbers::pi * f;
        phase_(axis, i) = random->uniform(0.0, 2.0 * std::numbers::pi);
      }
    }
  }
  Vector3d acceleration(double t) const {
    return amplitude_ * (omega_ * t + phase_).cos().rowwise().sum();
  }
  /// Its integral.
  Vector3d velocity(double t) const {
    return amplitude_ * ((omega_ * t + phase_).sin() / omega_).rowwise().sum();
  }

 private:
  static constexpr int kTones = 60;
  using Tones = Eigen::Array<double, 3, kTones>;

  double amplitude_;
  Tones omega_;
  Tones phase_;
};

/// How samples get lost.
enum class Loss { kNone, kGone, kInterpolated };

struct Spectrum {
  const char* name;
  double rms;   ///< [m/s^2]
  double low;   ///< [Hz]
  double high;  ///< [Hz]
  Loss loss = Loss::kNone;
  double share = 0.0;  ///< of samples lost
};

struct Ratio {
  double predicted = 0.0;  ///< variance of the velocity after a second, mean of the axes
  double actual = 0.0;
};

/// What the steps of a second or less add up to.
struct Integral {
  Vector3d sum = Vector3d::Zero();
  double variance = 0.0;  ///< as the process noise says, an axis

  Integral(const ImuBuffer& buffer, const ImuOptions& options, double begin, double span,
           bool gyro) {
    buffer.for_each_step(from_seconds(begin), from_seconds(begin + span), [&](const ImuStep& step) {
      const double dt = to_seconds(step.end - step.begin);
      const ProcessNoise density = process_noise(options, step);
      sum += dt * (gyro ? step.gyro_B : step.accel_B);
      variance += dt * (gyro ? density.gyro : density.accel);
    });
  }
};

/// Over many flights: a slow motion and vibration, sampled at `rate`; the error of the velocity
/// integrated over a second, against what the process noise of its steps says.
Ratio monte_carlo(const Spectrum& s, double rate, double density, int runs = 200) {
  constexpr double kBefore = 1.5;
  constexpr double kSpan = 1.0;
  test::Random random(7);
  const ImuOptions options{
      .accel_noise_density = density, .stamp_sigma = 0.0, .gap_accel_sigma = 0.0};
  Ratio ratio;
  for (int run = 0; run < runs; ++run) {
    const Vibration vibration(s.rms, s.low, s.high, &random);
    const Vibration motion(1.0, 0.1, 1.0, &random);  // of the vehicle, [m/s^2]
    ImuBuffer buffer(TimingOptions{}, options);
    const int count = static_cast<int>((kBefore + kSpan) * rate) + 3;
    ImuSample last;
    std::vector<Time> lost;  // since the last sample
    for (int i = 0; i < count; ++i) {
      const double t = i / rate;
      const ImuSample sample{from_seconds(t), Vector3d::Zero(),
                             motion.acceleration(t) + vibration.acceleration(t) +
                                 random.normal_vector(density * std::sqrt(rate))};
      if (i > 0 && i < count - 1 && random.uniform(0.0, 1.0) < s.share) {
        lost.push_back(sample.time);
        continue;
      }
      if (s.loss == Loss::kInterpolated) {
        for (const Time time : lost) buffer.push_back(interpolate(last, sample, time));
      }
      buffer.push_back(sample);
      last = sample;
      lost.clear();
    }
    const Integral v(buffer, options, kBefore, kSpan, false);
    const auto truth = [&](double t) {
      return (motion.velocity(t) + vibration.velocity(t)).eval();
    };
    const Vector3d error = v.sum - (truth(kBefore + kSpan) - truth(kBefore));
    ratio.predicted += v.variance / runs;
    ratio.actual += error.squaredNorm() / 3.0 / runs;
  }
  return ratio;
}

constexpr double kRate = 100.0;    // [Hz]
constexpr double kDensity = 2e-3;  // declared, a bench's [m/s^2/sqrt(Hz)]

TEST(ImuNoiseMeter, PredictsWhatVibrationAndLossDoToTheVelocity) {
  struct Row {
    Spectrum spectrum;
    double least = 0.67;  ///< predicted over actual; 600 values: known to 6 %
    double most = 3.0;
  };
  // samples below half the rate follow it: its integral is bounded
  constexpr double kAny = std::numeric_limits<double>::infinity();
  for (const auto& [spectrum, least, most] : {
           Row{{"rotors at 60 to 240 Hz, folded", 5.0, 60.0, 240.0}},
           Row{{"broad, 20 to 400 Hz", 5.0, 20.0, 400.0}},
           Row{{"broad, 5 to 200 Hz", 5.0, 5.0, 200.0}},
           Row{{"high, 300 to 1000 Hz", 2.0, 300.0, 1000.0}},
           Row{{"gentle, 20 to 400 Hz", 0.2, 20.0, 400.0}},
           Row{{"20 to 45 Hz, 30 % lost", 5.0, 20.0, 45.0, Loss::kGone, 0.3}},
           Row{{"20 to 400 Hz, 30 % lost", 5.0, 20.0, 400.0, Loss::kGone, 0.3}},
           Row{{"20 to 400 Hz, 10 % lost", 5.0, 20.0, 400.0, Loss::kGone, 0.1}},
           // lines between samples have no high frequencies, and white is what the lowest octave
           // alone still shows
           Row{{"20 to 45 Hz, 30 % interpolated", 5.0, 20.0, 45.0, Loss::kInterpolated, 0.3}, 0.4},
           Row{{"20 to 400 Hz, 30 % interpolated", 5.0, 20.0, 400.0, Loss::kInterpolated, 0.3},
               0.4},
           Row{{"20 to 45 Hz", 5.0, 20.0, 45.0}, 0.67, kAny},
           Row{{"10 to 20 Hz", 2.0, 10.0, 20.0}, 0.67, kAny},
           Row{{"one rotor, 38 to 42 Hz", 5.0, 38.0, 42.0}, 0.67, kAny},
       }) {
    const Ratio r = monte_carlo(spectrum, kRate, kDensity);
    test::expect_between(std::string(spectrum.name) + ": predicted / actual",
                         r.predicted / r.actual, least, most);
  }
}

TEST(ImuNoiseMeter, AQuietImuCostsNothing) {
  for (const double rate : {100.0, 200.0, 400.0}) {
    const Ratio r = monte_carlo({"quiet", 0.0, 20.0, 40.0}, rate, kDensity, 20);
    const double growth = r.predicted / (kDensity * kDensity);
    test::expect_below("quiet IMU: measured / declared density", growth, 1.1);
    EXPECT_GE(growth, 1.0);
  }
}

/// White vibration that begins at a moment in a quiet flight; the error of what is integrated from
/// then on for `span` [s], against what the process noise says.
Ratio onset(double rms, double rate, double span, bool gyro) {
  constexpr int kRuns = 300;
  constexpr double kBegin = 2.0;
  test::Random random(9);
  ImuOptions options;
  options.stamp_sigma = 0.0;
  const double quiet = gyro ? options.gyro_noise_density : options.accel_noise_density;
  Ratio ratio;
  for (int run = 0; run < kRuns; ++run) {
    ImuBuffer buffer(TimingOptions{}, options);
    for (int i = 0; i <= static_cast<int>((kBegin + span) * rate) + 1; ++i) {
      const double sigma = i / rate < kBegin ? quiet * std::sqrt(rate) : rms;
      ImuSample s{from_seconds(i / rate), random.normal_vector(1e-3), random.normal_vector(1e-2)};
      (gyro ? s.gyro_B : s.accel_B) = random.normal_vector(sigma);
      buffer.push_back(s);
    }
    const Integral integral(buffer, options, kBegin, span, gyro);
    ratio.predicted += integral.variance / kRuns;
    ratio.actual += integral.sum.squaredNorm() / 3.0 / kRuns;
  }
  return ratio;
}

// Rough ground begins from one sample to the next, and so does what the estimate must know of it.
TEST(ImuNoiseMeter, AnOnsetIsNoticedAtOnce) {
  for (const bool gyro : {false, true}) {
    for (const double rate : {100.0, 200.0, 400.0}) {
      for (const double span : {0.1, 0.3, 1.0}) {
        const Ratio r = onset(gyro ? 1.0 : 30.0, rate, span, gyro);
        const std::string what = std::string(gyro ? "gyro " : "accelerometer ") +
                                 std::to_string(rate) + " Hz, " + std::to_string(span) + " s";
        test::expect_between("onset, " + what, r.predicted / r.actual, 0.5, 3.0);
      }
    }
  }
}

TEST(ImuNoiseMeter, AnOnsetOfOneSensorLeavesTheOther) {
  ImuNoiseMeter meter;
  ImuNoiseMeter same;
  test::Random random(4);
  for (int i = 0; i < 400; ++i) {
    ImuSample s{milliseconds(5 * i), random.normal_vector(0.01), random.normal_vector(0.1)};
    const ImuNoise quiet = same.add(s);
    if (i >= 300) s.gyro_B *= 1000.0;
    const ImuNoise noise = meter.add(s);
    EXPECT_EQ(noise.accel, quiet.accel);
    if (i < 304) continue;  // the second value of octave 1
    EXPECT_GT(noise.gyro, 10.0 * quiet.gyro) << i;
  }
}

TEST(ImuNoiseMeter, KnowsNothingAtFirstAndAfterAPause) {
  ImuNoiseMeter meter;
  test::Random random(3);
  const auto add = [&](int i) {
    return meter.add({milliseconds(10 * i), random.normal_vector(1.0), random.normal_vector(1.0)});
  };
  for (int i = 0; i < 15; ++i) EXPECT_EQ(add(i).accel, 0.0) << i;
  for (int i = 15; i < 100; ++i) (void)add(i);
  EXPECT_GT(add(100).gyro, 0.0);
  EXPECT_EQ(add(200).gyro, 0.0);
}

}  // namespace
}  // namespace rio
