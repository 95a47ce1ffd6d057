// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/ekf.hpp"

#include "rio/core/symmetric.hpp"

namespace rio {

Ekf::Ekf(const Options& options)
    : options_(options),
      // clones need a covariance only for the trails
      state_estimate_(options, options.update.use_trails
                                   ? static_cast<int>(clones_per_radar(options) * options.radars())
                                   : 0),
      compression_(ScanRows::capacity(options)),
      panels_(state_estimate_.layout().capacity()),
      reexpression_(state_estimate_.layout().capacity()),
      dx_(Eigen::VectorXd::Zero(state_estimate_.layout().capacity())) {}

void Ekf::drop_landmarks(UpdateReport* report) {
  for (std::size_t i = estimate().landmarks.size(); i-- > 0;) {
    state_estimate_.remove_landmark(i);
    ++report->landmarks_removed;
  }
}

Status Ekf::update(const Observations& /*seen*/, const ScanRows& rows) {
  if (!panels_.apply(compression_.compress(rows.batch(), estimate().gyro_variance),
                     &state_estimate_.covariance(), &dx_))
    return Status::kNumerical;
  before_ = state_estimate_.estimate();
  state_estimate_.correct(dx_);
  if (options_.update.consistent_covariance) {
    reexpression_.apply(state_estimate_.layout(), before_, state_estimate_.estimate(),
                        &state_estimate_.covariance());
  }
  mirror_lower(state_estimate_.covariance().matrix());
  state_estimate_.consider();
  return Status::kOk;
}

void Ekf::maintain_landmarks(const Observations& seen, const ScanRows& rows,
                             const Promotions& promotions, UpdateReport* report) {
  rio::maintain_landmarks(
      seen, rows, promotions, options_, &state_estimate_.estimate(), report,
      [this](std::size_t i) { state_estimate_.remove_landmark(i); },
      [](std::size_t) { return false; },
      [this](const Detection& d) { state_estimate_.add_landmark(d); });
}

}  // namespace rio
