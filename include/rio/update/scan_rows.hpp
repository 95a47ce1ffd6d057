// SPDX-License-Identifier: BSD-3-Clause
// Stages 4 and 5: the observations of one scan as gated rows, with a record of every gate
// (chi-squared gating).
//
// Landmarks come first: the Doppler of a detection used with a landmark is not used again.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "rio/frontend/frontend.hpp"
#include "rio/models/doppler.hpp"
#include "rio/models/landmark_distance.hpp"
#include "rio/models/landmark_point.hpp"
#include "rio/models/landmark_position.hpp"
#include "rio/models/rest.hpp"
#include "rio/models/trail_distance.hpp"
#include "rio/options.hpp"
#include "rio/report.hpp"
#include "rio/update/aiding.hpp"
#include "rio/update/gate.hpp"
#include "rio/update/gathered_covariance.hpp"
#include "rio/update/linearize.hpp"
#include "rio/update/noise_inflation.hpp"
#include "rio/update/reliability.hpp"
#include "rio/update/state_estimate.hpp"

namespace rio {

class ScanRows {
 public:
  explicit ScanRows(const Options& options);

  /// The estimate starts over.
  void reset() {
    distance_at_scan_.fill(0.0);
    last_scan_.fill(Time{0});
  }

  /// Most rows of one update.
  std::size_t capacity() const { return batch_.capacity(); }

  /// The rows that passed the gate; valid until the next call.
  const RowBatch& build(const Observations& seen, const StateEstimate& state_estimate,
                        UpdateReport* report);

  /// A measurement that passed the gate.
  struct Used {
    Model model = Model::kDoppler;
    std::size_t detection = 0;     ///< kAiding: index in Observations::aiding
    std::size_t target = 0;        ///< index of the landmark or of the trail
    ScanId past = 0;               ///< kTrailDistance: which element of the trail
    double variance_factor = 1.0;  ///< of its noise (update/noise_inflation.hpp)
  };
  const std::vector<Used>& used() const { return used_; }

  /// The landmark was matched by the last scan, and the match keeps it alive.
  bool was_used(std::size_t landmark) const { return was_used_[landmark]; }

 private:
  static constexpr double kHere = 0.5;  // travelled while still at one place, noise included [m]

  void add_scan(const Observations& seen, const StateEstimate& state_estimate,
                UpdateReport* report);

  void add_rest(const RestModel::Measurement& z, const StateEstimate& state_estimate,
                const LinearizationPoint& x, UpdateReport* report);

  void add_doppler(const Observations& seen, const StateEstimate& state_estimate,
                   const LinearizationPoint& x, UpdateReport* report);

  bool tells_doppler(const Observations& seen, std::size_t i) const {
    return seen.is_static(i) && !measures_landmark_[i];
  }

  void add_trails(const Observations& seen, const StateEstimate& state_estimate,
                  const LinearizationPoint& x, UpdateReport* report);

  /// At rest only landmarks first measured at this place are used (kHere): the error of an earlier
  /// one repeats from scan to scan while the position does not change. It is kept alive.
  void add_landmarks(const Observations& seen, const StateEstimate& state_estimate,
                     const LinearizationPoint& x, UpdateReport* report);

  /// Measurements of other sensors.
  void add_aiding(const std::vector<AidingObservation>& aiding, const StateEstimate& state_estimate,
                  UpdateReport* report);

  /// Position and, unless switched off, Doppler of one detection: one block, gated together.
  bool add_point(const Detection& d, const StateEstimate& state_estimate,
                 const LinearizationPoint& x, BlockIndex index);

  template <MeasurementModel M>
  bool add(const M& model, const typename M::Measurement& z, const StateEstimate& state_estimate,
           const LinearizationPoint& x, BlockIndex index) {
    return linearize(model, z, typename M::Blocks{}, x, index, state_estimate.layout(), &batch_);
  }

  /// Noise inflation of a repetition of a measurement made at travelled distance `distance` [m].
  double repetition(double distance, const LinearizationPoint& x) const {
    return repetition_factor(std::max(0.0, x.estimate.distance_travelled - distance),
                             noise_distance_[x.estimate.radar]);
  }
  /// Same for a Doppler, whose quantisation error repeats until it has changed by a cell.
  double doppler_repetition(const Detection& d, const LinearizationPoint& x) const;
  /// Noise inflation: multiplies the variance of the last block and returns the factor. Applied
  /// after the gate, because a single measurement has the original variance.
  double weigh(double factor);

  /// Stage 5: gates and records the last block; if it does not pass, drops it and returns false.
  /// @param name of the model of another sensor
  bool decide(Model model, std::size_t detection, bool valid, UpdateReport* report,
              const char* name = nullptr);
  /// Same, with the innovation covariance already in S_.
  bool judge(Model model, std::size_t detection, bool valid, UpdateReport* report,
             const char* name = nullptr);

  /// Infinite if the innovation covariance is not positive definite.
  double normalised_innovation_squared(const RowBlock& block);

  UpdateOptions options_;
  AuxiliaryStates auxiliary_;
  double gravity_;
  // by radar
  std::array<double, kMaxRadars> noise_distance_{};    ///< [m]
  std::array<double, kMaxRadars> doppler_grid_{};      ///< [m/s]
  std::array<double, kMaxRadars> distance_at_scan_{};  ///< travelled at its last scan [m]
  double since_scan_ = 1.0;                            ///< time since its last scan, at most 1 [s]
  std::array<Time, kMaxRadars> last_scan_{};
  Gate gate_;
  DopplerModel doppler_;
  TrailDistanceModel trail_;
  LandmarkDistanceModel landmark_;
  LandmarkPositionModel position_;
  LandmarkPointModel point_;
  LandmarkDopplerModel landmark_doppler_;
  RowBatch batch_;
  std::vector<Used> used_;
  std::vector<DopplerModel::Measurement> dopplers_;
  GatheredCovariance gathered_;
  GatheredCovariance::BlockMatrix S_;
  AidingRows aiding_;
  std::array<bool, kMaxLandmarks> was_used_{};
  std::array<bool, kMaxDetections> measures_landmark_{};  ///< its Doppler is already used
};

}  // namespace rio
