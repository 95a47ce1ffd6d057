// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/radar_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "rio/state/calibration.hpp"

namespace rio::calibrate {

namespace {

constexpr double kLoose = 3.0;  // of the configured prior sigmas
constexpr auto kRotation = static_cast<std::size_t>(Calibration::kRotationX);
constexpr auto kTranslation = static_cast<std::size_t>(Calibration::kTranslationX);
constexpr auto kDopplerScale = static_cast<std::size_t>(Calibration::kDopplerScale);
constexpr auto kTimeOffset = static_cast<std::size_t>(Calibration::kTimeOffset);

using Progress = std::function<void(const std::string&)>;

/// The radar as configured, with the corrections.
RadarOptions moved(const Options& configured, const CalibrationVector& corrections) {
  const RadarState to = corrected(configured_state(configured.mount(0)), corrections);
  RadarOptions radar = configured.radar;
  radar.T_BS = to.T_BS;
  radar.doppler_scale = to.doppler_scale;
  radar.time_offset = to.time_offset;
  return radar;
}

/// Information of a run without its prior (E1).
Measured without_prior(const CalibrationReport& report) {
  constexpr double kSilent = 0.2;     // of the prior's information: no information
  constexpr double kNothing = 100.0;  // prior sigmas: negligible weight
  const double p = report.prior_sigma;
  const double after = 1.0 / (report.sigma * report.sigma);
  const double information = after - 1.0 / (p * p);
  if (!(information > kSilent / (p * p))) return {report.value, kNothing * p};
  return {report.value * after / information, 1.0 / std::sqrt(information)};
}

/// A run about the calibration `radar`, which is `centre` off the configured values, relative to
/// these.
MeasuredCalibration off_configured(const CalibrationRun& run, const RadarOptions& radar,
                                   const CalibrationVector& centre) {
  MeasuredCalibration out{};
  const Vector3d turn = unshown_turn(run.states, radar.T_BS.rotation.conjugate());
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    if (run.calibration[i].observability == Observability::kNotEstimated) continue;
    out[i] = without_prior(run.calibration[i]);
    const auto k = static_cast<Eigen::Index>(i);
    out[i].value += centre[k];
    if (k < 3) out[i].sigma = std::hypot(out[i].sigma, std::sqrt(turn[k]));
  }
  return out;
}

/// For the second half.
Start reopened(Start start) {
  constexpr double kVelocity = 0.5;  // far above the error of any working run [m/s]
  constexpr double kTilt = 0.035;    // of a mounting with an error of some degrees [rad]
  start.covariance.diagonal().segment<3>(body::kVelocity).array() += kVelocity * kVelocity;
  start.covariance.diagonal().segment<3>(body::kAttitude).array() += kTilt * kTilt;
  return start;
}

/// Parameter i of every recording.
std::vector<Measured> all(const std::vector<RecordingCalibration>& runs, std::size_t i,
                          MeasuredCalibration RecordingCalibration::*which) {
  std::vector<Measured> out;
  for (const RecordingCalibration& run : runs) out.push_back((run.*which)[i]);
  return out;
}

/// From loose priors.
Options repetition_options(Options options) {
  CalibrationOptions& c = options.calibration;
  c.rotation_sigma = std::min(1.0, kLoose * c.rotation_sigma);
  c.translation_sigma = std::min(10.0, kLoose * c.translation_sigma);
  c.time_offset_sigma = std::min(0.1, kLoose * c.time_offset_sigma);
  c.doppler_scale_sigma = std::min(0.1, kLoose * c.doppler_scale_sigma);
  c.walk = 0.0;  // the halves say how constant they are
  return options;
}

/// All recordings, about the calibration of `options`; the results are relative to `configured`.
std::vector<RecordingCalibration> pass(const std::vector<Recording>& recordings,
                                       const Options& configured, const Options& options,
                                       bool with_halves, const Progress& each) {
  const CalibrationVector centre = corrections_between(configured_state(configured.mount(0)),
                                                       configured_state(options.mount(0)));
  std::vector<RecordingCalibration> out;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const auto run = [&](const char* part, const std::optional<Start>& start, Time end) {
      if (each) each("recording " + std::to_string(i + 1) + ": " + part);
      return run_calibration(recordings[i], options, start, end);
    };
    const std::optional<Start>& start = recordings[i].start;
    RecordingCalibration result;
    const CalibrationRun whole = run(with_halves ? "second pass" : "first pass", start, kToTheEnd);
    result.whole = off_configured(whole, options.radar, centre);
    result.velocity_resets = whole.velocity_resets;
    result.begin = whole.states.front();
    result.began_in_motion = whole.began_in_motion;
    result.middle = reopened(half_way(whole.states));
    if (with_halves) {
      const CalibrationRun first = run("first half", start, result.middle.state.time);
      result.first = off_configured(first, options.radar, centre);
      const CalibrationRun second = run("second half", result.middle, kToTheEnd);
      result.second = off_configured(second, options.radar, centre);
    }
    out.push_back(result);
  }
  return out;
}

