// SPDX-License-Identifier: BSD-3-Clause
// The density measured against what the samples really do to the integrated velocity.
#include "rio/propagate/imu_noise_meter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "rio/propagate/imu_buffer.hpp"
#include "rio/propagate/strapdown.hpp"
#include "support/measured.hpp"
#include "support/random_state.hpp"

namespace rio {
namespace {

using std::chrono::milliseconds;

constexpr double kPi = 3.14159265358979323846;

/// Stationary vibration: tones with random phases, the same spectrum in every axis.
class Vibration {
 public:
  /// `rms` [m/s^2] spread evenly from `low` to `high` [Hz]
  Vibration(double rms, double low, double high, test::Random* random) {
    constexpr int kTones = 60;
    amplitude_ = rms * std::sqrt(2.0 / kTones);
    for (Axis& axis : axes_) {
      for (int i = 0; i < kTones; ++i) {
        const double f = low + (high - low) * (i + random->uniform(0.0, 1.0)) / kTones;
        axis.push_back({2.0 * kPi * f, random->uniform(0.0, 2.0 * kPi)});
      }
    }
  }
  Vector3d acceleration(double t) const {
    return sum([&](const Tone& tone) { return std::cos(tone.omega * t + tone.phase); });
  }
  /// Its integral.
  Vector3d velocity(double t) const {
    return sum(
        [&](const Tone& tone) { return std::sin(tone.omega * t + tone.phase) / tone.omega; });
  }

 private:
  struct Tone {
    double omega = 0.0;
    double phase = 0.0;
  };
  using Axis = std::vector<Tone>;

  Vector3d sum(const std::function<double(const Tone&)>& f) const {
    Vector3d out = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      for (const Tone& tone : axes_[static_cast<std::size_t>(i)]) out[i] += amplitude_ * f(tone);
    }
    return out;
  }

  double amplitude_ = 0.0;
  std::array<Axis, 3> axes_;
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

/// Over many flights: a slow motion and vibration, sampled at `rate`; the error of the velocity
/// integrated over a second, against what the process noise of its steps says.
Ratio monte_carlo(const Spectrum& s, double rate, double density) {
  constexpr int kRuns = 200;
  constexpr double kBefore = 1.5;
  constexpr double kSpan = 1.0;
  test::Random random(7);
  ImuOptions options;
  options.accel_noise_density = density;
  options.stamp_sigma = 0.0;
  options.gap_accel_sigma = 0.0;
  Ratio ratio;
  for (int run = 0; run < kRuns; ++run) {
    const Vibration vibration(s.rms, s.low, s.high, &random);
    const Vibration motion(1.0, 0.1, 1.0, &random);  // of the vehicle, [m/s^2]
    ImuBuffer buffer(TimingOptions{}, options);
    std::vector<ImuSample> samples;
    const int count = static_cast<int>((kBefore + kSpan) * rate) + 3;
    std::vector<bool> kept;
    for (int i = 0; i < count; ++i) {
      const double t = i / rate;
      samples.push_back({from_seconds(t), Vector3d::Zero(),
                         motion.acceleration(t) + vibration.acceleration(t) +
                             random.normal_vector(density * std::sqrt(rate))});
      kept.push_back(i == 0 || i == count - 1 || random.uniform(0.0, 1.0) >= s.share);
    }
    std::size_t last = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!kept[i]) continue;
      for (std::size_t k = last + 1; k < i && s.loss == Loss::kInterpolated; ++k) {
        buffer.push_back(interpolate(samples[last], samples[i], samples[k].time));
      }
      buffer.push_back(samples[i]);
      last = i;
    }
    Vector3d v = Vector3d::Zero();
    double variance = 0.0;
    buffer.for_each_step(from_seconds(kBefore), from_seconds(kBefore + kSpan),
                         [&](const ImuStep& step) {
                           const double dt = to_seconds(step.end - step.begin);
                           v += dt * step.accel_B;
                           variance += dt * process_noise(options, step).accel;
                         });
    const auto truth = [&](double t) {
      return (motion.velocity(t) + vibration.velocity(t)).eval();
    };
    const Vector3d error = v - (truth(kBefore + kSpan) - truth(kBefore));
    ratio.predicted += variance / kRuns;
    ratio.actual += error.squaredNorm() / 3.0 / kRuns;
  }
  return ratio;
}

constexpr double kRate = 100.0;    // [Hz]
constexpr double kDensity = 2e-3;  // declared, a bench's [m/s^2/sqrt(Hz)]

