// SPDX-License-Identifier: BSD-3-Clause
// Mounting, delay of the stamps and Doppler scale of the radar from recordings, with sigmas that
// are validated by the recordings themselves.
//
// The estimator's own sigmas are too small where its models are wrong. So each recording is run as
// a whole and in two halves of the distance, from loose priors, about the calibration found by a
// first pass. The second half starts at the state of the whole run, with velocity and tilt
// re-opened, since these depend on the calibration of the first half. From each run the prior is
// removed:
// (E1) 1 / s^2 = 1 / P - 1 / p^2, x = v s^2 / P: value v off the centre, variance P, prior sigma p
// With whole runs w and halves h of all recordings:
// (E2) value x_w, sigma s_w: mean weighted by 1 / s^2; x_h, s_h the same of the halves
// (E3) apart: |x_1 - x_2| / sqrt(s_1^2 + s_2^2) of the halves of a recording, or of two recordings
// (E4) B_o^2: mean square of the halves' (E3) over all other parameters, not below 1
// (E5) B^2 = (chi^2 + n B_o^2) / (dof + n), n = 4: spread of the h about x_h, or of the w about
//      x_w, whichever is larger (Birge, Phys. Rev. 40, 1932), shrunk towards that of the others
//      (Smyth, Stat. Appl. Genet. Mol. Biol. 3, 2004): a pair that agrees by chance
//      must not make the sigma small
// (E6) sigma^2 = s_w^2 max(1, B^2) + (x_w - x_h)^2 + c^2, c the error common to all halves, which
//      no spread can show (kCommonError)
// (E7) contradictory: halves or recordings apart by more than 3 B_o; for the Doppler scale and the
//      time offset, which are optional and compensate errors without a model, by more than 3
// (E8) s^2 of the rotation is widened by e^2 (1 / S - 1)+ along the axes n of the radar, with
//      S = 3/2 mean of |n x v|^2 / |v|^2, v the velocity in radar axes without its noise: a
//      direction error e is a turn of e / sqrt(S). Of motion in all directions S is 1; about the
//      line of a straight motion it is 0, and what the estimator finds there is error.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "calibrate/calibration_run.hpp"
#include "calibrate/spread.hpp"
#include "rio/options.hpp"

namespace rio::calibrate {

/// Verdict on a parameter.
enum class Determination {
  kNotEstimated,   ///< its prior is zero
  kDetermined,     ///< determined by the data
  kNotDetermined,  ///< sigma above half its prior: the configured value is kept
  kContradictory,  ///< the data contradict each other: the configured value is kept
};
/// As in reports.
const char* to_string(Determination verdict);

/// A parameter, relative to the configured value; units and order of Calibration.
struct ParameterCalibration {
  double value = 0.0;
  double sigma = 0.0;             ///< (E6)
  double prior = 0.0;             ///< sigma of the configured value
  double run_sigma = 0.0;         ///< s_w of (E2), as the estimator says
  double halves_apart = 0.0;      ///< (E3), the worst of the recordings
  double recordings_apart = 0.0;  ///< same, the worst pair; 0 if there is one
  double spread = 0.0;            ///< B of (E5)
  Determination verdict = Determination::kNotEstimated;
};

/// Result of one run, relative to the configured value, the prior removed; sigma 0 = not estimated.
using MeasuredCalibration = std::array<Measured, kCalibrationCount>;

/// The runs of a recording.
struct RecordingCalibration {
  MeasuredCalibration whole{};
  MeasuredCalibration first{};
  MeasuredCalibration second{};
  Start begin;  ///< first state
  bool began_in_motion = false;
  Start middle;             ///< of the second half
  int velocity_resets = 0;  ///< of the whole run
};

struct RadarCalibration {
  std::array<ParameterCalibration, kCalibrationCount> parameters{};
  std::vector<RecordingCalibration> recordings;
  RadarOptions radar;         ///< as configured, with the determined parameters corrected
  CalibrationOptions priors;  ///< as configured, tightened where all axes are determined, so that
                              ///< the estimator's initial share of it equals the sigma found

  const ParameterCalibration& of(Calibration parameter) const {
    return parameters[static_cast<std::size_t>(parameter)];
  }
};

/// Errors common to all halves, of flights in the default simulated room (60 m, grids, fading,
/// ghosts, highlights), beyond their sigmas: roll and pitch 0.1 deg, Doppler scale 0.3 % too large,
/// stamps 0.5 ms [rad, m, 1, s].
inline constexpr std::array<double, kCalibrationCount> kCommonError = {0.002, 0.002, 0.0,   0.0,
                                                                       0.0,   0.0,   0.003, 0.0005};

/// Calibrates options.radar, with options.calibration as its prior sigmas. If the Doppler scale and
/// the time offset are not determined, a last repetition omits them, so that they do not bias the
/// other parameters.
/// @param each called before every run with its description, for progress
/// @throws std::runtime_error as run_calibration(); if there is no recording
RadarCalibration calibrate_radar(const std::vector<Recording>& recordings, const Options& options,
                                 const std::function<void(const std::string&)>& each = {});

}  // namespace rio::calibrate