/// Of the whole runs; parameters without information keep the configured value.
CalibrationVector mean(const std::vector<RecordingCalibration>& runs,
                       const CalibrationOptions& priors) {
  constexpr double kInformed = 0.5;  // of the prior sigma
  const CalibrationVector loose = calibration_sigmas(priors);
  CalibrationVector values = CalibrationVector::Zero();
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    if (!(runs.front().whole[i].sigma > 0.0)) continue;
    const Combined whole = combine(all(runs, i, &RecordingCalibration::whole));
    const auto k = static_cast<Eigen::Index>(i);
    if (whole.sigma < kInformed * loose[k]) values[k] = whole.value;
  }
  return values;
}

/// Two passes over all recordings.
std::vector<RecordingCalibration> repetition(const std::vector<Recording>& recordings,
                                             const Options& configured, const Progress& each) {
  Options options = repetition_options(configured);
  const auto first = pass(recordings, configured, options, false, each);
  options.radar = moved(configured, mean(first, options.calibration));
  return pass(recordings, configured, options, true, each);
}

/// (E2) of one parameter.
struct Summary {
  Combined whole;
  Combined halves;
  double squares = 0.0;  ///< of the halves' (E3), over the recordings

  /// (E5)
  double spread(double others) const {
    constexpr double kWeight = 4.0;  // n
    const auto shrunk = [&](const Combined& c) {
      return (c.chi2 + kWeight * others * others) / (c.dof + kWeight);
    };
    return std::sqrt(std::max(shrunk(halves), shrunk(whole)));
  }
};

/// @param p gets (E2) (E3) of parameter i
Summary summarise(const std::vector<RecordingCalibration>& runs, std::size_t i,
                  ParameterCalibration* p) {
  Summary out;
  out.whole = combine(all(runs, i, &RecordingCalibration::whole));
  *p = {.value = out.whole.value, .run_sigma = out.whole.sigma};
  std::vector<Measured> halves = all(runs, i, &RecordingCalibration::first);
  for (const RecordingCalibration& run : runs) {
    halves.push_back(run.second[i]);
    const double a = apart(run.first[i], run.second[i]);
    out.squares += a * a;
    p->halves_apart = std::max(p->halves_apart, a);
    for (const RecordingCalibration& other : runs) {
      p->recordings_apart = std::max(p->recordings_apart, apart(run.whole[i], other.whole[i]));
    }
  }
  out.halves = combine(halves);
  return out;
}

Determination judge(const ParameterCalibration& p, double others) {
  constexpr double kMostOfPrior = 0.5;  // a sigma above this share of its prior is no determination
  if (std::max(p.halves_apart, p.recordings_apart) > kFarApart * others) {
    return Determination::kContradictory;
  }
  if (!(p.sigma <= kMostOfPrior * p.prior)) return Determination::kNotDetermined;
  return Determination::kDetermined;
}

/// (E4) for a parameter with the sum of squares `own`; all together have `squares` over `count`
/// pairs, `pairs` per parameter.
double spread_of_others(double squares, double own, std::size_t count, std::size_t pairs) {
  if (count <= pairs) return 1.0;
  return std::sqrt(std::max(1.0, (squares - own) / static_cast<double>(count - pairs)));
}