TEST(ImuNoiseMeter, PredictsWhatVibrationAndLossDoToTheVelocity) {
  const Spectrum spectra[] = {
      {"rotors at 60 to 240 Hz, folded", 5.0, 60.0, 240.0},
      {"broad, 20 to 400 Hz", 5.0, 20.0, 400.0},
      {"broad, 5 to 200 Hz", 5.0, 5.0, 200.0},
      {"high, 300 to 1000 Hz", 2.0, 300.0, 1000.0},
      {"gentle, 20 to 400 Hz", 0.2, 20.0, 400.0},
      {"20 to 45 Hz, 30 % lost", 5.0, 20.0, 45.0, Loss::kGone, 0.3},
      {"20 to 400 Hz, 30 % lost", 5.0, 20.0, 400.0, Loss::kGone, 0.3},
      {"20 to 400 Hz, 10 % lost", 5.0, 20.0, 400.0, Loss::kGone, 0.1},
  };
  for (const Spectrum& s : spectra) {
    const Ratio r = monte_carlo(s, kRate, kDensity);
    test::measured(std::string(s.name) + ": predicted / actual", r.predicted / r.actual,
                   "0.67 to 3");
    // 600 values: the variance itself is known to 6 %
    EXPECT_GT(r.predicted, r.actual / 1.5) << s.name;
    EXPECT_LT(r.predicted, 3.0 * r.actual) << s.name;
  }
}

// Interpolated on the way, they say less: lines have no high frequencies, and white is what the
// lowest octave alone still shows.
TEST(ImuNoiseMeter, InterpolationHidesAPart) {
  for (const Spectrum& s :
       {Spectrum{"20 to 45 Hz, 30 % interpolated", 5.0, 20.0, 45.0, Loss::kInterpolated, 0.3},
        Spectrum{"20 to 400 Hz, 30 % interpolated", 5.0, 20.0, 400.0, Loss::kInterpolated, 0.3}}) {
    const Ratio r = monte_carlo(s, kRate, kDensity);
    test::measured(std::string(s.name) + ": predicted / actual", r.predicted / r.actual,
                   "0.4 to 3");
    EXPECT_GT(r.predicted, r.actual / 2.5) << s.name;
    EXPECT_LT(r.predicted, 3.0 * r.actual) << s.name;
  }
}

// The samples follow it: its integral is bounded, and nothing must be underestimated either.
TEST(ImuNoiseMeter, CoversVibrationBelowHalfTheRate) {
  for (const Spectrum& s :
       {Spectrum{"20 to 45 Hz", 5.0, 20.0, 45.0}, Spectrum{"10 to 20 Hz", 2.0, 10.0, 20.0},
        Spectrum{"one rotor, 38 to 42 Hz", 5.0, 38.0, 42.0}}) {
    const Ratio r = monte_carlo(s, kRate, kDensity);
    test::measured(std::string(s.name) + ": predicted / actual", r.predicted / r.actual,
                   "above 0.67");
    EXPECT_GT(r.predicted, r.actual / 1.5) << s.name;
  }
}

TEST(ImuNoiseMeter, AQuietImuCostsNothing) {
  for (const double rate : {100.0, 200.0, 400.0}) {
    const Ratio r = monte_carlo({"quiet", 0.0, 20.0, 40.0}, rate, kDensity);
    const double growth = r.predicted / (kDensity * kDensity);
    test::measured("quiet IMU: measured / declared density", growth, "below 1.1");
    EXPECT_GE(growth, 1.0);
    EXPECT_LT(growth, 1.1);
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
    Vector3d sum = Vector3d::Zero();
    double variance = 0.0;
    buffer.for_each_step(from_seconds(kBegin), from_seconds(kBegin + span),
                         [&](const ImuStep& step) {
                           const double dt = to_seconds(step.end - step.begin);
                           sum += dt * (gyro ? step.gyro_B : step.accel_B);
                           const ProcessNoise density = process_noise(options, step);
                           variance += dt * (gyro ? density.gyro : density.accel);
                         });
    ratio.predicted += variance / kRuns;
    ratio.actual += sum.squaredNorm() / 3.0 / kRuns;
  }
  return ratio;
}

// Rough ground begins from one sample to the next, and so does what the estimate must know of it.
TEST(ImuNoiseMeter, AnOnsetIsNoticedAtOnce) {
  for (const bool gyro : {false, true}) {
    for (const double rate : {100.0, 200.0, 400.0}) {
      for (const double span : {0.1, 0.3, 1.0}) {
        const Ratio r = onset(gyro ? 1.0 : 30.0, rate, span, gyro);
        test::measured(std::string(gyro ? "gyro" : "accelerometer") + ", " +
                           std::to_string(std::lround(span * 1e3)) + " ms after an onset at " +
                           std::to_string(std::lround(rate)) + " Hz: predicted / actual",
                       r.predicted / r.actual, "0.5 to 3");
        EXPECT_GT(r.predicted, 0.5 * r.actual) << gyro << " " << rate << " Hz, " << span << " s";
        EXPECT_LT(r.predicted, 3.0 * r.actual) << gyro << " " << rate << " Hz, " << span << " s";
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
