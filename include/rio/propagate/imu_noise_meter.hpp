// SPDX-License-Identifier: BSD-3-Clause
// Stage 1: measures the noise density of the IMU in flight, from its samples alone. The configured
// density is that of a bench; aliased vibration, lost samples and jittered stamps add to it.
//
// n_k: the part of the samples x_k, at the interval h, that is not motion; stationary, with the
// spectrum S(f) up to half the rate, vibration above that folded in.
// (E1) var(h sum n_k) over the time T -> T S(0): integrated, n acts as white noise of density S(0)
// Motion hides S(0) itself; it is inferred from the octaves above (data/theory.md, 2):
// (E2) y = (x_0 + 2 x_1 + x_2) / 4 at twice the interval, and so on: the octaves l = 0, 1, 2 ...
// (E3) e = y_0 - 4 y_1 + 6 y_2 - 4 y_3 + y_4: zero for motion that is a cubic over five values
// (E4) q_l = h E[e^2] / g_l, g_l the variance of e for white x of unit variance: S, averaged over
//      the octave; the density itself where S is flat
// (E5) S(0) = min q_l, l >= 1; the highest octave, 0, is attenuated by the sensor's low-pass filter
// (E6) a step over m intervals, with the samples between lost, has the density m S(0): one value
//      replaces m.
// (E7) an onset: E[e^2] of octave 1 over its last few values is far above the mean. The means start
//      over, and lower octaves count when they have seen enough. The next values of e contain the
//      samples from before: the k-th has the gain of its newest 2 k - 1/2 samples, (E4) with the
//      last taps of the filter only.
// Limits:
// - less than some 100 times the amplitude of before is no onset, but learned as the mean follows
// - a tone that aliases below the lowest octave cannot be distinguished from motion
// - if a driver has interpolated 30 % of the samples, half the density of white noise is seen
// - the three axes share one density, as in the process noise
#pragma once

#include <array>
#include <cstdint>

#include "rio/types.hpp"

namespace rio {

/// Power spectral densities, mean of the three axes.
struct ImuNoise {
  double gyro = 0.0;   ///< [(rad/s)^2/Hz]
  double accel = 0.0;  ///< [(m/s^2)^2/Hz]
};

/// O(1) a sample, no allocation.
class ImuNoiseMeter {
 public:
  void reset() { *this = ImuNoiseMeter{}; }

  /// Takes one more sample; returns the density of the step that ends with it, zero until enough
  /// samples are known.
  ImuNoise add(const ImuSample& sample);

 private:
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  static constexpr std::size_t kOctaves = 6;
  /// Longest interval of an octave: e responds above 3 Hz there, bodies move more slowly [s].
  static constexpr double kLongest = 0.05;
  static constexpr double kMemory = 0.5;      // time constant: throttle and ground last longer [s]
  static constexpr double kPause = 0.5;       // a longer pause of the samples starts over [s]
  static constexpr double kIntervals = 64.0;  // averaged to the nominal interval
  static constexpr double kEnough = 8.0;      // values of e: the variance is known to a half
  static constexpr double kRecent = 0.25;     // weight of a value in the recent mean (E7)
  static constexpr double kOnset = 100.0;     // ratio; the mean follows: 100 times the amplitude
  static constexpr double kOnsetDelay = 1.0;  // steps before an onset is noticed, about

  enum Sensor : std::uint8_t { kGyro, kAccel, kSensors };

  /// E[e^2] of one sensor, mean of the axes.
  struct Mean {
    double count = 0.0;  ///< of e
    double value = 0.0;

    void add(double square, double least_weight);
  };

  struct Octave {
    std::array<Vector6d, 5> y{};
    int size = 0;
    bool odd = false;  ///< every other value enters the next octave
    std::array<Mean, kSensors> means{};
  };

  static constexpr std::size_t kDone = 5;  // values, and e contains no sample from before

  /// The onset of one sensor.
  struct Onset {
    double recent = 0.0;         ///< mean of the last values of octave 1
    std::size_t values = kDone;  ///< of octave 1 since then
    bool now = false;            ///< with the newest sample
    bool begun = false;          ///< there was one: octave 1 counts from its first value on
  };

  /// Takes a value of octave l, and the values of lower octaves that it completes.
  void enter(std::size_t l, const Vector6d& y);
  /// Takes e^2 in octave 1 of a sensor; starts its means over if that is an onset (E7).
  void take(std::size_t sensor, double square, double least_weight);
  /// (E4) (E5) (E7)
  double density(std::size_t sensor) const;
  double interval(std::size_t l) const { return interval_ * static_cast<double>(1 << l); }

  std::array<Octave, kOctaves> octaves_{};
  std::array<Onset, kSensors> onsets_{};
  Time newest_{0};
  double count_ = 0.0;     ///< samples
  double interval_ = 0.0;  ///< h, mean [s]
};

}  // namespace rio
