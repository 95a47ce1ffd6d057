// SPDX-License-Identifier: BSD-3-Clause
#include "experiment/witness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "experiment/pipeline_drive.hpp"
#include "experiment/signature.hpp"
#include "rio/sim/radar_model.hpp"

namespace rio::experiment {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double ratio(double part, double whole) {
  return whole > 0.0 ? part / whole : kNaN;
}

bool of_landmark(const InnovationRecord& r) {
  return r.model == Model::kLandmarkDistance || r.model == Model::kLandmarkPoint ||
         r.model == Model::kLandmarkPosition;
}

/// Sums over the scans of the motion.
class Sums {
 public:
  /// @param scan output of the filter
  void add(const UpdateReport& report, const DetectionList& scan) {
    ++result_.scans;
    result_.consensus += report.ego_velocity_valid ? 1.0 : 0.0;
    kept_ += report.detections_kept;
    inliers_ += report.static_detections;
    result_.velocity_resets += report.velocity_reset ? 1 : 0;
    double sum = 0.0;
    int count = 0;
    seen_.clear();
    for (const InnovationRecord& r : report.records) {
      if (r.model != Model::kDoppler) continue;
      result_.doppler.add(r);
      if (r.result != GateResult::kUsed) continue;
      squares_ += r.innovation * r.innovation;
      sum += r.innovation / r.sigma;
      ++count;
      seen_.push_back({&scan.items[r.detection], r.innovation / r.sigma});
    }
    if (count > 0) correlate(sum / count);
    compare_neighbours();
  }

  Testimony result() {
    result_.inlier_share = ratio(inliers_, kept_);
    result_.consensus = ratio(result_.consensus, result_.scans);
    result_.doppler_rms = std::sqrt(ratio(squares_, result_.doppler.used));
    result_.doppler_lag = ratio(products_, means_);
    result_.neighbours = ratio(shared_ / pairs_, normalised_ / result_.doppler.used);
    return result_;
  }

 private:
  /// (E1)
  void correlate(double mean) {
    products_ += mean * last_mean_;
    means_ += mean * mean;
    last_mean_ = mean;
  }

  /// (E2)
  void compare_neighbours() {
    const double cosine = std::cos(4.0 * sim::kDegree);
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const Detection& a = *seen_[i].detection;
      normalised_ += seen_[i].innovation * seen_[i].innovation;
      for (std::size_t k = 0; k < i; ++k) {
        const Detection& b = *seen_[k].detection;
        if (a.direction_S.dot(b.direction_S) < cosine || std::abs(a.range - b.range) > 1.0)
          continue;
        shared_ += seen_[i].innovation * seen_[k].innovation;
        pairs_ += 1.0;
      }
    }
  }

  struct Seen {
    const Detection* detection;
    double innovation;  ///< in sigmas
  };

  Testimony result_;
  std::vector<Seen> seen_;  ///< Dopplers of the current scan
  double shared_ = 0.0;
  double pairs_ = 0.0;
  double normalised_ = 0.0;
  double kept_ = 0.0;
  double inliers_ = 0.0;
  double squares_ = 0.0;
  double products_ = 0.0;
  double means_ = 0.0;
  double last_mean_ = 0.0;
};

}  // namespace

void Innovations::add(const InnovationRecord& record) {
  if (record.result == GateResult::kGated) ++gated;
  if (record.result != GateResult::kUsed) return;
  ++used;
  nis += record.nis;
  dof += record.dof;
}
double Innovations::mean_nis() const {
  return ratio(nis, dof);
}
double Innovations::gated_share() const {
  return ratio(gated, used + gated);
}

Status Witness::update(const Observations& seen, UpdateReport* report) {
  constexpr Time kPause = std::chrono::seconds(1);
  follow();
  std::vector<bool> after_pause(seen.scan->items.size(), false);
  for (const Match& m : seen.matches.landmarks) {
    after_pause[m.detection] =
        estimate().nav.time - estimate().landmarks[m.target].last_seen > kPause;
  }
  const Status status = Ekf::update(seen, report);
  for (const InnovationRecord& r : report->records) {
    if (!listening_ || !of_landmark(r)) continue;
    landmarks_.add(r);
    if (after_pause[r.detection]) found_again_.add(r);
  }
  for (std::size_t i = 0; i < known_.size(); ++i) known_[i].p_W = estimate().landmarks[i].p_W;
  return status;
}

void Witness::maintain_landmarks(const Observations& seen, const Promotions& promotions,
                                 UpdateReport* report) {
  Ekf::maintain_landmarks(seen, promotions, report);
  follow();
}

void Witness::follow() {
  std::vector<Known> now;
  for (const LandmarkState& landmark : estimate().landmarks) {
    const auto old = std::find_if(known_.begin(), known_.end(),
                                  [&](const Known& k) { return k.p_W == landmark.p_W; });
    if (old == known_.end()) {
      now.push_back({landmark.p_W, estimate().nav.time, listening_, landmark.last_seen});
      continue;
    }
    now.push_back({landmark.p_W, old->born, old->counts, landmark.last_seen});
    known_.erase(old);
  }
  for (const Known& gone : known_) {
    if (gone.counts) ended_.push_back(to_seconds(gone.last_seen - gone.born));
  }
  known_ = std::move(now);
}

std::vector<double> Witness::lives() const {
  std::vector<double> all = ended_;
  for (const Known& k : known_) {
    if (k.counts) all.push_back(to_seconds(k.last_seen - k.born));
  }
  return all;
}

Testimony testimony(const io::Dataset& data, const Motion& motion) {
  Options options;
  io::apply_sensor_info(data, &options);
  std::string why;
  if (!options.validate(&why)) throw std::runtime_error(why);
  Sums sums;
  PipelineDrive<Witness> drive(options);
  const auto in_motion = [&](std::size_t i) {
    return data.scans[i].time >= motion.begin && data.scans[i].time <= motion.end;
  };
  const DetectionList* filtered = nullptr;
  drive.run(
      data.imu, data.scans, [](std::size_t, Time) { return true; },
      [&](std::size_t i, const DetectionList& scan) {
        drive.backend().listen(in_motion(i));
        filtered = &scan;
      },
      [&](std::size_t i, Status) {
        if (in_motion(i)) sums.add(drive.pipeline().report(), *filtered);
      });
  Testimony result = sums.result();
  const Witness& witness = drive.backend();
  result.landmarks = witness.landmarks();
  result.found_again = witness.found_again();
  result.landmarks_a_scan = ratio(result.landmarks.used, result.scans);
  result.found_again_share = ratio(result.found_again.used, result.landmarks.used);
  result.landmark_life = Quantiles::of(witness.lives()).median;
  return result;
}

}  // namespace rio::experiment