/// (E6) (E7); parameters that were not estimated are unchanged.
void judge_all(const std::vector<RecordingCalibration>& runs, const CalibrationVector& priors,
               RadarCalibration* out) {
  std::array<Summary, kCalibrationCount> summaries{};
  double squares = 0.0;
  std::size_t count = 0;
  const auto estimated = [&runs](std::size_t i) { return runs.front().whole[i].sigma > 0.0; };
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    if (!estimated(i)) continue;
    summaries[i] = summarise(runs, i, &out->parameters[i]);
    squares += summaries[i].squares;
    count += runs.size();
  }
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    if (!estimated(i)) continue;
    const Summary& s = summaries[i];
    const double others = spread_of_others(squares, s.squares, count, runs.size());
    ParameterCalibration& p = out->parameters[i];
    p.prior = priors[static_cast<Eigen::Index>(i)];
    p.spread = s.spread(others);
    p.sigma = std::hypot(s.whole.sigma * std::max(1.0, p.spread), s.whole.value - s.halves.value,
                         kCommonError[i]);
    const bool spared = i == kDopplerScale || i == kTimeOffset;
    p.verdict = judge(p, spared ? 1.0 : others);
  }
}

bool determined(const RadarCalibration& c, std::size_t i) {
  return c.parameters[i].verdict == Determination::kDetermined;
}

/// The common prior of `count` parameters.
double tightened(const RadarCalibration& c, std::size_t first, std::size_t count,
                 double configured) {
  double largest = 0.0;
  for (std::size_t i = first; i < first + count; ++i) {
    if (!determined(c, i)) return configured;
    largest = std::max(largest, c.parameters[i].sigma);
  }
  return std::min(configured, largest);
}

/// The result from the verdicts.
void fill_result(const Options& configured, RadarCalibration* out) {
  CalibrationVector values = CalibrationVector::Zero();
  for (std::size_t i = 0; i < kCalibrationCount; ++i) {
    if (determined(*out, i)) values[static_cast<Eigen::Index>(i)] = out->parameters[i].value;
  }
  out->radar = moved(configured, values);
  CalibrationOptions& c = out->priors;
  c = configured.calibration;
  c.rotation_sigma = tightened(*out, kRotation, 3, c.rotation_sigma);
  c.translation_sigma = tightened(*out, kTranslation, 3, c.translation_sigma);
  c.doppler_scale_sigma = tightened(*out, kDopplerScale, 1, c.doppler_scale_sigma);
  c.time_offset_sigma = tightened(*out, kTimeOffset, 1, c.time_offset_sigma);
}

}  // namespace

const char* to_string(Determination verdict) {
  constexpr std::array kNames = {"not estimated", "determined", "not determined", "contradictory"};
  return kNames[static_cast<std::size_t>(verdict)];
}

RadarCalibration calibrate_radar(const std::vector<Recording>& recordings, const Options& options,
                                 const Progress& each) {
  if (recordings.empty()) throw std::runtime_error("no recording");
  RadarCalibration out;
  const CalibrationVector priors = calibration_sigmas(options.calibration);
  out.recordings = repetition(recordings, options, each);
  judge_all(out.recordings, priors, &out);
  Options again = options;
  const auto leave_out = [&](std::size_t i, double* sigma) {
    if (*sigma > 0.0 && !determined(out, i)) *sigma = 0.0;
    return *sigma == 0.0 && priors[static_cast<Eigen::Index>(i)] > 0.0;
  };
  const bool no_scale = leave_out(kDopplerScale, &again.calibration.doppler_scale_sigma);
  const bool no_offset = leave_out(kTimeOffset, &again.calibration.time_offset_sigma);
  if (no_scale || no_offset) {
    out.recordings = repetition(recordings, again, each);
    judge_all(out.recordings, priors, &out);
  }
  fill_result(options, &out);
  return out;
}

}  // namespace rio::calibrate
