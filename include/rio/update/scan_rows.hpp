// SPDX-License-Identifier: BSD-3-Clause
// Stages 3 and 4: the observations of one scan become typed measurements and their rows, gated
// (chi-squared gating), with a record of every gate.
//
// Landmarks come first: the Doppler of a detection used with a landmark is not used again.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rio/core/static_vector.hpp"
#include "rio/frontend/frontend.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/gate.hpp"
#include "rio/update/gathered_covariance.hpp"
#include "rio/update/linearize.hpp"
#include "rio/update/look_correlation.hpp"
#include "rio/update/noise_inflation.hpp"
#include "rio/update/scan_measurements.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

class ScanRows {
 public:
  explicit ScanRows(const Options& options);

  /// The estimate starts over.
  void reset() {
    looks_.fill({});
    distance_at_scan_.fill(0.0);
    last_scan_.fill(std::nullopt);
  }

  /// Most rows of one update.
  static std::size_t capacity(const Options& options);

  /// Linearises and gates the observations at the predicted state; what follows is valid until the
  /// next call.
  void build(const Observations& seen, const StateEstimate& state_estimate, UpdateReport* report);

  /// The rows that passed the gate.
  const RowBatch& batch() const { return batch_; }
  /// Their measurements.
  const ScanMeasurements& measurements() const { return measurements_; }
  /// Those of other sensors, as indices in Observations::aiding.
  const StaticVector<std::size_t, kMaxAiding>& aiding() const { return used_aiding_; }

  /// The landmark was matched by the last scan, and the match keeps it alive.
  bool was_used(std::size_t landmark) const { return was_used_[landmark]; }
  /// The looks at a landmark that was used, the last scan included.
  const LandmarkState::Looks& looks(std::size_t landmark) const { return look_sums_[landmark]; }

 private:
  static constexpr double kSamePlace =
      0.5;  // travelled while still at one place, noise included [m]

  /// A scan with what its rows are made from.
  struct Scan {
    const Observations& seen;
    const StateEstimate& state_estimate;
    const LinearizationPoint& x;
    UpdateReport* report;
  };

  /// What the measurements of a scan share.
  void begin_scan(const Scan& scan);

  void add_rest(const Scan& scan);

  /// Expected correction of the radar's velocity by the static set of the scan [m/s].
  static Vector3d expected_correction(const EgoVelocity& measured, const LinearizationPoint& x,
                                      const Matrix3d& covariance);

  void add_doppler(const Scan& scan);

  /// Adds the noise of the gyro sample to the Doppler of a landmark: as if independent of that in
  /// the other Dopplers of the scan, of which few are of landmarks.
  static void add_gyro_noise(LandmarkDopplerModel::Measurement* z, const Vector3d& direction_S,
                             const LinearizationPoint& x);

  void add_trails(const Scan& scan);

  /// At rest only landmarks first measured at this place are used (kSamePlace): the error of an
  /// earlier one repeats from scan to scan while the position does not change. It is kept alive.
  void add_landmarks(const Scan& scan);

  /// Measurements of other sensors.
  void add_aiding(const std::vector<AidingObservation>& aiding, const StateEstimate& state_estimate,
                  UpdateReport* report);

  /// Opens a block with the rows of a measurement. False: outside the domain of its model.
  template <class M>
  bool add_block(const Measured<M>& m, const Scan& scan, BlockIndex index = {}) {
    const Layout& layout = scan.state_estimate.layout();
    batch_.begin_block();
    if (!linearize(models_.of<M>(), m.z, typename M::Blocks{}, scan.x, index, layout, &batch_)) {
      return false;
    }
    if constexpr (std::is_same_v<M, LandmarkPointModel>) {
      using Doppler = LandmarkDopplerModel;
      return !m.doppler || linearize(models_.of<Doppler>(), *m.doppler, Doppler::Blocks{}, scan.x,
                                     index, layout, &batch_);
    }
    return true;
  }

