// SPDX-License-Identifier: BSD-3-Clause
// Every tunable of the estimator, nested by stage, with its default. SI units throughout (angles in
// radians); the file reader also takes values such as "2 deg". Nothing derived is stored here.
// Files and command lines have those of visit_fields() in option_fields.hpp, which a user may know
// better than the preset; those of visit_preset_fields() belong to the presets. C++17.
#pragma once

#include <optional>
#include <string>

#include "rio/export.hpp"
#include "rio/state/auxiliary.hpp"
#include "rio/types.hpp"

namespace rio {

/// Stage 1: the inertial sensor and its environment.
struct ImuOptions {
  double gyro_noise_density = 4e-4;   ///< white noise [rad/s/sqrt(Hz)]
  double gyro_random_walk = 2e-5;     ///< bias random walk [rad/s^2/sqrt(Hz)]
  double accel_noise_density = 4e-3;  ///< white noise [m/s^2/sqrt(Hz)]
  double accel_random_walk = 2e-4;    ///< bias random walk [m/s^3/sqrt(Hz)]
  /// Jitter of the stamps; it acts as noise in proportion to the change between samples.
  /// Milliseconds over USB, 0 = stamped by hardware [s].
  double stamp_sigma = 0.5e-3;
  double max_rate = 34.5;    ///< a larger reading is saturated: 2000 deg/s [rad/s]
  double max_accel = 156.0;  ///< same, specific force: 16 g [m/s^2]
  /// Use the vibration, aliasing and loss seen in the samples if they exceed the configured white
  /// noise (propagate/imu_noise_meter.hpp).
  bool measure_noise = true;
  double gravity = 9.81;         ///< along -z of W [m/s^2]
  double max_gap = 0.1;          ///< a longer pause between samples is a gap [s]
  double gap_rate_sigma = 0.5;   ///< unknown mean angular rate inside a gap [rad/s]
  double gap_accel_sigma = 2.0;  ///< unknown mean acceleration inside a gap [m/s^2]
};

/// The radar: mounting, field of view, noise.
struct RadarOptions {
  Pose T_BS{};                     ///< pose of the radar in the body frame [m]
  double min_range = 0.2;          ///< nearer detections are dropped [m]
  double max_range = 50.0;         ///< farther detections are dropped [m]
  double min_snr_db = 0.0;         ///< weaker detections are dropped [dB]
  double fov_azimuth = 3.14159;    ///< full width of the field of view used [rad]
  double fov_elevation = 3.14159;  ///< full height of the field of view used [rad]
  double sigma_range = 0.03;       ///< [m]
  /// At boresight [rad]. A beam of 15 deg at 15 dB resolves about a degree, which is what a real
  /// IWR6843AOP shows; elevation has half the antennas.
  double sigma_azimuth = 0.02;
  double sigma_elevation = 0.04;
  /// An echo of this strength, the detection threshold, has twice the angle variance of a strong
  /// one: the noise of a phase falls with the SNR. -200 = all are alike [dB].
  double weak_snr_db = 10.0;
  /// The angle sigmas grow off boresight as 1/cos, as those of an array; else they are the same in
  /// all directions (Xu et al., eq. 4).
  bool angle_growth = true;
  double sigma_doppler = 0.03;      ///< without quantisation [m/s]
  double range_resolution = 0.0;    ///< grid of the range, adds grid^2/12; 0 = none [m]
  double doppler_resolution = 0.0;  ///< grid of the Doppler, adds grid^2/12; 0 = none [m/s]
  /// Range rates fold into +-this, as the radar reports it even if its Doppler scale is wrong;
  /// 0 = they do not fold [m/s].
  double max_doppler = 0.0;
  /// E-folding distance of the errors of a point: echoes of width w at range r keep their phases
  /// until the radar has moved by about half a wavelength times r / w; 0 = new in every scan [m].
  double noise_distance = 0.02;
  /// Known errors of the radar; the calibration estimates corrections to them.
  double time_offset = 0.0;    ///< stamps are late by this [s]
  double doppler_scale = 0.0;  ///< range rates are too large by this share
};

/// When a detection matches a landmark or trail.
enum class Matching {
  kEuclidean,    ///< Michalczyk et al.: closer than a constant distance
  kProbability,  ///< Xu et al.: by the density of the detection's own noise at the known point
  kMahalanobis,  ///< closer than both uncertainties allow, and nothing else is nearly as close
};

/// Stages 2 and 6: detections to observations.
struct FrontendOptions {
  int max_detections = 128;        ///< per scan, 1024 at most; of more, the strongest are kept
  double ransac_threshold = 0.15;  ///< |Doppler residual| of an inlier is below this [m/s] or ...
  double ransac_sigmas = 3.0;      ///< ... this many sigmas, direction error included; 0 = off
  bool ransac_use_prediction = true;  ///< the velocity predicted by the IMU is one more hypothesis
  /// A sum of Doppler residuals along a trail above this many sigmas marks a slow mover; 0 = off.
  double mover_sigmas = 3.0;
  /// Points this near to an outlier may belong to the same body: half of a person [m]; 0 = off.
  double mover_extent = 0.8;
  bool own_echoes = true;  ///< reject echoes of the vehicle itself, which have no Doppler
  double ransac_outlier_ratio = 0.4;  ///< share of outliers that sizes the iteration count
  int ransac_seed = 1;                ///< of the deterministic generator
  bool unwrap_doppler = true;         ///< undo the folding at radar.max_doppler
  bool detect_rest = true;            ///< standstill on the ground measures velocity and gyro bias
  Matching matching = Matching::kMahalanobis;
  double match_gate = 0.3;          ///< kEuclidean: largest distance of a match [m]
  double match_probability = 0.95;  ///< other matchings: of a right pair to pass the gate
  /// kMahalanobis: probability of a right pair to count as a match once the radar has moved by half
  /// of noise_distance.
  double match_core = 0.6;
  double match_margin = 2.0;  ///< kMahalanobis: factor by which a landmark's match must be the best
  int promote_after = 6;      ///< consecutive matches that make a trail a landmark
  /// A landmark not seen for longer is dropped; 0 = at its first miss [s].
  double landmark_timeout = 20.0;
};

/// The measurement of a match with a landmark.
enum class LandmarkMeasurement {
  kDistance,  ///< Michalczyk et al.: the range, with a constant sigma
  kPosition,  ///< Xu et al.: its position, with the noise of the detection; Doppler separately
  kPoint,     ///< range and direction with the noise of the detection, Doppler along the landmark
};

/// How the Doppler model treats the measured directions of its points; each value includes those
/// before it (models/doppler.hpp).
enum class DopplerDirections {
  kExact,      ///< Michalczyk et al.: without error
  kNoisy,      ///< Xu et al.: their error is added to the variance
  kCorrected,  ///< errors in variables: the expected direction given the innovation
};

/// Stages 3 to 5: measurement models, gates, update.
struct UpdateOptions {
  bool use_doppler = true;
  /// The least-squares velocity of the static set as one measurement (Doer and Trommer 2020).
  bool use_ego_velocity = false;
  bool use_trails = false;  ///< distances to past detections; trails become landmarks in any case
  bool use_landmarks = true;
  DopplerDirections doppler_directions = DopplerDirections::kCorrected;
  bool consistent_covariance = true;  ///< re-express P so that yaw and position stay unobservable
  /// Rows independent [m]. The residuals have a spread of some 0.08 m, and each detection enters up
  /// to N = 7 updates: to count it once takes sqrt(7) times that.
  double sigma_trail_distance = 0.2;
  LandmarkMeasurement landmark_measurement = LandmarkMeasurement::kPoint;
  double sigma_landmark_distance = 0.2;  ///< for kDistance; same reason: it was a trail [m]
  /// Probability that a match with a landmark is right: where reflectors are closer than the
  /// angular resolution, about a third are wrong. 1 = all are right (update/noise_inflation.hpp).
  double match_trust = 0.68;
  /// Random walk of a landmark with the distance travelled: the scattering centre moves with the
  /// aspect. Recordings are best with 0.03 to 0.05, simulated point reflectors with 0.01
  /// [m/sqrt(m)].
  double landmark_walk = 0.02;
  double gate_probability = 0.99;  ///< of passing the one-sided chi-squared gate; 1 = no gate
  int max_clones = 3;              ///< past poses kept (N), of each radar
  int max_landmarks = 40;          ///< persistent landmarks kept
};

/// Weight of a residual that fits badly; x is its chi-squared over its degrees of freedom.
enum class Kernel {
  kNone,
  kHuber,   ///< weight sqrt(k / x) beyond k
  kCauchy,  ///< weight 1 / (1 + x / k)
  kDcs,     ///< dynamic covariance scaling: weight (2 k / (k + x))^2 beyond k
};

/// Back-end 2: the sliding window.
struct SmootherOptions {
  int window = 10;         ///< states kept (N)
  int max_iterations = 5;  ///< of Gauss-Newton, per scan
  double tolerance = 0.1;  ///< length of a step that counts as converged, in sigmas
  Kernel kernel = Kernel::kNone;
  double kernel_size = 4.0;           ///< k, in chi-squared per degree of freedom
  double landmark_kernel_size = 0.0;  ///< same, of landmarks; 0 = kernel_size
  double trail_kernel_size = 0.0;     ///< same, of trails; 0 = kernel_size
  /// A landmark that is no longer matched stays while states of the window have measured it, and is
  /// marginalised with the last of them; else it leaves with all its factors.
  bool keep_landmark_factors = true;
  /// A step shorter than this share of the step before reuses its factorisation (simplified Newton
  /// method). 0: each step has its own, and the covariance is that of the solution.
  double factor_reuse = 0.3;
};

/// Which estimator corrects the state.
enum class BackEnd {
  kEkf,       ///< multi-state extended Kalman filter
  kSmoother,  ///< sliding-window factor graph
};

/// Which calibration parameters of the radar are estimated: one-sigma priors, 0 = not estimated. An
/// estimate is limited to kCalibrationLimit sigmas from the value of the option.
struct CalibrationOptions {
  /// Of T_BS, per axis, pi at most. Above 1 rad the mounting is unknown: it is found in the first
  /// seconds of motion, before the radar is used (frontend/mounting_search.hpp) [rad].
  double rotation_sigma = 0.05;
  double translation_sigma = 0.03;  ///< of T_BS, per axis [m]
  /// Stamps are late by this: a stamp on arrival instead of the middle of the chirps [s].
  double time_offset_sigma = 0.03;
  /// Relative: some firmware scales by the start frequency of the chirp, 2.8 % too large.
  double doppler_scale_sigma = 0.02;
  /// Random walk of each that is estimated, in its default sigma above: a rotation drifts by 0.09
  /// deg in a minute, with temperature, load and the directions of the reflectors [1/sqrt(s)].
  double walk = 0.004;
  /// Of an error common to the elevations of all landmarks of a radar: with one and the same
  /// mounting the vertical direction of the Dopplers scatters by 1.4 to 2.2 deg from drive to
  /// drive. Considered, not estimated (StateEstimate::consider); 0 = none [rad].
  double elevation_sigma = 0.035;
};

/// In sigmas of the prior.
inline constexpr double kCalibrationLimit = 5.0;
/// In sigmas of the prior: an estimate beyond this is doubtful (Observability in report.hpp).
inline constexpr double kCalibrationDoubt = 3.0;
/// A landmark missed for less than this is still in view: the weakest echoes are missed that long
/// [s].
inline constexpr double kLandmarkInView = 8.0;

/// Initialisation.
struct StartOptions {
  bool static_alignment = true;  ///< align while standing; false = wait for reset(prior, P0)
  double duration = 1.5;         ///< length of the averaged standstill [s]
  double max_wait = 0.0;         ///< wait for a standstill, then start in motion; 0 = no limit [s]
  double max_rate = 0.1;         ///< standstill: largest mean rate that can be a bias [rad/s]
  double sigma_position = 0.01;  ///< per axis [m]
  double sigma_yaw = 0.01;       ///< [rad]
  double sigma_tilt = 0.01;      ///< roll and pitch of a given start [rad]
  double sigma_velocity = 0.05;  ///< per axis [m/s]
  double sigma_gyro_bias = 0.005;  ///< per axis, when there was no standstill [rad/s]
  double sigma_accel_bias = 0.05;  ///< per axis [m/s^2]
};

/// Which checks may replace a part of the estimate (checks/checks.hpp). The presets set them.
struct CheckOptions {
  bool landmarks = true;  ///< drop them after silence and gaps, and while the tilt is uncertain
  bool velocity = true;   ///< replace it if the Dopplers of a second contradict it
  bool tilt = true;       ///< replace it if the Dopplers of two seconds contradict gravity
  bool heading = true;    ///< widen it if the gyro bias has stepped about the vertical
  bool biases = true;     ///< widen them if the velocity drifts
  bool position = true;   ///< widen it after a doubtful time
  bool lost_tilt = true;  ///< restart from the specific force when the tilt is lost
};

/// Parts of the algorithm that no option file switches off: for the ablation experiment and for
/// measuring the noise of a radar.
struct AblationOptions {
  bool steady_motion = true;      ///< propagate/steady_motion.hpp
  bool shared_gyro_noise = true;  ///< in the Dopplers of a scan
  bool direction_noise = true;    ///< frontend/direction_noise.hpp
  bool look_correlation = true;   ///< update/look_correlation.hpp
  bool elevation_walk = true;     ///< (E3) of it
  bool range_curvature = true;    ///< terms of second order in the range of a landmark
  bool mismatch_doppler = true;   ///< (E4) of update/noise_inflation.hpp
};

/// Queues between the sensors and the estimator.
struct TimingOptions {
  int imu_buffer = 2048;  ///< IMU samples kept between the estimate and now
  int scan_queue = 8;     ///< scans that may wait for the IMU
  double max_lag = 1.0;   ///< the estimate follows the IMU this far behind at most [s]
  /// A scan stamped farther ahead of the newest IMU sample than this is not waited for [s].
  double max_ahead = 1.0;
  /// With several radars: how long a scan is held back for an earlier one of another radar [s].
  double scan_wait = 0.1;
  /// A longer pause of the IMU is a jump of its clock (checks/stamp_guard.hpp). The default is
  /// longer than sensors stay silent in flight, shorter than the step to another time zone [s].
  double max_pause = 600.0;
  /// How long after the estimate has passed its time an aiding measurement may arrive: IMU samples
  /// are kept for that long [s].
  double aiding_delay = 0.0;
  /// For profiling only: if given, the time spent is reported in UpdateReport. Not a file option.
  Time (*clock)() = nullptr;
};

/// A further radar.
struct RadarMount {
  Pose T_BS;                   ///< pose of the radar in the body frame
  double time_offset = 0.0;    ///< as RadarOptions::time_offset [s]
  double doppler_scale = 0.0;  ///< as RadarOptions::doppler_scale
  /// Noise, limits and field of view if they differ from Options::radar. Its T_BS, time_offset and
  /// doppler_scale are ignored in favour of the ones above.
  std::optional<RadarOptions> kind{};
};

/// All options. Obtain them from a preset, change fields, pass them to Odometry::create.
struct Options {
  BackEnd backend = BackEnd::kEkf;
  ImuOptions imu;
  RadarOptions radar;
  FrontendOptions frontend;
  UpdateOptions update;
  CalibrationOptions calibration;
  SmootherOptions smoother;
  StartOptions start;
  TimingOptions timing;
  CheckOptions checks;
  AblationOptions ablation;
  /// The second, third and fourth radar (Odometry::add_scan). Not a file option: datasets have
  /// `radar1`, ... instead.
  static constexpr std::size_t kMaxOtherRadars = 3;
  StaticVector<RadarMount, kMaxOtherRadars> other_radars;
  /// Additional states of extensions (rio/aiding.hpp). Not a file option.
  AuxiliaryStates auxiliary;

