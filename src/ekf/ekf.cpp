// SPDX-License-Identifier: BSD-3-Clause
#include "rio/ekf/ekf.hpp"

#include "rio/core/mirror.hpp"

namespace rio {

Ekf::Ekf(const Options& options)
    : options_(options),
      // clones need a covariance only for the trails
      state_estimate_(options, options.update.use_trails
                                   ? static_cast<int>(clones_per_radar(options) * options.radars())
                                   : 0),
      rows_(options),
      compression_(rows_.capacity()),
      panels_(state_estimate_.layout().capacity()),
      reexpression_(state_estimate_.layout().capacity()),
      dx_(Eigen::VectorXd::Zero(state_estimate_.layout().capacity())) {}

void Ekf::reset(const NavState& prior, const BodyCovariance& P0) {
  state_estimate_.reset(prior, P0);
  rows_.reset();
}

void Ekf::drop_landmarks(UpdateReport* report) {
  for (std::size_t i = estimate().landmarks.size(); i-- > 0;) {
    state_estimate_.remove_landmark(i);
    ++report->landmarks_removed;
  }
}

void Ekf::restart_velocity(const Vector3d& v_B, const Matrix3d& covariance_B, double duration,
                           double doubtful, UpdateReport* report) {
  drop_landmarks(report);
  state_estimate_.restart_velocity(v_B, covariance_B, duration, doubtful);
}

Status Ekf::update(const Observations& seen, UpdateReport* report) {
  const RowBatch& rows = rows_.build(seen, state_estimate_, report);
  if (!panels_.apply(compression_.compress(rows, estimate().gyro_variance),
                     &state_estimate_.covariance(), &dx_))
    return Status::kNumerical;
  before_ = state_estimate_.estimate();
  state_estimate_.correct(dx_);
  if (options_.update.consistent_covariance) {
    reexpression_.apply(state_estimate_.layout(), before_, state_estimate_.estimate(),
                        &state_estimate_.covariance());
  }
  mirror_lower(state_estimate_.covariance().matrix());
  return Status::kOk;
}

void Ekf::maintain_landmarks(const Observations& seen, const Promotions& promotions,
                             UpdateReport* report) {
  rio::maintain_landmarks(
      seen, rows_, promotions, options_, &state_estimate_.estimate(), report,
      [this](std::size_t i) { state_estimate_.remove_landmark(i); },
      [](std::size_t) { return false; },
      [this](const Detection& d) { state_estimate_.add_landmark(d); });
}

}  // namespace rio