  /// Gates the match of a landmark with a detection; keeps it if it passes.
  template <class M>
  bool add_landmark(Measured<M> m, std::size_t detection, const Scan& scan);

  /// Corrects the range of the last block and of its measurement, and the innovation covariance in
  /// S_, by the terms of second order.
  void add_curvature(const StateEstimate& state_estimate, LandmarkPointModel::Measurement* z);

  /// Noise inflation of the directions of a match, rows 1 and 2 of the last block, and of its
  /// measurement (update/look_correlation.hpp). After the gate, as below.
  /// @param innovation of azimuth and elevation over their sigmas
  void add_look(const Eigen::Vector2d& innovation, Measured<LandmarkPointModel>* m,
                const LinearizationPoint& x);
  /// Innovations of azimuth and elevation over their sigmas, from the last block and S_.
  Eigen::Vector2d direction_innovation() const;

  /// Noise inflation of the Doppler of a match, the last row, and of its measurement. After the
  /// gate, which is that of right matches.
  void add_mismatch(Measured<LandmarkPointModel>* m, const LinearizationPoint& x);

  /// Keeps the measurement of the last block with its noise inflation.
  template <class M>
  void keep(Measured<M> m, double inflation) {
    batch_.scale_variance(inflation);  // after the gate: a single measurement has the original one
    m.weight = 1.0 / inflation;
    measurements_.add(m);
  }

  /// Noise inflation of a repetition of a measurement made at travelled distance `distance` [m].
  double repetition(double distance, const LinearizationPoint& x) const {
    return repetition_factor(std::max(0.0, x.estimate.distance_travelled - distance),
                             noise_distance_[x.estimate.radar]);
  }
  /// Same for a Doppler, whose quantisation error repeats until it has changed by a cell.
  double doppler_repetition(const Detection& d, const LinearizationPoint& x) const;

  /// Stage 4: gates and records the last block; if it does not pass, drops it and returns false.
  /// @param name of the model of another sensor
  bool decide(Model model, std::size_t detection, bool valid, UpdateReport* report,
              const char* name = nullptr) {
    if (valid) gathered_.innovation_covariance(batch_, batch_.last_block(), &S_);
    return judge(model, detection, valid, report, name);
  }
  /// Same, with the innovation covariance already in S_.
  bool judge(Model model, std::size_t detection, bool valid, UpdateReport* report,
             const char* name = nullptr);

  /// Infinite if the innovation covariance is not positive definite.
  double normalised_innovation_squared(const RowBlock& block);

  UpdateOptions options_;
  AblationOptions ablation_;
  AuxiliaryStates auxiliary_;
  double gravity_;
  // by radar
  std::array<double, kMaxRadars> noise_distance_{};    ///< [m]
  std::array<double, kMaxRadars> doppler_grid_{};      ///< [m/s]
  std::array<double, kMaxRadars> distance_at_scan_{};  ///< travelled at its last scan [m]
  double since_scan_ = 1.0;                            ///< time since its last scan, at most 1 [s]
  std::array<std::optional<Time>, kMaxRadars> last_scan_{};
  Gate gate_;
  RadarModels models_;
  RowBatch batch_;
  ScanMeasurements measurements_;
  StaticVector<std::size_t, kMaxAiding> used_aiding_;
  GatheredCovariance gathered_;
  GatheredCovariance::BlockMatrix S_;
  AidingRows aiding_;
  Matrix3d velocity_covariance_;              ///< of the radar as predicted, radar axes [m^2/s^2]
  Vector3d correction_S_ = Vector3d::Zero();  ///< of the radar's velocity [m/s]
  std::array<LookCorrelation, kMaxRadars> looks_{};
  std::array<LandmarkState::Looks, kMaxLandmarks> look_sums_{};  ///< after this scan
  std::array<bool, kMaxLandmarks> was_used_{};
  std::array<bool, kMaxDetections> measures_landmark_{};  ///< its Doppler is already used
};

}  // namespace rio