  std::size_t radars() const { return 1 + other_radars.size(); }
  /// Of radar 0, 1, ...
  RadarMount mount(std::size_t r) const {
    if (r > 0) return other_radars[r - 1];
    return {radar.T_BS, radar.time_offset, radar.doppler_scale, {}};
  }
  /// Radar 0, 1, ... as if it were the only one.
  RadarOptions radar_of(std::size_t r) const {
    const RadarMount own = mount(r);
    RadarOptions out = own.kind.value_or(radar);
    out.T_BS = own.T_BS;
    out.time_offset = own.time_offset;
    out.doppler_scale = own.doppler_scale;
    return out;
  }
  /// The options of a stage that sees radar r alone: `radar` is that one.
  Options seen_by(std::size_t r) const {
    Options out = *this;
    out.radar = radar_of(r);
    return out;
  }

  /// True when every value is inside its range (option_fields.hpp) and the set is coherent;
  /// otherwise false and, if `why` is given, one sentence naming the first offending key.
  RIO_API bool validate(std::string* why = nullptr) const;
};

/// The names of the presets.
inline constexpr const char* kPresets[] = {"default", "published-ekf", "published-smoother",
                                           "published-uncertainty", "doppler-only"};
/// The options named `name`; false and unchanged if there is no such preset.
RIO_API bool preset(const std::string& name, Options* options);

}  // namespace rio
