// SPDX-License-Identifier: BSD-3-Clause
#include "rio/frontend/scan_correction.hpp"

namespace rio {

ScanCorrection::ScanCorrection(const Options& options)
    : use_own_echoes_(options.frontend.own_echoes),
      use_direction_noise_(options.update.doppler_directions == DopplerDirections::kCorrected &&
                           options.ablation.direction_noise),
      corrected_(options.frontend.max_detections) {
  for (std::size_t r = 0; r < options.radars(); ++r) {
    own_echoes_.emplace_back(doppler_fold(options, r));
    noise_.emplace_back(options.seen_by(r).radar);
  }
}

const DetectionList& ScanCorrection::correct(const DetectionList& received, const Estimate& x,
                                             const Matrix3d& velocity_covariance) {
  corrected_ = received;
  for (Detection& d : corrected_.items) d.range_rate /= 1.0 + x.doppler_scale;
  noise_[received.radar].apply(&corrected_);
  own_.clear();
  if (!use_own_echoes_) return corrected_;
  own_echoes_[received.radar].observe(corrected_, radar_velocity(x), velocity_covariance, &own_,
                                      1.0 + x.doppler_scale);
  for (std::size_t i = own_.size(); i-- > 0;) {
    corrected_.items.erase(corrected_.items.begin() + static_cast<std::ptrdiff_t>(own_[i]));
  }
  return corrected_;
}

void ScanCorrection::observe(const Observations& seen, const Estimate& x) {
  if (use_direction_noise_) noise_[seen.scan->radar].observe(seen, x.distance_travelled);
}

void ScanCorrection::restore_indices(UpdateReport* report) const {
  for (InnovationRecord& record : report->records) {
    if (record.model == Model::kAiding || record.model == Model::kEgoVelocity ||
        record.model == Model::kRest) {
      continue;
    }
    std::size_t detection = record.detection;
    for (const std::size_t own : own_) detection += own <= detection ? 1 : 0;
    record.detection = static_cast<std::uint16_t>(detection);
  }
}

}  // namespace rio
